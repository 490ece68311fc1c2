"""One mesh file as one row of a table: what was found, or the error. Needs nothing but the package itself."""

from __future__ import annotations

import os
import time
from typing import Any

import numpy as np

from ._library import LIBRARY
from .errors import InternalError, IntrinsymError
from .mesh import Mesh
from .symmetry import Detection, Symmetry

#: The outcome of a mesh that could not be answered; the other outcomes are those of the library's report.
ERROR = "error"
#: Kinds of files that a row can bring with it.
FILE_KINDS = ("map", "ply")

Row = dict[str, Any]


def row_of_file(path: str, name: str, options: dict[str, Any], write: tuple[str, ...] = ()) -> Row:
    """Reads a mesh file and finds its symmetries; an error of the library is a row, too.

    ``path``: where the bytes lie; ``name``: what errors call it. ``options``: arguments of
    :meth:`intrinsym.Mesh.detect`. ``write``: kinds of files of :data:`FILE_KINDS` to bring as bytes under the key
    ``files``, by suffix of their name. The row's keys are the columns of ``intrinsym.ray``, but for those of the
    file itself; ``seconds`` is wall time.
    """
    start = time.perf_counter()
    try:
        mesh = Mesh.read(path)
        row = _answer(mesh, mesh.detect(**options), write)
    except (IntrinsymError, MemoryError) as error:
        row = _failure(error, path, name)
    return row | {"seconds": time.perf_counter() - start}


def error_row(kind: str, text: str) -> Row:
    """The row of a mesh without an answer."""
    return {"outcome": ERROR, "error_kind": kind, "error": text}


def _failure(error: Exception, path: str, name: str) -> Row:
    if isinstance(error, MemoryError):
        return error_row("Memory", "the mesh needs more memory than one mesh may take")
    # What Rust says of a defect names the thread, which is another one each time.
    text = "a defect of the library; please report it" if isinstance(error, InternalError) else str(error)
    return error_row(type(error).__name__, text.replace(path, name))


def _answer(mesh: Mesh, found: Detection, write: tuple[str, ...]) -> Row:
    judged = found.report["report"]["judged"]
    symmetries = [_symmetry(symmetry) for symmetry in found]
    row = {
        "outcome": found.outcome.value,
        "vertices": mesh.vertex_count,
        "faces": mesh.face_count,
        "plausibility": judged and judged["plausibility"],
        "symmetries": len(found),
        "continuous_family": found.continuous_family,
        "further": symmetries[1:],
        "files": _files(mesh, found, write),
    }
    return row | (symmetries[0] if symmetries else {})


def _symmetry(symmetry: Symmetry) -> Row:
    """What the table says of one symmetry; the arrays have one entry for each vertex."""
    return {
        "kind": symmetry.kind.name.lower(),
        "order": symmetry.order,
        "plausibility": symmetry.plausibility,
        "paired_share": symmetry.paired_share,
        "shells_paired": symmetry.shells_paired,
        "shells_self_mirrored": symmetry.shells_self_mirrored,
        "shells_alone": symmetry.shells_alone,
        "mean_confidence": symmetry.mean_confidence,
        "exact_share": symmetry.exact_share,
        "partner": symmetry.partner,
        "confidence": symmetry.confidence,
        "side": symmetry.side,
    }


def _files(mesh: Mesh, found: Detection, write: tuple[str, ...]) -> dict[str, bytes]:
    files = {}
    if "map" in write:
        nobody = np.full(mesh.vertex_count, -1, np.int32)
        for index, partner in enumerate([symmetry.partner for symmetry in found] or [nobody]):
            files[f"{_suffix(index)}.map"] = "".join(f"{vertex}\n" for vertex in partner.tolist()).encode()
    if "ply" in write:
        files[".ply"] = _ply(mesh, found)
    return files


def _suffix(index: int) -> str:
    return "" if index == 0 else f"_{index + 1}"


def _ply(mesh: Mesh, found: Detection) -> bytes:
    """Binary PLY: positions, sym_vertex, sym_confidence and sym_side of each symmetry, pair colours, faces."""
    columns: list[tuple[str, str, np.ndarray]] = [
        ("double", axis, values) for axis, values in zip("xyz", mesh.vertices.T)
    ]
    for index, symmetry in enumerate(found):
        columns += [
            ("int", f"sym_vertex{_suffix(index)}", symmetry.partner),
            ("float", f"sym_confidence{_suffix(index)}", symmetry.confidence),
            ("int", f"sym_side{_suffix(index)}", symmetry.side),
        ]
    if found:
        columns += [
            ("uchar", name, values) for name, values in zip(("red", "green", "blue"), _colours(mesh, found).T)
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


def _colours(mesh: Mesh, found: Detection) -> np.ndarray:
    """(vertices, 3) uint8: the colours that partners of the best symmetry share."""
    colours = np.empty((mesh.vertex_count, 3), np.uint8)
    LIBRARY.isym_result_pair_colours(found._result.pointer, 0, colours, mesh.vertex_count)
    return colours


def suffix_of(path: str) -> str:
    """The part of a path that says its format, such as ".ply"."""
    return os.path.splitext(path)[1]
