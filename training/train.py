"""Train a SignNet on the CPU.

    python -m training.train --data train.npz --calibration val.npz --out net.npz [--design compact]

Loss: cross-entropy against (even, odd, neither) as soft targets of c. AdamW (Loshchilov and Hutter,
2019) with a cosine schedule. Afterwards one temperature is fitted on the calibration shapes (Guo et
al., "On Calibration of Modern Neural Networks", 2017) and folded into the last layer.
"""

from __future__ import annotations

import argparse
import time
from functools import partial
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
from scipy.optimize import minimize_scalar

from . import data, labels
from .network import DESIGNS, Design, apply, create, parameter_count

BATCH = 64
WEIGHT_DECAY = 1e-3
STATISTICS_MEMORY = 0.98
COARSE_SHARE = 0.6  # this share of the steps uses half of the points: nearly as good, at half the cost
AUTHORS_REPEATS = 4  # the authors' 64 shapes are few: each counts as this many


def loss_of(design, parameters, statistics, x, target, key):
    """Mean cross-entropy, and the statistics seen."""
    logits, seen = apply(design, parameters, statistics, x, True, key)
    logits = logits.reshape(target.shape)
    return -(target * jax.nn.log_softmax(logits)).sum(-1).mean(), seen


@partial(jax.jit, static_argnums=0)
def step(design, parameters, statistics, moments, x, target, key, rate, number):
    """One AdamW step; returns the new parameters, statistics, moments and the loss."""
    (loss, seen), slope = jax.value_and_grad(partial(loss_of, design), has_aux=True)(parameters, statistics, x, target, key)
    first = jax.tree.map(lambda m, g: 0.9 * m + 0.1 * g, moments[0], slope)
    second = jax.tree.map(lambda v, g: 0.999 * v + 0.001 * g * g, moments[1], slope)

    def move(p, m, v):
        update = (m / (1 - 0.9**number)) / (jnp.sqrt(v / (1 - 0.999**number)) + 1e-8)
        return p - rate * (update + (WEIGHT_DECAY * p if p.ndim == 2 else 0))

    statistics = jax.tree.map(lambda old, new: STATISTICS_MEMORY * old + (1 - STATISTICS_MEMORY) * new, statistics, seen)
    return jax.tree.map(move, parameters, first, second), statistics, (first, second), loss


def draw_batch(rng, design: Design, shapes: data.Shapes, pairs: np.ndarray, batch: int, points: int):
    """Random pairs at `points` random sample points, and their targets."""
    chosen = pairs[rng.choice(len(pairs), batch)]
    rows = rng.choice(shapes.samples.shape[1], points, replace=points > shapes.samples.shape[1])
    x = data.inputs(design, shapes, chosen[:, 0], chosen[:, 1], rows)
    if not design.canonical:
        x = x * rng.choice([-1.0, 1.0], (batch, 1, x.shape[2])).astype(np.float32)
    if design.inputs == "all":
        return x, data.targets(np.nan_to_num(shapes.labels[chosen[:, 0], : design.signs]))
    return x, data.targets(shapes.labels[chosen[:, 0], chosen[:, 1]])


def train(design: Design, shapes: data.Shapes, steps: int, seed: int, rate: float = 2e-3, batch: int = BATCH, log=print,
          start_from=None):
    """Train for `steps` batches, from random numbers or from the (parameters, statistics) `start_from`.

    Returns (parameters, statistics, losses of every step).
    """
    rng = np.random.default_rng(seed)
    parameters, statistics = start_from or create(design, seed)
    moments = (jax.tree.map(jnp.zeros_like, parameters), jax.tree.map(jnp.zeros_like, parameters))
    pairs, losses, start = shapes.pairs(design.signs), [], time.process_time()
    for number in range(1, steps + 1):
        points = design.points if number > COARSE_SHARE * steps else design.points // 2
        x, target = draw_batch(rng, design, shapes, pairs, batch, points)
        pace = rate * min(1, number / 50) * (0.5 * (1 + np.cos(np.pi * number / steps)) + 0.005)
        key = jax.random.PRNGKey(seed * 1_000_003 + number)
        parameters, statistics, moments, loss = step(
            design, parameters, statistics, moments, x, target, key, np.float32(pace), np.float32(number)
        )
        losses.append(loss)
        if number % 500 == 0:
            log(f"step {number} loss {float(np.mean(losses[-500:])):.4f} cpu {time.process_time() - start:.0f} s")
    return parameters, statistics, np.array(losses)


