"""Mirror maps on SHREC'07 "watertight": classes of shapes made by different hands, with landmarks.

    python -m evaluation.watertight DATA --program target/release/intrinsym --out results.json

DATA holds Meshes/NUMBER.off and Corrs/ of V. Kim, Y. Lipman, T. Funkhouser, "Blended Intrinsic Maps", 2011: NUMBER.vts (first column: the
vertex of each landmark) and CLASS.sym.info, as `princeton` describes; the meshes are those of D. Giorgi, S. Biasotti, L. Paraboschi, "SHape
REtrieval Contest 2007: Watertight Models Track". Measured are the eleven classes whose shapes have one mirror plane; cups, chairs, octopuses,
tables, springs, machine parts and vases have several or none, and a hand is not its own mirror image. For measuring, not for choosing.

A landmark is right within sqrt(area / 20) of its true image, a mesh from 75 % right landmarks on. Every map is measured, and whether the
program accepts it by default.
"""

from __future__ import annotations

import argparse
import tempfile
from concurrent.futures import ThreadPoolExecutor
from datetime import date
from pathlib import Path

import numpy as np

from .map_metrics import MESH_RIGHT, THRESHOLD, landmark_distances
from .markdown import table
from .princeton import read_pairs
from .program import Answer, detect, identity, read_answer, write_results
from .remeshed import read_off
from .surface import Surface

# Numbers of the classes, each of which has 20 meshes in a row.
CLASSES = {
    1: "human", 3: "glasses", 4: "plane", 5: "ant", 9: "teddy", 11: "plier", 12: "fish", 13: "bird", 15: "armadillo", 16: "bust", 20: "fourleg",
}  # fmt: skip
MESHES = 20
# What no answer counts, in sqrt(area).
LARGEST_ERROR = 1.0


def read_vertices(corrs: Path, mesh: int) -> np.ndarray:
    """The vertex of each landmark of a mesh."""
    lines = (corrs / f"{mesh}.vts").read_text().splitlines()
    return np.array([int(line.split()[0]) for line in lines if line.strip()])


def judge(mesh: Path, points: np.ndarray, images: np.ndarray, answer: Answer) -> dict:
    """One mesh's row; the mirror image of `points[i]` is `images[i]`. A landmark without an answer has an error of 1."""
    surface = Surface(*read_off(mesh))
    errors = np.minimum(landmark_distances(surface, answer.partners[points], images), LARGEST_ERROR)
    return {
        "name": answer.name, "vertices": len(surface.vertices), "outcome": answer.report["outcome"],
        "error": round(float(errors.mean()), 5), "right": round(float((errors <= THRESHOLD).mean()), 4),
    }  # fmt: skip


def row_of(name: str, rows: list[dict]) -> list[str]:
    """A class in the table."""
    right = np.array([row["right"] >= MESH_RIGHT for row in rows])
    outcomes = [row["outcome"] for row in rows]
    among = [sum(outcome == wanted and good == is_right for outcome, good in zip(outcomes, right)) for is_right in (True, False) for wanted in ("found", "doubtful")]
    errors = np.array([row["error"] for row in rows])
    numbers = [100 * np.mean([row["right"] for row in rows]), 100 * right.mean()]
    return [
        name, str(len(rows)), *(f"{number:.1f}" for number in numbers), f"{errors.mean():.4f}", f"{np.median(errors):.4f}",
        *map(str, among), str(outcomes.count("none")),
    ]  # fmt: skip


def report(result: dict) -> str:
    """The table of the pages."""
    rows = result["meshes"]
    shown = [row_of(name, [row for row in rows if row["class"] == name]) for name in dict.fromkeys(row["class"] for row in rows)]
    shown.append(row_of("**all**", rows))
    head = ["class", "meshes", "corr. %", "mesh %", "mean error", "median error", "right, found", "right, doubtful", "wrong, found", "wrong, doubtful", "none"]
    made = f"`make evaluate-watertight`, {result['date']} ([data](results/{result['date']}-watertight.json)), default options:"
    return f"{made}\n\n{table(head, shown)}"


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("--program", default="target/release/intrinsym")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    corrs = arguments.data / "Corrs"
    if not corrs.is_dir():
        parser.error(f"{arguments.data} holds no Corrs/: see the top of evaluation/watertight.py")
    rows = []
    for number, name in CLASSES.items():
        pairs = read_pairs(corrs / f"{number}.sym.info")
        meshes = [arguments.data / "Meshes" / f"{MESHES * (number - 1) + k}.off" for k in range(1, MESHES + 1)]
        with tempfile.TemporaryDirectory() as folder:
            cpu = detect(arguments.program, meshes, Path(folder), [], arguments.jobs)

            def judged(mesh: Path) -> dict:
                points, images = read_vertices(corrs, int(mesh.stem))[pairs].T
                return {"class": name} | judge(mesh, points, images, read_answer(Path(folder), mesh.stem))

            with ThreadPoolExecutor(arguments.jobs) as pool:
                rows += pool.map(judged, meshes)
        print(f"{name}: {cpu / MESHES:.2f} s of CPU a mesh")
    result = {"date": str(date.today()), "program": identity(arguments.program), "meshes": rows}
    write_results(arguments.out, result)
    print(report(result))


if __name__ == "__main__":
    main()
