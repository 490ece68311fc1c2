"""Mesh files as a Ray Dataset of rows."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, TypeVar, Union

import pyarrow as pa
import ray
import ray.data

from .._isolated import Limits
from ..options import options_handle
from ._inputs import MeshFile, Place, find_meshes, place_of
from ._rows import Content, Job, read, row_of, table_of

#: Limits of one mesh where none are given: wall seconds, MB.
TIMEOUT = 600.0
MEMORY = 4000
#: A block is done when it has so many bytes of meshes, or so many meshes: some ten seconds of work.
BLOCK_BYTES = 16_000_000
BLOCK_MESHES = 256
#: Meshes of a caller's Dataset that are worked on as one block; their sizes are not known.
BATCH_MESHES = 16

Block = TypeVar("Block")


def detect_dataset(
    inputs: Union[str, Sequence[str], ray.data.Dataset],
    options: dict[str, Any] | None = None,
    *,
    cpus_per_mesh: float = 1,
    timeout: float = TIMEOUT,
    memory: int | None = None,
) -> ray.data.Dataset:
    """The symmetries of many meshes: a Dataset with a row of :data:`intrinsym.ray.SCHEMA` for each, in no order.

    ``inputs``: folders, patterns, lists of paths (.txt), files, as paths or URIs of pyarrow's filesystems; or a Dataset
    with the column ``path`` and, if it has the files' contents, ``bytes``, as ``ray.data.read_binary_files`` makes it.
    ``options``: arguments of :meth:`intrinsym.Mesh.detect`, such as ``{"effort": "fast"}``. ``cpus_per_mesh``: CPUs
    that Ray keeps for each mesh, and its threads. ``timeout``: wall seconds for one mesh. ``memory``: MB (1,000,000
    bytes) for one mesh, which Ray then keeps free for each; without it 4,000, and Ray keeps none.

    A mesh that is broken, crashes the library or exceeds a limit is a row with the outcome "error"; all others go on.
    Work lost with a worker or a node is done again. Starts Ray where it does not run. Raises OptionError for an option
    that is wrong, FileNotFoundError and ValueError for inputs without meshes.
    """
    job = job_of(options or {}, cpus_per_mesh, timeout, memory)
    if isinstance(inputs, ray.data.Dataset):
        function = partial(_rows_of_batch, job=job)
        resources = resources_of(cpus_per_mesh, memory)
        return inputs.map_batches(function, batch_size=BATCH_MESHES, batch_format="pyarrow", **resources)
    meshes = find_meshes([inputs] if isinstance(inputs, str) else inputs)
    blocks = [[mesh.place for mesh in block] for block in blocks_of(meshes, cpus_per_mesh)]
    return map_blocks(blocks, partial(_rows_of_places, job=job), cpus_per_mesh, memory)


def job_of(
    options: dict[str, Any],
    cpus_per_mesh: float,
    timeout: float,
    memory: int | None,
    write: tuple[str, ...] = (),
) -> Job:
    """The job, with threads and the library's own limit of memory where the options say nothing of them.

    Raises OptionError for wrong options, before anything is started.
    """
    limit = MEMORY if memory is None else memory
    chosen = {"threads": max(1, int(cpus_per_mesh)), "memory": limit, **options}
    numeric = {name: value for name, value in chosen.items() if name not in ("model", "known_signs")}
    options_handle(numeric, None, chosen.get("known_signs"))
    return Job(chosen, Limits(timeout, limit), write)


def blocks_of(meshes: Sequence[MeshFile], cpus_per_mesh: float) -> list[list[MeshFile]]:
    """Meshes that are worked on together: large ones alone and first, small ones in blocks that shrink towards the end,
    so that the last workers end at about the same time."""
    workers = max(1.0, ray.cluster_resources().get("CPU", 1) / cpus_per_mesh)
    waiting = sorted(meshes, key=lambda mesh: -mesh.size)
    blocks: list[list[MeshFile]] = []
    start = 0
    while start < len(waiting):
        most = max(1, min(BLOCK_MESHES, int((len(waiting) - start) / (4 * workers))))
        end, size = start + 1, waiting[start].size
        while end < start + most and size + waiting[end].size <= BLOCK_BYTES:
            size += waiting[end].size
            end += 1
        blocks.append(waiting[start:end])
        start = end
    return blocks


def map_blocks(
    blocks: Sequence[Block],
    function: Callable[[Block], pa.Table],
    cpus_per_mesh: float,
    memory: int | None,
) -> ray.data.Dataset:
    """Runs a function over blocks, one a task of Ray; the rows of its tables."""
    items = [{"block": pickle.dumps(block)} for block in blocks]
    dataset = ray.data.from_items(items, override_num_blocks=len(items))
    return dataset.map_batches(
        partial(_unpacked, function=function),
        batch_size=None,
        batch_format="pyarrow",
        **resources_of(cpus_per_mesh, memory),
    )


def resources_of(cpus_per_mesh: float, memory: int | None) -> dict[str, Any]:
    """What Ray keeps for each task; it runs no more of them on a machine than fit."""
    return {"num_cpus": cpus_per_mesh} | ({} if memory is None else {"memory": memory * 1_000_000})


def _unpacked(batch: pa.Table, function: Callable[[Any], pa.Table]) -> pa.Table:
    return pa.concat_tables(function(pickle.loads(packed)) for packed in batch["block"].to_pylist())


def _rows_of_places(places: list[Place], job: Job) -> pa.Table:
    return table_of(row_of(read(place), job) for place in places)


def _rows_of_batch(batch: pa.Table, job: Job) -> pa.Table:
    """The rows of a caller's batch with the column ``path``, and ``bytes`` if it has them."""
    paths = batch["path"].to_pylist()
    has_bytes = "bytes" in batch.column_names
    contents = batch["bytes"].to_pylist() if has_bytes else [None] * len(paths)
    return table_of(
        row_of(Content(path, content) if has_bytes else read(place_of(path)), job)
        for path, content in zip(paths, contents)
    )
