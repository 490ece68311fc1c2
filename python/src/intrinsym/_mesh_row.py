"""One mesh file as one row of a table: what was found, or the error. Needs nothing but the package itself."""

from __future__ import annotations

import time
from dataclasses import asdict
from typing import Any

import numpy as np

from ._ply import numbered, ply_of
from .detection import Detection
from .errors import InternalError, IntrinsymError
from .mesh import Mesh
from .symmetry import Symmetry

#: The outcome of a mesh that could not be answered; the other outcomes are those of the library's report.
ERROR = "error"
#: Kinds of files that a row can bring with it.
FILE_KINDS = ("map", "ply")

Row = dict[str, Any]
#: Arguments of :func:`row_of_file`.
Request = tuple[str, str, dict[str, Any], tuple[str, ...]]


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
    judged = found.report.judged
    symmetries = [_symmetry(symmetry) for symmetry in found]
    row = {
        "outcome": found.outcome.value,
        "vertices": mesh.vertex_count,
        "faces": mesh.face_count,
        "plausibility": judged and judged.plausibility,
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
        "partner": symmetry.partner,
        "confidence": symmetry.confidence,
        "side": symmetry.side,
        **asdict(symmetry.evidence),
    }


def _files(mesh: Mesh, found: Detection, write: tuple[str, ...]) -> dict[str, bytes]:
    files = {}
    if "map" in write:
        nobody = np.full(mesh.vertex_count, -1, np.int32)
        for index, partner in enumerate([symmetry.partner for symmetry in found] or [nobody]):
            files[f"{numbered(index)}.map"] = "".join(f"{vertex}\n" for vertex in partner.tolist()).encode()
    if "ply" in write:
        files[".ply"] = ply_of(mesh, found)
    return files
