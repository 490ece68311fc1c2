"""From a trained network to ONNX and to plain weights, and the proof that ONNX Runtime gives the framework's numbers.

    python -m training.export NET.npz models/signnet.onnx

The graph holds everything: canonical signs, batch normalisation folded into the layers, temperature.
Input `eigenfunctions` float32 [signs, points, channels], columns of any scale and sign; output
`logits` float32 [signs, 3]: even, odd, neither. Only elementary operators, for small runtimes.
`signnet.weights` beside it has the layers' numbers only: the library embeds it (src/search/sign_network/forward.rs).
"""

from __future__ import annotations

import argparse
import hashlib
import json
from pathlib import Path

import jax
import numpy as np
import onnx
import onnxruntime
from onnx import TensorProto, helper, numpy_helper

from .network import EPSILON, Design, apply
from .train import load

OPSET = 13
TOLERANCE = 1e-4


def folded(layers, statistics) -> list[tuple[np.ndarray, np.ndarray]]:
    """Weight (in, out) and bias of each layer with its batch normalisation inside."""
    out = []
    for layer, running in zip(layers, statistics):
        factor = np.asarray(layer["scale"]) / np.sqrt(np.asarray(running["variance"]) + EPSILON)
        out.append((np.asarray(layer["weight"]) * factor, np.asarray(layer["shift"]) - np.asarray(running["mean"]) * factor))
    return out


class Graph:
    """Collects nodes and constants; every method returns the name of its output."""

    def __init__(self):
        self.nodes, self.constants = [], []

    def constant(self, value) -> str:
        """A stored array (integers as int64, the rest as float32)."""
        array = np.asarray(value)
        array = array.astype(np.int64 if array.dtype.kind == "i" else np.float32)
        name = f"constant_{len(self.constants)}"
        self.constants.append(numpy_helper.from_array(np.ascontiguousarray(array), name))
        return name

    def add(self, operator: str, *inputs: str, output: str | None = None, **attributes) -> str:
        """One operator."""
        name = output or f"{operator.lower()}_{len(self.nodes)}"
        self.nodes.append(helper.make_node(operator, list(inputs), [name], **attributes))
        return name

    def linear(self, x: str, weight, bias, output: str | None = None) -> str:
        """x @ weight + bias."""
        return self.add("Add", self.add("MatMul", x, self.constant(weight)), self.constant(bias), output=output)

    def stack(self, x: str, layers) -> str:
        """Linear and ReLU, repeated."""
        for weight, bias in layers:
            x = self.add("Relu", self.linear(x, weight, bias))
        return x

    def canonical(self, x: str, points: int) -> str:
        """network.canonical: rms 1, sum of cubes not negative."""
        axis = self.constant(np.array([1]))
        square = self.add("Mul", x, x)
        total = self.add("ReduceSum", square, axis, keepdims=1)
        mean = self.add("Mul", total, self.constant(np.float32(1 / points)))
        rms = self.add("Add", self.add("Sqrt", mean), self.constant(np.float32(1e-9)))
        scaled = self.add("Div", x, rms)
        cubes = self.add("Mul", self.add("Mul", scaled, scaled), scaled)
        negative = self.add("Less", self.add("ReduceSum", cubes, axis, keepdims=1), self.constant(np.float32(0)))
        return self.add("Where", negative, self.add("Neg", scaled), scaled)


def graph_of(design: Design, parameters, statistics) -> onnx.ModelProto:
    """The ONNX model of a network with eigenfunctions as input and no input transform."""
    if design.inputs != "eigen" or design.transform or not design.canonical:
        raise ValueError("only canonical networks of the reference eigenfunctions and one more are exported")
    graph = Graph()
    x = graph.canonical("eigenfunctions", design.points)
    x = graph.stack(x, folded(parameters["point"], statistics["point"]))
    x = graph.add("ReduceMax", x, axes=[1], keepdims=0)
    x = graph.stack(x, folded(parameters["head"], statistics["head"]))
    graph.linear(x, parameters["out"]["weight"], parameters["out"]["shift"], output="logits")
    inputs = [helper.make_tensor_value_info("eigenfunctions", TensorProto.FLOAT, [design.signs, design.points, design.channels])]
    outputs = [helper.make_tensor_value_info("logits", TensorProto.FLOAT, [design.signs, 3])]
    body = helper.make_graph(graph.nodes, "signnet", inputs, outputs, graph.constants)
    model = helper.make_model(body, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=8, producer_name="intrinsym")
    onnx.checker.check_model(model)
    return model


