"""One run over many meshes into a folder of results: does what is missing, and says what it did."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from .._library import library_version
from .._mesh_row import ERROR, Row
from ._dataset import blocks_of, map_blocks
from ._inputs import MeshFile, Place
from ._rows import Content, Job, hash_of, read, row_of, table_of
from ._store import Known, Store, file_path

#: Shares of meshes whose seconds the summary gives.
PERCENTILES = (50, 90, 99, 100)


class Task(NamedTuple):
    """A mesh to look at."""

    place: Place
    #: Its row that is there and will do as long as the file has the same content; None if there is none.
    on_record: Known | None


@dataclass(frozen=True)
class Plan:
    """What a run is to do."""

    job: Job
    store: Store
    cpus_per_mesh: float
    #: As :func:`intrinsym.ray.detect_dataset` takes it.
    memory: int | None
    #: Kinds of errors whose meshes are tried again.
    again: frozenset[str] = frozenset()


def run(plan: Plan, meshes: Sequence[MeshFile], report: Callable[[int, int], object]) -> dict[str, Any]:
    """Makes the rows that are missing and gives back the summary. ``report``: called with the numbers of meshes that
    are looked at and of errors among the new ones."""
    start = time.perf_counter()
    plan.store.clear_staging()
    known = plan.store.known()
    planned = blocks_of(meshes, plan.cpus_per_mesh)
    tasks = [[_task(plan, known, mesh) for mesh in block] for block in planned]
    blocks = map_blocks(tasks, partial(_work_through, plan=plan), plan.cpus_per_mesh, plan.memory)
    looked_at, new, errors = 0, 0, 0
    for batch in blocks.iter_batches(batch_size=None, batch_format="pyarrow", prefetch_batches=0):
        for block in batch.to_pylist():
            _commit(plan.store, known, block)
            looked_at, new, errors = (
                looked_at + block["meshes"],
                new + len(block["paths"]),
                errors + block["errors"],
            )
            report(looked_at, errors)
    summary = summary_of(plan, meshes)
    return summary | {"new_rows": new, "wall_seconds": round(time.perf_counter() - start, 3)}


def _task(plan: Plan, known: dict[str, Known], mesh: MeshFile) -> Task:
    row = known.get(mesh.place.name)
    return Task(mesh.place, None if row is None or row.error_kind in plan.again else row)


def _work_through(tasks: list[Task], plan: Plan) -> pa.Table:
    """What a worker does with a block: stages the rows that are missing, and says so in one row."""
    rows = [row for task in tasks if (row := _new_row(task, plan)) is not None]
    part = plan.store.stage(table_of(rows)) if rows else None
    errors = sum(row["outcome"] == ERROR for row in rows)
    done = {"part": part, "paths": [row["path"] for row in rows], "meshes": len(tasks), "errors": errors}
    kinds = {"part": pa.string(), "paths": pa.list_(pa.string()), "meshes": pa.int64(), "errors": pa.int64()}
    return pa.Table.from_pylist([done], pa.schema(kinds))


def _new_row(task: Task, plan: Plan) -> Row | None:
    """A mesh's row, its files written; None if all that is there."""
    content = read(task.place)
    if _is_done(task, content, plan):
        return None
    row = row_of(content, plan.job)
    for suffix, written in row.get("files", {}).items():
        plan.store.write_file(file_path(task.place, suffix), written)
    return row


def _is_done(task: Task, content: Content, plan: Plan) -> bool:
    if (
        task.on_record is None
        or content.bytes is None
        or hash_of(content.bytes) != task.on_record.content_hash
    ):
        return False
    return task.on_record.error_kind is not None or plan.store.has_files(task.place, plan.job.write)


def _commit(store: Store, known: dict[str, Known], block: dict[str, Any]) -> None:
    """Puts a block's rows among the results, in place of those that were there. A run that ends between the two
    steps leaves rows missing, which the next one makes again."""
    store.remove({path: known[path] for path in block["paths"] if path in known})
    if block["part"] is not None:
        store.commit(block["part"])


def summary_of(plan: Plan, meshes: Sequence[MeshFile]) -> dict[str, Any]:
    """Counts by outcome and kind of error, and percentiles of seconds, of the rows of these meshes."""
    table = plan.store.table(["path", "outcome", "error_kind", "seconds"])
    rows = table.filter(pc.is_in(table["path"], pa.array([mesh.place.name for mesh in meshes])))
    seconds = rows["seconds"].drop_null().to_numpy()
    shares = np.percentile(seconds, PERCENTILES) if len(seconds) else [None] * len(PERCENTILES)
    kinds = (kind for kind in rows["error_kind"].to_pylist() if kind is not None)
    return {
        "version": library_version(),
        "options": plan.job.options,
        "rows": plan.store.folder.at(plan.store.rows).name,
        "meshes": len(meshes),
        "outcomes": dict(Counter(rows["outcome"].to_pylist()).most_common()),
        "errors": dict(Counter(kinds).most_common()),
        "seconds": {
            f"p{share}": value and round(float(value), 4) for share, value in zip(PERCENTILES, shares)
        },
        "total_seconds": round(float(seconds.sum()), 3),
    }
