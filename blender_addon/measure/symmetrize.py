# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures what Symmetrize Positions and Symmetrize Exactly leave of asymmetry, and prints two tables for
docs/blender.md.

usage: symmetrize.py SCAN...        (bodies in a rest pose: PLY, OBJ, OFF)

At rest: the root mean square, over the surface, of the distance of vertices from the mirrored places of their images.
In a pose: a wide change is made to one leg of examples/human.ply, and its other leg wins; what is left over is the root
mean square distance from what the same tool makes of the unchanged body, as a share of the change.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests"))

from conftest import attribute, install, module, new_object, positions, read_example  # noqa: E402  (sets bpy up)

import bpy  # noqa: E402
import numpy as np  # noqa: E402

ops = bpy.ops.intrinsic_symmetry
#: Name, operator, settings.
TOOLS = (
    ("Symmetrize Positions", ops.symmetrize, {}, 1),
    ("10 times", ops.symmetrize, {}, 10),
    ("Symmetrize Exactly", ops.symmetrize_exactly, {}, 1),
)
REPEATS = (1, 2, 5)


def rms(distances, areas):
    return np.sqrt(np.average(distances**2, weights=areas))


def scan(path):
    """A scan as the active object, with its symmetry."""
    import intrinsym  # comes with the extension

    source = intrinsym.Mesh.read(path)
    offsets, corners = source.polygons
    mesh = bpy.data.meshes.new(Path(path).stem)
    faces = [corners[a:b].tolist() for a, b in zip(offsets[:-1], offsets[1:])]
    mesh.from_pydata(source.vertices.tolist(), [], faces)
    object = new_object(mesh, mesh.name)
    assert ops.detect() == {"FINISHED"}
    return object


def asymmetry(object):
    """Share of the square root of the area."""
    symmetry, points = module("stored_map").load(object.data), positions(object.data)
    reference = module("asymmetry").reference("PLANE", symmetry, object.data, points)
    areas = module("asymmetry").vertex_areas(object.data)
    far = np.linalg.norm(reference.images(symmetry, points) - points, axis=1)
    return rms(far, areas) / np.sqrt(areas.sum())


def at_rest(paths):
    print("| scan | before | " + " | ".join(name for name, *_ in TOOLS) + " |")
    print("|---|" + "---|" * (1 + len(TOOLS)))
    for path in paths:
        object = scan(path)
        before, row = positions(object.data), [asymmetry(object)]
        for _, tool, settings, repeat in TOOLS:
            module("mesh_data").set_shown_positions(object, before)
            for _ in range(repeat):
                tool(direction="AVERAGE", **settings)
            row.append(asymmetry(object))
        print(f"| {object.name} | " + " | ".join(f"{100 * value:.2f} %" for value in row) + " |")


def changes(object):
    """Name to (vertices, 3) of wide changes to the left leg."""
    points, side = positions(object.data), attribute(object.data, "sym_side")
    normals = np.array([vertex.normal[:] for vertex in object.data.vertices])
    height = np.ptp(points[:, 2])
    up = (points[:, 2] - points[:, 2].min()) / height
    leg = (side == 1) & (up < 0.5)
    thicker = np.where(leg, 0.02 * height * np.exp(-(((up - 0.35) / 0.08) ** 2)), 0)
    longer = np.where(leg, 0.05 * height * np.clip((0.45 - up) / 0.3, 0, 1), 0)
    return {"a thicker thigh": thicker[:, None] * normals, "a longer leg": -longer[:, None] * np.eye(3)[2]}


def in_a_pose():
    object = new_object(read_example("human"), "human")
    assert ops.detect() == {"FINISHED"}
    before, areas = positions(object.data), module("asymmetry").vertex_areas(object.data)
    print("| in a pose | " + " | ".join(f"{repeat} times" for repeat in REPEATS) + " |")
    print("|---|" + "---|" * len(REPEATS))
    made = {}
    for name, change in {"nothing": 0 * before, **changes(object)}.items():
        row = []
        for repeat in REPEATS:
            module("mesh_data").set_shown_positions(object, before + change)
            ops.symmetrize_exactly(about="POSE", direction="RIGHT_TO_LEFT", repeat=repeat)
            made[name, repeat] = positions(object.data)
            left = np.linalg.norm(made[name, repeat] - made["nothing", repeat], axis=1)
            row.append(rms(left, areas) / max(rms(np.linalg.norm(change, axis=1), areas), 1e-30))
        if name != "nothing":
            print(f"| {name} | " + " | ".join(f"{value:.0%}" for value in row) + " |")
    moved = [rms(np.linalg.norm(made["nothing", n] - before, axis=1), areas) / np.sqrt(areas.sum()) for n in REPEATS]
    print("| the body itself moves | " + " | ".join(f"{value:.1%}" for value in moved) + " |")


if __name__ == "__main__":
    bpy.ops.wm.read_factory_settings(use_empty=True)
    install()
    at_rest(sys.argv[1:])
    in_a_pose()