def predict(design: Design, parameters, statistics, shapes: data.Shapes, seed: int = 0) -> np.ndarray:
    """Logits (s, signs, 3) of every shape's first eigenfunctions, at one fixed draw of sample points."""
    rng = np.random.default_rng(seed)
    have = shapes.samples.shape[1]
    rows = rng.choice(have, design.points, replace=design.points > have)
    run = jax.jit(lambda x: apply(design, parameters, statistics, x)[0])
    functions, out = np.arange(design.signs), []
    for shape in range(len(shapes)):
        repeat = 1 if design.inputs == "all" else design.signs
        x = data.inputs(design, shapes, np.full(repeat, shape), functions[:repeat], rows)
        out.append(np.asarray(run(x)).reshape(design.signs, 3))
    return np.array(out)


def temperature(logits: np.ndarray, correlation: np.ndarray) -> float:
    """The factor on the logits that makes the cross-entropy on calibration shapes least."""
    target, flat = data.targets(correlation.ravel()), logits.reshape(-1, 3)

    def cost(log_factor):
        scaled = flat * np.exp(log_factor)
        peak = scaled.max(1, keepdims=True)
        return -(target * (scaled - peak - np.log(np.exp(scaled - peak).sum(1, keepdims=True)))).sum(1).mean()

    return float(np.exp(minimize_scalar(cost, bounds=(-4, 4), method="bounded").x))


def save(path: Path, design_name: str, parameters, statistics) -> None:
    """The network for export.py and evaluate.py: its design's name, and its arrays in tree order."""
    path.parent.mkdir(parents=True, exist_ok=True)
    leaves = [np.asarray(leaf) for leaf in jax.tree.leaves((parameters, statistics))]
    np.savez(path, *leaves, design=design_name)


def load(path: Path):
    """(design, parameters, statistics) as written by `save`."""
    with np.load(path) as stored:
        design = DESIGNS[str(stored["design"])]
        template = create(design, 0)
        leaves = [stored[f"arr_{k}"] for k in range(len(stored.files) - 1)]
    return (design, *jax.tree.unflatten(jax.tree.structure(template), leaves))


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, nargs="*", default=[])
    parser.add_argument("--calibration", type=Path, nargs="+", required=True)
    parser.add_argument("--authors-labels", type=Path, help="folder of the authors' MATLAB files, added to the data")
    parser.add_argument("--labels", type=Path, help="folder of people's label files with their meshes, added to the data")
    parser.add_argument("--design", choices=DESIGNS, default="compact")
    parser.add_argument("--steps", type=int, default=14000)
    parser.add_argument("--batch", type=int, default=BATCH)
    parser.add_argument("--rate", type=float, default=2e-3)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--start-from", type=Path, help="go on from this network, whose design it keeps")
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    design, *start_from = load(options.start_from) if options.start_from else (DESIGNS[options.design],)
    sets = [data.load(options.data)] if options.data else []
    if options.authors_labels:
        sets += [labels.authors(options.authors_labels)] * AUTHORS_REPEATS
    if options.labels:
        sets.append(labels.of_people(options.labels))
    shapes = sets[0]
    for more in sets[1:]:
        shapes = data.joined(shapes, more)
    parameters, statistics, _ = train(design, shapes, options.steps, options.seed, options.rate, options.batch,
                                      partial(print, flush=True), start_from)
    held_out = data.load(options.calibration)
    factor = temperature(predict(design, parameters, statistics, held_out), held_out.labels[:, : design.signs])
    parameters["out"] = jax.tree.map(lambda leaf: leaf * factor, parameters["out"])
    print(f"parameters {parameter_count(parameters)}, shapes {len(shapes)}, temperature {1 / factor:.3f}")
    save(options.out, next(name for name, known in DESIGNS.items() if known == design), parameters, statistics)


if __name__ == "__main__":
    main()