def largest_difference(design: Design, parameters, statistics, model: bytes, seed: int = 0) -> float:
    """Largest difference of the logits, framework against ONNX Runtime, over a few random inputs."""
    session = onnxruntime.InferenceSession(model, providers=["CPUExecutionProvider"])
    rng, worst = np.random.default_rng(seed), 0.0
    run = jax.jit(lambda x: apply(design, parameters, statistics, x)[0])
    for _ in range(8):
        x = rng.normal(size=(design.signs, design.points, design.channels)) + rng.normal(size=design.channels)
        x = x.astype(np.float32)
        difference = np.abs(np.asarray(run(x)) - session.run(None, {"eigenfunctions": x})[0])
        worst = max(worst, float(difference.max()))
    return worst


def reference_rows(points: int, signs: int) -> np.ndarray:
    """Made-up eigenfunctions (points, signs) that other languages can make too (tests/sign_network.rs)."""
    p, j = np.arange(points)[:, None], np.arange(signs)[None, :]
    return np.sin(0.1 * (j + 1) * p + j) + 0.25 * np.cos(0.017 * (j + 2) * p)


def write_reference(path: Path, design: Design, parameters, statistics) -> None:
    """The framework's logits for `reference_rows`: what every runtime must give, to 1e-5."""
    rows = reference_rows(design.points, design.signs)
    x = np.stack([np.c_[rows[:, : design.references], rows[:, i]] for i in range(design.signs)]).astype(np.float32)
    logits = np.asarray(apply(design, parameters, statistics, x)[0])
    path.write_text(json.dumps({"points": design.points, "logits": logits.astype(float).round(6).tolist()}) + "\n")


def weights_of(model: onnx.ModelProto) -> bytes:
    """Each layer's weight (in, out) row by row and its bias, in little-endian float32: the arrays of more than one number."""
    arrays = map(numpy_helper.to_array, model.graph.initializer)
    return b"".join(array.astype("<f4").tobytes() for array in arrays if array.size > 1)


def write_model(model: onnx.ModelProto, out: Path) -> None:
    """Write the ONNX file, its .weights, and the hashes of both in .sha256."""
    files = {out: model.SerializeToString(deterministic=True), out.with_suffix(".weights"): weights_of(model)}
    out.parent.mkdir(parents=True, exist_ok=True)
    for path, content in files.items():
        path.write_bytes(content)
    lines = [f"{hashlib.sha256(content).hexdigest()}  {path.name}\n" for path, content in files.items()]
    out.with_suffix(".sha256").write_text("".join(lines))


def export(network: Path, out: Path) -> float:
    """Write the files of `write_model` and .reference.json; returns the largest difference found.

    Refuses a difference over 1e-4.
    """
    design, parameters, statistics = load(network)
    model = graph_of(design, parameters, statistics)
    worst = largest_difference(design, parameters, statistics, model.SerializeToString(deterministic=True))
    if worst > TOLERANCE:
        raise ValueError(f"ONNX Runtime differs from the framework by {worst:.2e}")
    write_model(model, out)
    write_reference(out.with_suffix(".reference.json"), design, parameters, statistics)
    return worst


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("network", type=Path)
    parser.add_argument("out", type=Path)
    options = parser.parse_args()
    print(f"largest difference, framework against ONNX Runtime: {export(options.network, options.out):.1e}")


if __name__ == "__main__":
    main()
