"""Whether the same shape gives the same answer: twelve generated meshes, each written in ten other ways.

    python -m evaluation.stability --out results.json [--program target/release/intrinsym]

A CHANGE writes a mesh with other numbers, another order of faces, in another place or size, or with rounding or noise far below what a
scanner or an exporter leaves. Vertices are compared by their first numbers.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from datetime import date
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from training.meshfile import read_ply, write_ply

from . import accuracy
from .markdown import table
from .program import Answer, detect, identity, read_answer, write_results

SEED = 9100
# As in `accuracy.GROUPS`; `robot` is posed.
GROUPS = {
    "people": {"person": (2,), "biped": (0,)},
    "animals": {"quadruped": (2,), "bird": (1,), "insect": (5,), "sea-star": (2,)},
    "trees": {"random": (5,)},
    "blobs": {"blob": (1,)},
    "plates": {"plate": (4,)},
    "furniture": {"chair": (8,)},
    "assemblies": {"vehicle": (2,), "robot": (0,)},
}
# Of the diagonal of the bounding box.
NOISE = 1e-6
# What is asked of changed partners, in general and at worst, and of their mean move, in edges.
CHANGED, CHANGED_AT_WORST, MOVED = 0.01, 0.03, 0.1


@dataclass
class Written:
    """A mesh, and the first number of each of its vertices."""

    vertices: np.ndarray
    faces: np.ndarray
    first: np.ndarray


def moved(matrix: np.ndarray, shift: float = 0.0) -> Callable[[np.ndarray, np.ndarray, np.random.Generator], Written]:
    """Another place or size; `matrix` may be a number."""
    return lambda vertices, faces, _: Written(vertices @ np.asarray(matrix).T if np.ndim(matrix) else matrix * vertices + shift, faces, np.arange(len(vertices)))


def renumbered(vertices: np.ndarray, faces: np.ndarray, random: np.random.Generator) -> Written:
    """Vertices in another order."""
    first = random.permutation(len(vertices))
    return Written(vertices[first], np.argsort(first)[faces], first)


def reordered(vertices: np.ndarray, faces: np.ndarray, random: np.random.Generator) -> Written:
    """Faces in another order, each from another corner on."""
    turned = (np.arange(3) + random.integers(0, 3, (len(faces), 1))) % 3
    return Written(vertices, np.take_along_axis(faces, turned, 1)[random.permutation(len(faces))], np.arange(len(vertices)))


def mirrored(vertices: np.ndarray, faces: np.ndarray, _: np.random.Generator) -> Written:
    """The mirror image in x, its faces turned over."""
    return Written(vertices * [-1, 1, 1], faces[:, ::-1], np.arange(len(vertices)))


def noisy(vertices: np.ndarray, faces: np.ndarray, random: np.random.Generator) -> Written:
    """Noise of NOISE."""
    size = np.linalg.norm(np.ptp(vertices, axis=0))
    return Written(vertices + NOISE * size * random.uniform(-1, 1, vertices.shape), faces, np.arange(len(vertices)))


CHANGES = {
    "vertices renumbered": renumbered,
    "faces reordered": reordered,
    "turned": moved(Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()),
    "turned otherwise": moved(Rotation.from_rotvec([-2.0, 0.5, 1.3]).as_matrix()),
    "lying down": moved(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])),
    "mirrored": mirrored,
    "in millimetres": moved(1000.0),
    "a third as large": moved(1 / 3),
    "elsewhere": moved(1.0, 10.0),
    "noise of 1e-6": noisy,
}


def compared(before: Answer, after: Answer, written: Written, vertices: np.ndarray, edge: float) -> dict:
    """What has changed: the share of partners, their mean move in edges, and whether the outcome has."""
    partners = np.full(len(vertices), -1)
    partners[written.first] = np.where(after.partners >= 0, written.first[after.partners], -1)
    both = (partners >= 0) & (before.partners >= 0)
    move = np.linalg.norm(vertices[partners[both]] - vertices[before.partners[both]], axis=1) / edge
    return {
        "changed": round(float(np.mean(partners != before.partners)), 5),
        "moved": round(float(move.mean()) if both.any() else 0.0, 5),
        "outcomes": [before.report["outcome"], after.report["outcome"]],
    }


def mean_edge(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Over the sides of all faces."""
    return float(np.linalg.norm(vertices[faces] - vertices[np.roll(faces, 1, axis=1)], axis=2).mean())


def measured(program: str, paths: list[Path]) -> list[dict]:
    """One row for each mesh and change."""
    rows = []
    with tempfile.TemporaryDirectory() as work:
        detect(program, paths, Path(work) / "first", [], jobs=2)
        meshes = {path.stem: read_ply(path) for path in paths}
        for number, (change, write) in enumerate(CHANGES.items()):
            folder = Path(work) / str(number)
            folder.mkdir()
            written = {name: write(*mesh, np.random.default_rng([SEED, number])) for name, mesh in meshes.items()}
            for name, mesh in written.items():
                write_ply(folder / f"{name}.ply", mesh.vertices, mesh.faces)
            detect(program, [folder / f"{name}.ply" for name in written], folder / "answers", [], jobs=2)
            for name, (vertices, faces) in meshes.items():
                before, after = read_answer(Path(work) / "first", name), read_answer(folder / "answers", name)
                row = compared(before, after, written[name], vertices, mean_edge(vertices, faces))
                rows.append({"mesh": name, "change": change, **row})
    return rows


def report(result: dict) -> str:
    """Tables by change and by mesh."""
    rows = result["rows"]

    def by(key: str) -> str:
        shown = []
        for name in dict.fromkeys(row[key] for row in rows):
            own = [row for row in rows if row[key] == name]
            changed, other = [row["changed"] for row in own], sum(row["outcomes"][0] != row["outcomes"][1] for row in own)
            shown.append([name, f"{100 * np.median(changed):.2f}", f"{100 * max(changed):.2f}", f"{np.mean([row['moved'] for row in own]):.3f}", str(other)])
        return table([key, "partners changed %, median", "most", "mean move, edges", "other outcome"], shown)

    changed = [row["changed"] for row in rows]
    verdict = (
        f"Of {len(rows)} comparisons {np.mean([value < CHANGED for value in changed]):.0%} change less than {CHANGED:.0%} of the partners and "
        f"{np.mean([value < CHANGED_AT_WORST for value in changed]):.0%} less than {CHANGED_AT_WORST:.0%}; "
        f"{np.mean([row['moved'] < MOVED for row in rows]):.0%} move them by less than {MOVED} edges in the mean."
    )
    made = f"`make evaluate-stability`, {result['date']} ([data](results/{result['date']}-stability.json)), {result['program']}:"
    return f"{made}\n\n{verdict}\n\n{by('change')}\n\n{by('mesh')}"


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/intrinsym")
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = measured(arguments.program, [case.path for case in accuracy.cases(Path(folder), GROUPS)])
    result = {"date": str(date.today()), "program": identity(arguments.program), "rows": rows}
    write_results(arguments.out, result)
    print(report(result))


if __name__ == "__main__":
    main()
