"""Meshes that are hard for their form: what they cost, how long nothing is reported, and how soon a cancel ends them.

    python -m evaluation.hard_meshes --out results.json   (the Python package must be found: `make evaluate-hard`)

CPU seconds of one thread, so that other work on the machine counts little. A cancel comes from another thread, at CANCELS moments spread over
the run; what is measured runs from there to the end of the call.
"""

from __future__ import annotations

import argparse
import threading
import time
from collections.abc import Callable
from datetime import date
from pathlib import Path

import numpy as np

from .markdown import table
from .program import write_results

CANCELS = 20
Arrays = tuple[np.ndarray, np.ndarray]


def ring(count: int) -> np.ndarray:
    """Points of a bent ellipse."""
    angle = np.arange(count) * 2 * np.pi / count
    return np.c_[np.cos(angle), 0.8 * np.sin(angle), 0.1 * np.sin(3 * angle)]


def sides(count: int, first: int) -> np.ndarray:
    """Edges of a closed line of `count` vertices."""
    start = np.arange(count)
    return first + np.c_[start, (start + 1) % count]


def ordinary(count: int) -> Arrays:
    """A smooth closed body, without its poles."""
    rows = int(np.sqrt(count))
    u, w = np.meshgrid(np.arange(rows) * 2 * np.pi / rows, (np.arange(rows) + 0.5) * np.pi / rows)
    radius = 1 + 0.3 * np.sin(w) ** 2 * np.cos(2 * u) + 0.2 * np.cos(w)
    points = np.c_[(radius * np.sin(w) * np.cos(u)).ravel(), (1.4 * radius * np.sin(w) * np.sin(u)).ravel(), (radius * np.cos(w)).ravel()]
    row, column = (grid.ravel() for grid in np.meshgrid(np.arange(rows - 1), np.arange(rows), indexing="ij"))
    a, b = row * rows + column, row * rows + (column + 1) % rows
    return points, np.vstack([np.c_[a, a + rows, b + rows], np.c_[a, b + rows, b]])


def hub(count: int) -> Arrays:
    """A disc: all triangles meet in its middle."""
    rim = sides(count - 1, 1)
    return np.vstack([[[0, 0, 0.2]], ring(count - 1)]), np.c_[np.zeros(len(rim), int), rim]


def two_hubs(count: int) -> Arrays:
    """Two discs on one rim."""
    rim = sides(count - 2, 2)
    top, bottom = np.c_[np.zeros(len(rim), int), rim], np.c_[np.ones(len(rim), int), rim[:, ::-1]]
    return np.vstack([[[0, 0, 0.2], [0, 0, -0.3]], ring(count - 2)]), np.vstack([top, bottom])


def fan(count: int) -> Arrays:
    """Triangles on one edge."""
    tips = ring(count - 2) + [0, 0, 0.5]
    return np.vstack([[[0, 0, 0], [0, 0, 1]], tips]), np.c_[np.zeros(count - 2, int), np.ones(count - 2, int), np.arange(2, count)]


def in_single_precision(arrays: Arrays) -> Arrays:
    """The same with coordinates that are rounded: what is all alike in double precision is so no more."""
    points, faces = arrays
    return np.asarray(points).astype(np.float32).astype(float), faces


def strips(count: int) -> Arrays:
    """Strips of four squares from one edge to another, as leaves of a book."""
    leaves = count // 5
    spine = np.array([[0.0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 0, 1], [2, 0, 0]])
    angle = np.arange(leaves) * 2 * np.pi / leaves
    at = lambda radius, height: np.c_[radius * np.cos(angle), radius * np.sin(angle), np.full(leaves, height)]
    points = np.vstack([spine, at(1, 0), at(1, 1), at(2, 0), at(2, 1), at(3, 0.5)])
    a, b, c, d, tip = (5 + k * leaves + np.arange(leaves) for k in range(5))
    low, high = np.zeros(leaves, int), np.ones(leaves, int)
    return points, np.vstack([np.c_[low, high, b], np.c_[low, b, a], np.c_[a, b, d], np.c_[a, d, c], np.c_[c, d, tip]])


def cones(count: int) -> Arrays:
    """Cones that meet in their tips."""
    rim, petals = 20, (count - 1) // 20
    height = 1 - 2 * (np.arange(petals) + 0.5) / petals
    turn, across = 2.399963 * np.arange(petals), np.sqrt(1 - height**2)
    axis = np.c_[across * np.cos(turn), across * np.sin(turn), height]
    u = np.c_[-np.sin(turn), np.cos(turn), np.zeros(petals)]
    v = np.cross(axis, u)
    x, y, _ = 0.5 / np.sqrt(petals) * ring(rim).T
    points = axis[:, None] + x[:, None] * u[:, None] + y[:, None] * v[:, None]
    own = np.vstack([sides(rim, 1 + rim * petal) for petal in range(petals)])
    return np.vstack([[[0, 0, 0]], points.reshape(-1, 3)]), np.c_[np.zeros(len(own), int), own]


