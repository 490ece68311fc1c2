"""Geodesic error on remeshed FAUST and TOSCA, whose left and right share no connectivity.

    python -m evaluation.remeshed DATA --program target/release/intrinsym --out results.json [--options "..."]

DATA holds the data set of J. Ren, A. Poulenard, P. Wonka, M. Ovsjanikov, "Continuous and Orientation-preserving
Correspondences via Functional Maps", 2018 (github: llorz/SGA18_orientation_BCICP_dataset, folder Dataset):
SET/vtx_5k/NAME.off, and in corres/ NAME.vts and NAME.sym.vts, 1-based: line i of the second is the mirror image
of line i of the first. For measuring, not for choosing.

The error of a vertex is the shortest way along edges from the answered to the true partner over sqrt(area); ways
along edges are a few per cent longer than geodesics. 250 vertices of each mesh are measured.
"""

from __future__ import annotations

import argparse
import shlex
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from datetime import date
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from . import markdown
from .program import detect, identity, read_answer, write_results

MEASURED = 250
# A map whose mean error is above this pairs the wrong limbs, or moves too little.
WRONG = 0.1
# Names of the sets' folders, and what the tables call them.
SETS = {"FAUST": "FAUST", "TOSCA_Isometric": "TOSCA, within classes", "TOSCA_nonIsometric": "TOSCA, across classes"}
NO_PARTNER_ERROR = 1.0


@dataclass
class Result:
    """What was answered for one mesh; `error` is None if no symmetry was found."""

    set: str
    name: str
    found: bool
    plausibility: float | None
    error: float | None
    seconds: float


def read_off(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) and triangles (m, 3)."""
    lines = path.read_text().split("\n")
    vertices, faces = map(int, lines[1].split()[:2])
    rows = [line.split() for line in lines[2 : 2 + vertices + faces]]
    return np.array([row[:3] for row in rows[:vertices]], float), np.array([row[1:4] for row in rows[vertices:]], int)


def edge_graph(vertices: np.ndarray, faces: np.ndarray):
    """Edges weighted by length over sqrt(area)."""
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    lengths = np.linalg.norm(vertices[ends[:, 0]] - vertices[ends[:, 1]], axis=1) / np.sqrt(area)
    graph = coo_matrix((lengths, ends.T), shape=(len(vertices),) * 2).tocsr()
    return graph.maximum(graph.T)


def mean_error(mesh: Path, partners: np.ndarray) -> float:
    """Mean error of the map over the measured vertices."""
    truth = mesh.parent / "corres" / mesh.name
    source, image = (np.loadtxt(truth.with_suffix(end), dtype=int) - 1 for end in (".vts", ".sym.vts"))
    picked = np.linspace(0, len(source) - 1, MEASURED).astype(int)
    ways = dijkstra(edge_graph(*read_off(mesh)), directed=False, indices=image[picked])
    answered = partners[source[picked]]
    errors = np.where(answered >= 0, ways[np.arange(MEASURED), np.maximum(answered, 0)], NO_PARTNER_ERROR)
    return float(np.minimum(errors, NO_PARTNER_ERROR).mean())


def measure(program: str, mesh: Path, options: list[str]) -> Result:
    """Runs the program on a mesh and judges its answer."""
    with tempfile.TemporaryDirectory() as folder:
        detect(program, [mesh], Path(folder), options)
        answer = read_answer(Path(folder), mesh.stem)
    error = mean_error(mesh, answer.partners) if answer.has_map else None
    return Result(mesh.parts[-3], mesh.stem, answer.found, answer.plausibility, error, sum(answer.seconds.values()))


def table(rows: list[dict]) -> str:
    """One row a set."""
    shown = []
    for name in dict.fromkeys(row["set"] for row in rows):
        of_set = [row for row in rows if row["set"] == name]
        errors = np.array([row["error"] for row in of_set if row["found"]])
        middle = [f"{errors.mean():.4f}", f"{np.median(errors):.4f}"] if len(errors) else ["-", "-"]
        seconds = f"{np.median([row['seconds'] for row in of_set]):.2f}"
        shown.append([SETS.get(name, name), len(of_set), len(errors), (errors > WRONG).sum(), *middle, seconds])
    return markdown.table(["set", "meshes", "answered", "of them wrong", "mean error", "median error", "median s"], shown)


def unanswered_or_wrong(rows: list[dict]) -> str:
    """The meshes that went wrong, in words."""
    refused = [f"`{row['name']}` (plausibility {100 * (row['plausibility'] or 0):.0f} %)" for row in rows if not row["found"]]
    wrong = [f"`{row['name']}` (error {row['error']:.3f})" for row in rows if row["found"] and row["error"] > WRONG]
    return f"Without an answer: {', '.join(refused) or 'none'}. Wrong: {', '.join(wrong) or 'none'}."


def report(result: dict) -> str:
    """The table of the pages."""
    made = f"`make evaluate-remeshed`, default options, {result['date']} ([data](results/{result['date']}-remeshed.json)):"
    return f"{made}\n\n{table(result['meshes'])}\n\n{unanswered_or_wrong(result['meshes'])}"


def short_report(result: dict) -> str:
    """The table of the README."""
    made = f"`make evaluate-remeshed`, {result['date']} ([data](docs/results/{result['date']}-remeshed.json))."
    return f"{table(result['meshes'])}\n\n{made}"


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("--program", default="target/release/intrinsym")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--options", default="", type=shlex.split, help="options of `intrinsym detect`, as one word")
    arguments = parser.parse_args()
    meshes = sorted(arguments.data.glob("*/vtx_5k/*.off"))
    if not meshes:
        parser.error(f"{arguments.data} holds no SET/vtx_5k/NAME.off: see the top of this file")
    with ThreadPoolExecutor(arguments.jobs) as pool:
        rows = [asdict(row) for row in pool.map(lambda mesh: measure(arguments.program, mesh, arguments.options), meshes)]
    result = {"date": str(date.today()), "program": identity(arguments.program), "options": arguments.options, "meshes": rows}
    write_results(arguments.out, result)
    print(report(result))


if __name__ == "__main__":
    main()
