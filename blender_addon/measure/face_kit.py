# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures Mirror Shape Keys on the expressions of ICT-FaceKit, and prints its table in docs/blender_table.md.

usage: face_kit.py FACEXMODEL       (the folder of that name in github.com/ICT-VGL/ICT-FaceKit)

Each left expression is carried to the right, at rest and on heads that are bent and twisted, and compared with the right
expression that the kit has itself: root mean square of the difference, as a share of that of the right expression. How
far a bent head is from symmetric is said by its stretch, as in the rest of that page.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests"))

from conftest import attribute, install, module, new_object, positions  # noqa: E402  (sets bpy up)

import bpy  # noqa: E402
import numpy as np  # noqa: E402
from mathutils.kdtree import KDTree  # noqa: E402

ops = bpy.ops.intrinsic_symmetry
#: Degrees by which the head is twisted about its vertical axis, and bent sideways, from its lowest point to its highest.
HEADS = ((0, 0), (20, 0), (0, 20), (20, 20), (40, 40))


def read(path):
    """(vertices, 3) and the faces of an OBJ file."""
    lines = [line.split() for line in path.read_text().splitlines()]
    points = np.array([line[1:4] for line in lines if line[:1] == ["v"]], float)
    faces = [[int(corner.split("/")[0]) - 1 for corner in line[1:]] for line in lines if line[:1] == ["f"]]
    return points, faces


def bent(points, neutral, twist, bend):
    """Points of the head after it is twisted about its vertical axis and bent sideways; Y is up."""
    twist, bend = np.radians(twist), max(np.radians(bend), 1e-6)
    low, size = neutral[:, 1].min(), np.ptp(neutral[:, 1])
    centre = neutral.mean(axis=0)
    up = (points[:, 1] - low) / size
    x, z = (points - centre)[:, 0], (points - centre)[:, 2]
    turn, radius = twist * up, size / bend
    x, z = x * np.cos(turn) + z * np.sin(turn), z * np.cos(turn) - x * np.sin(turn)
    angle = bend * up
    return np.stack([radius - (radius - x) * np.cos(angle), (radius - x) * np.sin(angle), z], axis=1)


def own_asymmetry(neutral, left, right):
    """Of the kit itself: the left expression reflected in X, read at the vertex nearest to each reflected place."""
    tree = KDTree(len(neutral))
    for number, point in enumerate(neutral):
        tree.insert(point, number)
    tree.balance()
    other = np.array([tree.find(point)[1] for point in neutral * (-1, 1, 1)])
    return error(left[other] * (-1, 1, 1), right)


def error(found, wanted):
    return np.linalg.norm(found - wanted) / np.linalg.norm(wanted)


def carried(neutral, faces, left):
    """Name to (vertices, 3) displacement that Mirror Shape Keys makes of each left expression; and the stretch."""
    mesh = bpy.data.meshes.new("head")
    mesh.from_pydata(neutral.tolist(), [], faces)
    object = new_object(mesh, "head")
    assert ops.detect() == {"FINISHED"}
    object.shape_key_add(name="Basis")
    for name, displacement in left.items():
        module("mesh_data").set_key_positions(object.shape_key_add(name=f"{name}_L"), neutral + displacement)
    assert ops.mirror_shape_keys(all_keys=True, direction="LEFT_TO_RIGHT") == {"FINISHED"}
    blocks, base = object.data.shape_keys.key_blocks, positions(object.data)
    found = {name: module("mesh_data").key_positions(blocks[f"{name}_R"]) - base for name in left}
    return found, stretch(module("mesh_data").edges(mesh), base, attribute(mesh, "sym_vertex"))


def stretch(ends, points, partner):
    """Mean of |ln(length of an edge / length of its mirror image)|, weighted by length."""
    ends = ends[(partner[ends] >= 0).all(axis=1)]
    own, other = (np.linalg.norm(points[pair[:, 0]] - points[pair[:, 1]], axis=1) for pair in (ends, partner[ends]))
    used = (own > 0) & (other > 0)
    return np.average(np.abs(np.log(own[used] / other[used])), weights=own[used])


def row(name, stretched, errors):
    values = " | ".join(f"{value:.1%}".replace("%", " %") for value in (np.median(errors), np.mean(errors), np.max(errors)))
    print(f"| {name} | {stretched} | {values} |")


def main(folder):
    neutral, faces = read(folder / "generic_neutral_mesh.obj")
    names = sorted(path.stem[:-2] for path in folder.glob("*_L.obj"))
    left, right = ({name: read(folder / f"{name}_{side}.obj")[0] for name in names} for side in "LR")
    print(f"| {len(names)} expressions | stretch | median | mean | largest |\n|---|---|---|---|---|")
    row("the kit's own asymmetry", "", [own_asymmetry(neutral, left[n] - neutral, right[n] - neutral) for n in names])
    for twist, bend in HEADS:
        base = bent(neutral, neutral, twist, bend)
        given, wanted = ({name: bent(side[name], neutral, twist, bend) - base for name in names} for side in (left, right))
        found, stretched = carried(base, faces, given)
        name = f"twisted by {twist} and bent by {bend} degrees" if twist or bend else "at rest"
        row(name, f"{stretched:.3f}", [error(found[name], wanted[name]) for name in names])


if __name__ == "__main__":
    bpy.ops.wm.read_factory_settings(use_empty=True)
    install()
    main(Path(sys.argv[1]))
