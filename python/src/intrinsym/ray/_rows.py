"""The rows of the table, and the function that Ray runs to make them."""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

import pyarrow as pa

from .._isolated import Limits, MeshProcess
from .._mesh_row import Row, error_row
from ._inputs import Place

_ARRAYS = [
    #: One entry for each vertex: see :class:`intrinsym.Symmetry`.
    ("partner", pa.list_(pa.int32())),
    ("confidence", pa.list_(pa.float32())),
    ("side", pa.list_(pa.int8())),
]
_SYMMETRY = [
    ("kind", pa.string()),
    ("plausibility", pa.float64()),
    ("paired_share", pa.float64()),
    ("shells_paired", pa.int64()),
    ("shells_self_mirrored", pa.int64()),
    ("shells_alone", pa.int64()),
    ("mean_confidence", pa.float64()),
    ("exact_share", pa.float64()),
]

#: The columns. What does not apply is null: the best map's where none was found, all but the error's where one was.
SCHEMA = pa.schema(
    [
        #: Absolute, or a URI.
        ("path", pa.string()),
        #: SHA-256 of the file's bytes, in hexadecimal; null where it cannot be read.
        ("content_hash", pa.string()),
        #: That of :class:`intrinsym.Detection`: "found", "doubtful" or "none"; or "error".
        ("outcome", pa.string()),
        ("vertices", pa.int64()),
        ("faces", pa.int64()),
        ("continuous_family", pa.bool_()),
        #: How many were found.
        ("symmetries", pa.int32()),
        #: Of the best one; the plausibility also where there is none.
        *_SYMMETRY,
        *_ARRAYS,
        #: The second and later symmetries, where more than one was asked for.
        ("further", pa.list_(pa.struct([*_SYMMETRY, *_ARRAYS]))),
        #: Wall seconds of reading and detection; null for a mesh whose process died.
        ("seconds", pa.float64()),
        #: The class of an exception of :mod:`intrinsym`, or Unreadable, Timeout, Memory, Crash, Killed.
        ("error_kind", pa.string()),
        ("error", pa.string()),
    ]
)


@dataclass(frozen=True)
class Job:
    """How each mesh is worked on."""

    #: Arguments of :meth:`intrinsym.Mesh.detect`.
    options: dict[str, Any]
    limits: Limits
    #: Kinds of files to bring with a row: see :mod:`intrinsym._mesh_row`.
    write: tuple[str, ...] = ()


class Content(NamedTuple):
    """A mesh file's bytes; None where it cannot be read, with the error's text."""

    name: str
    bytes: bytes | None
    error: str = ""


#: One for each worker of Ray, which keeps it from task to task.
_process: MeshProcess | None = None


def _process_for(limits: Limits) -> MeshProcess:
    global _process
    if _process is None or _process.limits != limits:
        if _process is not None:
            _process.stop()
        _process = MeshProcess(limits)
    return _process


def read(place: Place) -> Content:
    """The bytes of a file, or why they cannot be read."""
    try:
        with place.filesystem.open_input_stream(place.path) as stream:
            return Content(place.name, stream.read())
    except OSError as error:
        return Content(place.name, None, error.strerror or type(error).__name__)


def row_of(content: Content, job: Job) -> Row:
    """The row of one mesh; its process reads a copy, so that the hash is of what was read."""
    if content.bytes is None:
        row = error_row("Unreadable", f"{content.name}: cannot be read: {content.error}")
        return row | {"path": content.name}
    with tempfile.TemporaryDirectory(prefix="intrinsym-") as folder:
        path = os.path.join(folder, "mesh" + os.path.splitext(content.name)[1])
        with open(path, "wb") as file:
            file.write(content.bytes)
        row = _process_for(job.limits).row(path, content.name, job.options, job.write)
    return row | {"path": content.name, "content_hash": hash_of(content.bytes)}


def hash_of(content: bytes) -> str:
    """SHA-256 in hexadecimal."""
    return hashlib.sha256(content).hexdigest()


def table_of(rows: Iterable[Row]) -> pa.Table:
    """The rows in the form of :data:`SCHEMA`."""
    listed = list(rows)
    columns = [pa.array([row.get(column.name) for row in listed], column.type) for column in SCHEMA]
    return pa.table(columns, SCHEMA)
