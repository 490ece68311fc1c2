"""SignNet: is an eigenfunction even, odd, or neither under the shape's mirror map?

After Qiao, Gao, Liu, Liu, Lai, Chen, "Learning-based Real-time Detection of Intrinsic Reflectional
Symmetry": a point-wise perceptron, a maximum over the points, a perceptron. Ours differs in size, in
a third answer (neither), and in exact invariance: see `canonical`.

Everything is plain functions over nested dictionaries of arrays, so that the export reads them as they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

EPSILON = 1e-5
EVEN, ODD, NEITHER = 0, 1, 2


@dataclass(frozen=True)
class Design:
    """A network: widths per point and after pooling, points, references t, inputs, dropout, outputs.

    `inputs`: "eigen" (phi_1..phi_t and phi_i), "positions" (x, y, z and phi_i), or "all" (phi_1..phi_12
    at once, whose answers come together). `normalised`: batch normalisation of the point layers;
    the head's layers have it always.
    """

    point: tuple[int, ...] = (48, 96, 192)
    head: tuple[int, ...] = (64,)
    points: int = 256
    references: int = 3
    inputs: str = "eigen"
    dropout: float = 0.1
    transform: bool = False
    canonical: bool = True
    normalised: bool = False
    signs: int = 12

    @property
    def channels(self) -> int:
        """Numbers per point."""
        return {"eigen": self.references + 1, "positions": 4, "all": self.signs}[self.inputs]

    @property
    def outputs(self) -> int:
        """Three logits for each sign answered at once."""
        return 3 * (self.signs if self.inputs == "all" else 1)


DESIGNS = {
    "compact": Design(),
    "paper": Design((64, 128, 256, 512, 4096), (512, 128, 32), 4500, dropout=0.7, normalised=True),
    "pointnet": Design((64, 64, 64, 128, 1024), (512, 256), 512, dropout=0.3, transform=True, normalised=True),
    "t2": Design(references=2),
    "t4": Design(references=4),
    "positions": Design(inputs="positions"),
    "diag": Design(inputs="all"),
    "narrow": Design((32, 64, 128), points=512),
    "small": Design((16, 32, 64), (32,)),
    "no-canonical": Design(canonical=False),
}


def canonical(x):
    """Each column scaled to rms 1 and given the sign that makes its sum of cubes non-negative.

    Negating a column negates its sum of cubes exactly, in floating point too, so the result, and all
    that follows, does not depend on the signs of the eigenfunctions. (An odd function has a sum of
    cubes near zero: its sign is then chosen by sampling noise, but still the same for both inputs.)
    """
    x = x / (jnp.sqrt(jnp.mean(x * x, axis=-2, keepdims=True)) + 1e-9)
    cubes = jnp.sum(x * x * x, axis=-2, keepdims=True)
    return jnp.where(cubes < 0, -x, x)


def _layer(key, width_in: int, width_out: int) -> dict:
    weight = jax.random.normal(key, (width_in, width_out)) * np.sqrt(2 / width_in)
    return {"weight": weight, "scale": jnp.ones(width_out), "shift": jnp.zeros(width_out)}


def _linear(key, width_in: int, width_out: int, size: float) -> dict:
    return {"weight": jax.random.normal(key, (width_in, width_out)) * size, "shift": jnp.zeros(width_out)}


def _stack(key, widths) -> list[dict]:
    keys = jax.random.split(key, len(widths))
    return [_layer(k, a, b) for k, a, b in zip(keys, widths[:-1], widths[1:])]


def create(design: Design, seed: int):
    """Parameters and running statistics (means and variances of each normalised layer)."""
    keys = jax.random.split(jax.random.PRNGKey(seed), 6)
    channels, pooled = design.channels, design.point[-1]
    parameters = {
        "point": _stack(keys[0], (channels, *design.point)),
        "head": _stack(keys[1], (pooled, *design.head)),
        "out": _linear(keys[2], design.head[-1], design.outputs, 0.05),
    }
    if design.transform:
        parameters["transform_point"] = _stack(keys[3], (channels, 64, 128, 256))
        parameters["transform_head"] = _stack(keys[4], (256, 128))
        parameters["transform_out"] = _linear(keys[5], 128, channels * channels, 0.0)
    statistics = {
        name: [{"mean": jnp.zeros_like(layer["shift"]), "variance": jnp.ones_like(layer["shift"])} for layer in layers]
        for name, layers in parameters.items()
        if isinstance(layers, list)
    }
    return parameters, statistics


def _run_stack(layers, statistics, x, training: bool):
    """Linear, batch normalisation, ReLU, repeated; returns the output and the statistics seen."""
    seen = []
    for layer, running in zip(layers, statistics):
        x = x @ layer["weight"]
        axes = tuple(range(x.ndim - 1))
        if training:
            running = {"mean": x.mean(axes), "variance": x.var(axes)}
        seen.append(running)
        factor = layer["scale"] / jnp.sqrt(running["variance"] + EPSILON)
        x = jax.nn.relu(x * factor + (layer["shift"] - running["mean"] * factor))
    return x, seen


def pooled_by_winners(layers, statistics, x):
    """Maximum over the points of the layers' output, for training without batch normalisation.

    The value and the gradient are those of the plain formula, at a quarter of the time: of each channel
    only the point that wins the maximum has a gradient, so only winners are differentiated.
    """
    every, _ = _run_stack(jax.lax.stop_gradient(layers), statistics, x, False)
    winner = every.argmax(-2)
    x, _ = _run_stack(layers[:-1], statistics, jnp.take_along_axis(x, winner[..., None], axis=-2), False)
    last, running = layers[-1], statistics[-1]
    factor = last["scale"] / jnp.sqrt(running["variance"] + EPSILON)
    y = jnp.einsum("bck,kc->bc", x, last["weight"])
    return jax.nn.relu(y * factor + (last["shift"] - running["mean"] * factor))


def prepare(design: Design, x):
    """Canonical inputs; positions are centred and scaled only."""
    if design.inputs == "positions":
        place = x[..., :3] - x[..., :3].mean(-2, keepdims=True)
        place = place / jnp.sqrt((place * place).mean((-1, -2), keepdims=True))
        return jnp.concatenate([place, canonical(x[..., 3:])], -1)
    if design.canonical:
        return canonical(x)
    return x / (jnp.sqrt(jnp.mean(x * x, axis=-2, keepdims=True)) + 1e-9)


def apply(design: Design, parameters, statistics, x, training: bool = False, key=None):
    """Logits (batch, outputs) of inputs (batch, points, channels), and the statistics seen."""
    x, seen = prepare(design, x), {}
    if design.transform:
        y, seen["transform_point"] = _run_stack(parameters["transform_point"], statistics["transform_point"], x, training)
        y, seen["transform_head"] = _run_stack(parameters["transform_head"], statistics["transform_head"], y.max(-2), training)
        turn = y @ parameters["transform_out"]["weight"] + parameters["transform_out"]["shift"]
        x = x @ (turn.reshape(-1, design.channels, design.channels) + jnp.eye(design.channels))
    if training and not design.normalised:
        y, seen["point"] = pooled_by_winners(parameters["point"], statistics["point"], x), statistics["point"]
    else:
        y, seen["point"] = _run_stack(parameters["point"], statistics["point"], x, training)
        y = y.max(-2)
    y, seen["head"] = _run_stack(parameters["head"], statistics["head"], y, training)
    if training and design.dropout:
        keep = jax.random.bernoulli(key, 1 - design.dropout, y.shape)
        y = jnp.where(keep, y / (1 - design.dropout), 0)
    return y @ parameters["out"]["weight"] + parameters["out"]["shift"], seen


def parameter_count(parameters) -> int:
    """How many numbers are trained."""
    return sum(int(np.prod(leaf.shape)) for leaf in jax.tree_util.tree_leaves(parameters))
