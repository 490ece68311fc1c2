# SPDX-License-Identifier: GPL-3.0-or-later
"""PyMeshLab with the plugin, and what the command line and the Python package say of the same meshes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pymeshlab
import pytest

ROOT = Path(__file__).resolve().parents[3]
EXAMPLES = ROOT / "examples"
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"
PLUGIN = "libfilter_intrinsic_symmetry.so"
[PACKAGE] = [folder for folder in (ROOT / "out" / "meshlab").iterdir() if folder.is_dir()]

os.environ["INTRINSYM_LIBRARY"] = str(TARGET / "libintrinsym.so")
sys.path.insert(0, str(ROOT / "python" / "src"))

COMPUTE = "compute_intrinsic_symmetry_per_vertex"
SELECT_VERTICES = "compute_selection_by_intrinsic_symmetry_per_vertex"
SELECT_FACES = "compute_selection_by_intrinsic_symmetry_per_face"
MIRROR = "compute_attribute_by_intrinsic_symmetry_per_vertex"
SYMMETRIZE = "apply_coord_intrinsic_symmetrization"
FLAG = "compute_scalar_by_intrinsic_asymmetry_per_vertex"
TOOLS = [SELECT_VERTICES, SELECT_FACES, MIRROR, SYMMETRIZE, FLAG]
FILTERS = [COMPUTE, *TOOLS]

#: PyMeshLab crashes when a MeshSet whose filter threw is destroyed before another filter has succeeded.
KEPT_ALIVE = []


def pytest_configure() -> None:
    pymeshlab.load_plugin(str(PACKAGE / "pymeshlab" / PLUGIN))


def mesh_set(path: Path) -> pymeshlab.MeshSet:
    loaded = pymeshlab.MeshSet()
    KEPT_ALIVE.append(loaded)
    loaded.load_new_mesh(str(path))
    return loaded


def example(name: str) -> pymeshlab.MeshSet:
    return mesh_set(EXAMPLES / f"{name}.ply")


def loose_triangles(folder: Path) -> pymeshlab.MeshSet:
    """Of different shapes, none the mirror image of another."""
    rng = np.random.default_rng(1)
    triangles = rng.random((200, 1, 3)) + 0.05 * rng.random((200, 3, 3))
    vertices = "".join("%r %r %r\n" % tuple(vertex) for vertex in triangles.reshape(-1, 3).tolist())
    faces = "".join(f"3 {v} {v + 1} {v + 2}\n" for v in range(0, 600, 3))
    (folder / "loose.off").write_text(f"OFF\n600 200 0\n{vertices}{faces}")
    return mesh_set(folder / "loose.off")


def attributes(mesh: pymeshlab.Mesh, suffix: str = "") -> dict[str, np.ndarray]:
    scalars = ["sym_vertex", "sym_confidence", "sym_side", "sym_face"]
    points = ["sym_corners", "sym_barycentrics"]
    found = {name: mesh.vertex_custom_scalar_attribute_array(name + suffix) for name in scalars}
    return found | {name: mesh.vertex_custom_point_attribute_matrix(name + suffix) for name in points}


def select_vertices(ms: pymeshlab.MeshSet, condition: str) -> np.ndarray:
    ms.compute_selection_by_condition_per_vertex(condselect=condition)
    return ms.current_mesh().vertex_selection_array()


class CommandLine:
    """`intrinsym detect` on one mesh: its report, and the vertex properties of the PLY that it wrote."""

    def __init__(self, mesh: Path, folder: Path, *options: str) -> None:
        out, report = folder / "out.ply", folder / "report.json"
        command = [TARGET / "intrinsym", "detect", mesh, "-o", out, "--json", report, *options]
        subprocess.run(list(map(str, command)), check=True, capture_output=True)
        self.report = json.loads(report.read_text())
        self.vertex = vertex_properties(out.read_bytes())


def vertex_properties(ply: bytes) -> np.ndarray:
    """The vertices of a binary PLY as a structured array."""
    header, body = ply.split(b"end_header\n", 1)
    types = {"char": "i1", "uchar": "u1", "int": "<i4", "float": "<f4", "double": "<f8"}
    fields, count, element = [], 0, ""
    for words in (line.split() for line in header.decode().splitlines()):
        if words[0] == "element":
            element = words[1]
            count = int(words[2]) if element == "vertex" else count
        elif words[0] == "property" and element == "vertex":
            fields.append((words[2], types[words[1]]))
    assert b"binary_little_endian" in header
    return np.frombuffer(body, fields, count)


@pytest.fixture(scope="session")
def quadruped_file() -> Path:
    return EXAMPLES / "quadruped.ply"


@pytest.fixture(scope="session")
def detected_quadruped(quadruped_file):
    """The Python package's answer: the library without MeshLab."""
    import intrinsym

    return intrinsym.Mesh.read(quadruped_file).detect()[0]


@pytest.fixture
def quadruped(quadruped_file) -> pymeshlab.MeshSet:
    loaded = mesh_set(quadruped_file)
    loaded.apply_filter(COMPUTE)
    return loaded
