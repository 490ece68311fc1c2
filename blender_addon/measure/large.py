# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures what the tools cost on a mesh of 504,000 vertices, and prints a table for docs/blender.md.

usage: large.py

The human of examples/, refined and decimated, so that left and right share no connectivity. Processor time of all
threads, and on the clock; the least of five runs, each on a copy of the mesh.
"""

import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests"))

from conftest import attribute, install, module, new_object, positions, read_example  # noqa: E402  (sets bpy up)

import bpy  # noqa: E402
import numpy as np  # noqa: E402

ops = bpy.ops.intrinsic_symmetry
VERTICES, GROUPS, RUNS = 504_000, 20, 5


def body():
    """The human with so many vertices."""
    object = new_object(read_example("human"), "large")
    modifier = object.modifiers.new("finer", "SUBSURF")
    modifier.subdivision_type, modifier.levels = "SIMPLE", 3
    bpy.ops.object.modifier_apply(modifier="finer")
    modifier = object.modifiers.new("coarser", "DECIMATE")
    modifier.ratio = VERTICES / len(object.data.vertices)
    bpy.ops.object.modifier_apply(modifier="coarser")
    return object


def left_hand(object):
    """(vertices,) 0..1 around the left hand."""
    points, side = positions(object.data), attribute(object.data, "sym_side")
    tip = points[np.where(side == 1, np.abs(points[:, 0]), 0).argmax()]
    return np.maximum(1 - np.linalg.norm(points - tip, axis=1) / 0.3, 0) * (side == 1)


def with_edit(object):
    ops.remember()
    module("mesh_data").set_shown_positions(object, positions(object.data) + 0.01 * left_hand(object)[:, None])


def with_key(object):
    object.shape_key_add(name="Basis")
    key = object.shape_key_add(name="Smile.L")
    module("mesh_data").set_key_positions(key, positions(object.data) + 0.01 * left_hand(object)[:, None])
    object.active_shape_key_index = 1


def with_groups(object):
    weights = left_hand(object)
    chosen = np.flatnonzero(weights)
    for number in range(GROUPS):
        group = object.vertex_groups.new(name=f"Finger{number}.L")
        for vertex in chosen[number::GROUPS].tolist():
            group.add((vertex,), float(weights[vertex]), "REPLACE")
    ops.detect()  # as it is on a rigged character, whose names say which side is left


#: What is measured: its name, what comes before, and the tool.
STEPS = (
    ("Detect Symmetry", lambda object: ops.clear(), ops.detect),
    ("Mirror Edit", with_edit, ops.mirror_edit),
    ("Mirror Shape Keys, one key", with_key, ops.mirror_shape_keys),
    (f"Mirror Vertex Groups, {GROUPS} groups", with_groups, ops.mirror_vertex_groups),
)


def cost(model, prepare, tool):
    """Seconds of processor time and on the clock."""
    object = new_object(model.copy())
    prepare(object)
    begun = time.process_time(), time.perf_counter()
    assert tool() == {"FINISHED"}
    took = time.process_time() - begun[0], time.perf_counter() - begun[1]
    bpy.data.meshes.remove(object.data)
    return took


def main():
    object = body()
    assert ops.detect() == {"FINISHED"}
    print(f"{len(object.data.vertices):,} vertices\n\n| tool | processor time | on the clock |\n|---|---|---|")
    for name, prepare, tool in STEPS:
        took = np.min([cost(object.data, prepare, tool) for _ in range(RUNS)], axis=0)
        print(f"| {name} | {took[0]:.1f} s | {took[1]:.1f} s |")


if __name__ == "__main__":
    bpy.ops.wm.read_factory_settings(use_empty=True)
    install()
    main()