def comb(count: int) -> Arrays:
    """One polygon."""
    x = np.arange(count // 4) / (count // 4)
    tooth = np.stack([np.c_[x, 0 * x], np.c_[x, 0 * x + 1], np.c_[x + 0.5 * x[1], 0 * x + 1], np.c_[x + 0.5 * x[1], 0 * x]], axis=1)
    outline = np.vstack([tooth.reshape(-1, 2), [[1, -0.2], [0, -0.2]]])
    return np.c_[outline, np.zeros(len(outline))], np.arange(len(outline))[None, ::-1]


def squares(count: int) -> Arrays:
    """Loose squares, one in another."""
    size = 1 + np.arange(count // 4) / (count // 4)
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    return (size[:, None, None] * corners + np.c_[0 * size, 0 * size, size][:, None]).reshape(-1, 3), np.arange(count // 4 * 4).reshape(-1, 4)


def loose(count: int) -> Arrays:
    """Loose triangles at random."""
    random, triangles = np.random.default_rng(2), count // 3
    points = random.random((triangles, 1, 3)) + 0.03 * random.random((triangles, 3, 3))
    return points.reshape(-1, 3), np.arange(3 * triangles).reshape(-1, 3)


def tangle(count: int) -> Arrays:
    """Triangles between vertices at random."""
    random = np.random.default_rng(0)
    return random.normal(size=(count, 3)), random.integers(0, count, (count, 3))


MESHES: dict[str, Callable[[], Arrays]] = {
    "ordinary": lambda: ordinary(100_000),
    "a hub: a disc about one vertex": lambda: hub(50_001),
    "the same, twice as fine": lambda: hub(100_001),
    "two hubs on one rim": lambda: two_hubs(100_002),
    "a fan on one edge": lambda: fan(100_002),
    "the same in single precision, as hosts hold it": lambda: in_single_precision(fan(100_002)),
    "20,000 strips on one edge": lambda: strips(100_000),
    "cones that meet in their tips": lambda: cones(100_001),
    "a comb, one polygon": lambda: comb(100_000),
    "25,000 nested squares": lambda: squares(100_000),
    "loose triangles": lambda: loose(99_999),
    "triangles between vertices at random": lambda: tangle(100_000),
}


def run(mesh: object, cancel_after: float | None = None) -> dict:
    """One detection: CPU seconds, the longest without a report and what was reported before it, or from a cancel to the end."""
    import intrinsym

    start, reports = time.process_time(), []
    progress = intrinsym.Progress(lambda stage, _: reports.append((time.process_time(), stage)))
    cancelled: list[float] = []

    def cancel() -> None:
        while time.process_time() - start < cancel_after:
            time.sleep(0.002)
        cancelled.append(time.process_time())
        progress.cancel()

    watcher = threading.Thread(target=cancel, daemon=True) if cancel_after is not None else None
    if watcher:
        watcher.start()
    try:
        mesh.detect(progress=progress, threads=1)
    except intrinsym.CancelledError:
        pass
    end = time.process_time()
    if watcher:
        watcher.join()
        return {"after_cancel": end - cancelled[0]}
    times = [*(at for at, _ in reports), end]
    gaps = [(later - at, stage) for (at, stage), later in zip(reports, times[1:])]
    longest, stage = max(gaps)
    return {"seconds": end - start, "longest_wait": longest, "after_report_of": stage}


def measured(name: str, arrays: Arrays) -> dict:
    """A row of the table."""
    import intrinsym

    start = time.process_time()
    mesh = intrinsym.Mesh(*arrays)
    making = time.process_time() - start
    whole = run(mesh)
    moments = whole["seconds"] * (np.arange(CANCELS) + 0.5) / CANCELS
    after = max(run(mesh, moment)["after_cancel"] for moment in moments)
    row = {"mesh": name, "vertices": len(arrays[0]), "making": making, **whole, "after_cancel": after}
    return {key: round(value, 3) if isinstance(value, float) else value for key, value in row.items()}


def report(result: dict) -> str:
    """The table."""
    rows = result["rows"]
    ordinary_one = rows[0]["seconds"]
    shown = [
        [row["mesh"], f"{row['vertices']:,}", f"{row['seconds']:.2f}", f"{row['seconds'] / ordinary_one:.1f}", f"{row['longest_wait']:.2f}", row["after_report_of"], f"{row['after_cancel']:.2f}", f"{row['making']:.2f}"]
        for row in rows
    ]
    header = ["mesh", "vertices", "seconds", "times the ordinary one", "longest wait", "after the report of", "after cancel", "making the mesh"]
    return f"`make evaluate-hard`, {result['date']} ([data](results/{result['date']}-hard.json)):\n\n{table(header, shown)}"


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    result = {"date": str(date.today()), "rows": [measured(name, make()) for name, make in MESHES.items()]}
    write_results(arguments.out, result)
    print(report(result))


if __name__ == "__main__":
    main()
