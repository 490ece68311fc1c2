"""Makes the unusable ONNX models beside this file (needs the package onnx)."""

from pathlib import Path

from onnx import TensorProto, helper, save

FOLDER = Path(__file__).parent
FLOAT = TensorProto.FLOAT


def model(name, inputs, outputs, nodes, opset=13):
    """One small model."""
    infos = [[helper.make_tensor_value_info(n, kind, shape) for n, kind, shape in group] for group in (inputs, outputs)]
    graph = helper.make_graph(nodes, name, *infos)
    made = helper.make_model(graph, opset_imports=[helper.make_opsetid("", opset)], ir_version=8)
    save(made, FOLDER / f"{name}.onnx")


def pooled(**more):
    """Mean over the points."""
    return [helper.make_node("ReduceMean", ["x"], ["y"], axes=[1], keepdims=0, **more)]


model("wrong_channels", [("x", FLOAT, [12, 64, 7])], [("y", FLOAT, [12, 7])], pooled())
model("wrong_rank", [("x", FLOAT, [12, 64])], [("y", FLOAT, [12])], pooled())
model("wrong_answers", [("x", FLOAT, [12, 64, 4])], [("y", FLOAT, [12, 4])], pooled())
model("wrong_type", [("x", TensorProto.DOUBLE, [12, 64, 4])], [("y", TensorProto.DOUBLE, [12, 4])], pooled())
model("two_inputs", [("x", FLOAT, [12, 64, 4]), ("z", FLOAT, [12, 64, 4])], [("y", FLOAT, [12, 64, 4])],
      [helper.make_node("Add", ["x", "z"], ["y"])])
model("unknown_operator", [("x", FLOAT, [12, 64, 4])], [("y", FLOAT, [12, 3])], [helper.make_node("Fold", ["x"], ["y"])])
