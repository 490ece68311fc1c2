"""The folder of results: Parquet files that are there whole or not at all, each mesh in one of them.

A task writes its rows into a folder that nobody reads; only the driver moves them to the results. So a task that Ray
runs twice, or one that outlives its driver, adds nothing. The folder is::

    rows/options=KEY/PART.parquet   the table, one folder for each set of options and version of the library
    maps/PATH.map, ply/PATH.ply     if asked for
    summary.json                    what the last command did
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import uuid
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import pyarrow as pa
import pyarrow.parquet as pq
from pyarrow import fs

from .._library import library_version
from ._inputs import Place

#: Options that do not change an answer: what was computed with others is good.
WITHOUT_EFFECT = ("threads", "memory")


class Known(NamedTuple):
    """What is on record of a mesh."""

    content_hash: str | None
    error_kind: str | None
    #: Name of the Parquet file with its row.
    part: str


class Busy(Exception):
    """Another command works on the folder."""


@dataclass(frozen=True)
class Store:
    """The results of one set of options. Small enough to be sent to every task."""

    folder: Place
    key: str

    @classmethod
    def open(cls, folder: Place, options: dict[str, Any]) -> Store:
        """The results with these options in the folder, which is made if it is not there."""
        store = cls(folder, options_key(options))
        for path in (store.rows, store.staging):
            folder.filesystem.create_dir(path, recursive=True)
        return store

    @property
    def rows(self) -> str:
        """Where the Parquet files are."""
        return f"{self.folder.path}/rows/options={self.key}"

    @property
    def staging(self) -> str:
        """Where files are written before they count; what lies here at the start was lost with an earlier run."""
        return f"{self.folder.path}/.staging"

    def clear_staging(self) -> None:
        """Removes what earlier runs left half-done."""
        self.folder.filesystem.delete_dir_contents(self.staging, missing_dir_ok=True)

    @contextlib.contextmanager
    def lock(self) -> Iterator[None]:
        """Keeps a second command off the folder, on a local one. Raises Busy."""
        if not isinstance(self.folder.filesystem, fs.LocalFileSystem):
            yield
            return
        import fcntl

        with open(f"{self.folder.path}/.lock", "w") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise Busy(f"{self.folder.name}: another intrinsym-batch works on this folder") from None
            yield

    def stage(self, table: pa.Table) -> str:
        """Writes rows that do not count yet; the name to commit them by."""
        name = f"{uuid.uuid4().hex}.parquet"
        with self.folder.filesystem.open_output_stream(f"{self.staging}/{name}") as stream:
            pq.write_table(table, stream, compression="zstd")
        return name

    def commit(self, name: str) -> None:
        """Makes staged rows count, from one moment to the next."""
        self._move(f"{self.staging}/{name}", f"{self.rows}/{name}")

    def write_file(self, path: str, content: bytes) -> None:
        """Writes a file of the folder, whole or not at all; ``path`` is relative to the folder."""
        staged, target = f"{self.staging}/{uuid.uuid4().hex}", f"{self.folder.path}/{path}"
        self.folder.filesystem.create_dir(target.rpartition("/")[0], recursive=True)
        with self.folder.filesystem.open_output_stream(staged) as stream:
            stream.write(content)
        self._move(staged, target)

    def _move(self, source: str, target: str) -> None:
        filesystem = self.folder.filesystem
        if filesystem.type_name == "hdfs" and self._exists(target):
            filesystem.delete_file(target)  # HDFS does not replace
        filesystem.move(source, target)

    def _exists(self, path: str) -> bool:
        return bool(self.folder.filesystem.get_file_info(path).type != fs.FileType.NotFound)

    def has_files(self, place: Place, write: tuple[str, ...]) -> bool:
        """Whether a mesh's files of these kinds are there."""
        return all(self._exists(f"{self.folder.path}/{file_path(place, f'.{kind}')}") for kind in write)

    def known(self) -> dict[str, Known]:
        """What is on record, by path of the mesh. A file that cannot be read, after a power failure, is removed."""
        found: dict[str, Known] = {}
        for name in self._parts():
            try:
                table = self._read(name, ["path", "content_hash", "error_kind"])
            except (pa.ArrowInvalid, OSError):
                if not self._is_broken(name):
                    raise
                self.folder.filesystem.delete_file(f"{self.rows}/{name}")
                continue
            for path, content_hash, error_kind in zip(*(column.to_pylist() for column in table.columns)):
                found[path] = Known(content_hash, error_kind, name)
        return found

    def remove(self, meshes: dict[str, Known]) -> None:
        """Takes the rows of these meshes out, by path, so that new ones may take their place."""
        by_part: defaultdict[str, set[str]] = defaultdict(set)
        for path, known in meshes.items():
            by_part[known.part].add(path)
        for name, gone in by_part.items():
            table = self._read(name)
            left = table.filter(pa.array([path not in gone for path in table["path"].to_pylist()]))
            if left.num_rows:
                self._move(f"{self.staging}/{self.stage(left)}", f"{self.rows}/{name}")
            else:
                self.folder.filesystem.delete_file(f"{self.rows}/{name}")

    def table(self, columns: list[str]) -> pa.Table:
        """These columns of all rows."""
        return pa.concat_tables(self._read(name, columns) for name in self._parts())

    def _is_broken(self, name: str) -> bool:
        """Whether a file's own bytes are at fault. Raises OSError where they cannot be had, as from a store that is away."""
        with self.folder.filesystem.open_input_stream(f"{self.rows}/{name}") as stream:
            content = stream.read()
        try:
            pq.ParquetFile(pa.BufferReader(content)).read()
        except (pa.ArrowInvalid, OSError):
            return True
        return False

    def _parts(self) -> list[str]:
        infos = self.folder.filesystem.get_file_info(fs.FileSelector(self.rows, allow_not_found=True))
        return sorted(info.base_name for info in infos if info.extension == "parquet")

    def _read(self, name: str, columns: list[str] | None = None) -> pa.Table:
        with self.folder.filesystem.open_input_file(f"{self.rows}/{name}") as file:
            return pq.ParquetFile(file).read(columns)


def file_path(place: Place, suffix: str) -> str:
    """Where a mesh's map or PLY lies in the folder: its whole path again, so that no two meshes share one."""
    kind = "maps" if suffix.endswith(".map") else "ply"
    return f"{kind}/{place.path.lstrip('/')}{suffix}"


def options_key(options: dict[str, Any]) -> str:
    """12 hexadecimal digits for the library's version and the options that change an answer."""
    effective = {name: value for name, value in options.items() if name not in WITHOUT_EFFECT}
    text = json.dumps([library_version(), effective], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:12]
