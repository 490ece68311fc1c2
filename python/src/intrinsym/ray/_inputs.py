"""Finds the mesh files of what was asked for: folders, patterns, lists of paths, files, on any filesystem of pyarrow."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import NamedTuple
from urllib.parse import quote, unquote, urlsplit

from pyarrow import fs

#: Formats that the library reads, each mesh in one file.
MESH_SUFFIXES = (".ply", ".obj", ".off", ".stl", ".glb")
#: Text files with one path a line.
LIST_SUFFIXES = (".txt", ".list")


class Place(NamedTuple):
    """A path and the filesystem that it lies on."""

    filesystem: fs.FileSystem
    #: As the filesystem takes it.
    path: str
    #: What a URI has before it, such as "s3://" or "hdfs://host:8020"; empty on this machine.
    root: str = ""

    @property
    def name(self) -> str:
        """The path as a person writes it: absolute on this machine, a URI elsewhere."""
        return self.root + quote(self.path) if self.root else self.path

    def at(self, path: str) -> Place:
        """Another path of the same filesystem."""
        return self._replace(path=path)


class MeshFile(NamedTuple):
    """One input."""

    place: Place
    #: Bytes; 0 where there is no such file.
    size: int


def place_of(text: str) -> Place:
    """A path, or a URI such as s3://bucket/folder, hdfs://host/folder, file:///folder.

    What a filesystem needs to know may follow a URI, as in s3://bucket/folder?endpoint_override=host:9000. Raises
    ValueError for a scheme that pyarrow does not know, and OSError where it cannot connect.
    """
    if "://" not in text:
        return Place(fs.LocalFileSystem(), os.path.abspath(os.path.expanduser(text)))
    filesystem, path = fs.FileSystem.from_uri(text)
    uri = urlsplit(text)
    if uri.scheme == "file":
        return Place(filesystem, path)
    # S3 and the like have the host, which is the bucket, in the path.
    host = "" if path.split("/")[0] == uri.netloc else uri.netloc
    return Place(filesystem, path, f"{uri.scheme}://{host}")


def find_meshes(inputs: Iterable[str], without: Place | None = None) -> list[MeshFile]:
    """The mesh files of all inputs, each once, in order; those in the folder ``without`` are left out.

    A folder stands for all mesh files in it and below; a pattern may hold ``*``, ``[...]`` and ``**``, and ``?`` where
    it is no URI; a file named .txt or .list holds one path a line, relative to the current folder. A path in a list
    that leads nowhere stays in, and its row will say so. Raises FileNotFoundError for an input that leads nowhere,
    ValueError where no mesh file is left.
    """
    found: dict[str, MeshFile] = {}
    for text in inputs:
        for mesh in _meshes_of(text):
            if without is None or not mesh.place.name.startswith(without.name.rstrip("/") + "/"):
                found.setdefault(mesh.place.name, mesh)
    if not found:
        raise ValueError(f"no mesh files ({', '.join(MESH_SUFFIXES)}) in the inputs")
    return list(found.values())


def _meshes_of(text: str) -> Iterator[MeshFile]:
    whole, _, query = text.partition("?") if "://" in text else (text, "", "")
    if re.search(r"[*?\[]", whole):
        yield from _matching(whole, query)
        return
    place = place_of(text)
    info = place.filesystem.get_file_info(place.path)
    if info.type == fs.FileType.NotFound:
        raise FileNotFoundError(f"{text}: no such file or folder")
    if info.type == fs.FileType.Directory:
        yield from _files(place, recursive=True)
    elif place.path.lower().endswith(LIST_SUFFIXES):
        yield from _listed(place)
    else:
        yield MeshFile(place, info.size)


def _matching(pattern: str, query: str) -> Iterator[MeshFile]:
    """Mesh files that a pattern matches, looked for below its part without wildcards."""
    fixed = re.split(r"[*?\[]", pattern)[0].rpartition("/")[0]
    beginning = fixed or ("/" if pattern.startswith("/") else ".")
    start = place_of(f"{beginning}?{query}" if query else beginning)
    rest = pattern[len(fixed) :].lstrip("/")
    expression = re.compile(re.escape(start.path.rstrip("/")) + "/" + _expression(rest))
    for mesh in _files(start, recursive="/" in rest or "**" in rest):
        if expression.fullmatch(mesh.place.path):
            yield mesh


def _expression(pattern: str) -> str:
    """A regular expression: ``*`` stays in one folder, ``**/`` goes through any number of them."""
    wild = {"**/": "(?:.*/)?", "**": ".*", "*": "[^/]*", "?": "[^/]"}
    words = re.findall(r"\*\*/|\*\*|\*|\?|\[[^]]+\]|.", pattern)
    return "".join(wild.get(word) or (word if len(word) > 1 else re.escape(word)) for word in words)


def _files(folder: Place, recursive: bool) -> Iterator[MeshFile]:
    selector = fs.FileSelector(folder.path, allow_not_found=True, recursive=recursive)
    for info in sorted(folder.filesystem.get_file_info(selector), key=lambda info: info.path):
        if info.type == fs.FileType.File and info.path.lower().endswith(MESH_SUFFIXES):
            yield MeshFile(folder.at(info.path), info.size)


def _listed(file: Place) -> Iterator[MeshFile]:
    with file.filesystem.open_input_stream(file.path) as stream:
        lines = [line.strip() for line in stream.read().decode().splitlines()]
    connections: dict[str, Place] = {}
    places = [_connected(line, connections) for line in lines if line]
    for _, group in groupby(places, key=lambda place: id(place.filesystem)):
        together = list(group)
        infos = together[0].filesystem.get_file_info([place.path for place in together])
        yield from (MeshFile(place, info.size or 0) for place, info in zip(together, infos))


def _connected(text: str, connections: dict[str, Place]) -> Place:
    """As :func:`place_of`, with one connection for all paths of a host or bucket."""
    if "://" not in text:
        return connections.setdefault("", place_of(text)).at(os.path.abspath(os.path.expanduser(text)))
    uri = urlsplit(text)
    host = f"{uri.scheme}://{uri.netloc}?{uri.query}"
    if host not in connections:
        connections[host] = place_of(text)
    known = connections[host]
    bucket = uri.netloc if known.path.split("/")[0] == uri.netloc else ""
    return known.at(bucket + unquote(uri.path))
