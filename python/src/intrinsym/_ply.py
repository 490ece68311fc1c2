"""A mesh with its symmetries as a PLY file."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .detection import Detection
from .mesh import Mesh


def numbered(index: int) -> str:
    """What ends the names of a symmetry: nothing for the best, _2 for the second, as the command line does."""
    return "" if index == 0 else f"_{index + 1}"


def ply_of(mesh: Mesh, found: Detection) -> bytes:
    """Binary PLY: positions, sym_vertex, sym_confidence and sym_side of each symmetry, pair colours, faces."""
    columns: list[tuple[str, str, NDArray[Any]]] = [
        ("double", axis, values) for axis, values in zip("xyz", mesh.vertices.T)
    ]
    for index, symmetry in enumerate(found):
        columns += [
            ("int", f"sym_vertex{numbered(index)}", symmetry.partner),
            ("float", f"sym_confidence{numbered(index)}", symmetry.confidence),
            ("int", f"sym_side{numbered(index)}", symmetry.side),
        ]
    if found:
        columns += [
            ("uchar", name, values) for name, values in zip(("red", "green", "blue"), found[0].pair_colours.T)
        ]
    types = {"double": "<f8", "float": "<f4", "int": "<i4", "uchar": "u1"}
    table = np.empty(mesh.vertex_count, [(name, types[kind]) for kind, name, _ in columns])
    for _, name, values in columns:
        table[name] = values
    offsets, corners = (np.asarray(array, np.int64) for array in mesh.polygons)
    faces = np.insert(corners, offsets[:-1], np.diff(offsets))
    properties = "".join(f"property {kind} {name}\n" for kind, name, _ in columns)
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {mesh.vertex_count}\n{properties}"
        f"element face {mesh.face_count}\nproperty list int int vertex_indices\nend_header\n"
    )
    return header.encode() + table.tobytes() + faces.astype("<i4").tobytes()
