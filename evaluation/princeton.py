"""The Princeton correspondence benchmark: SCAPE and TOSCA with landmarks.

    python -m evaluation.princeton DATA --program target/release/intrinsym --out results.json [--pictures FOLDER]

DATA holds SCAPE/ and TOSCA/ of V. Kim, Y. Lipman, T. Funkhouser, "Blended Intrinsic Maps", 2011, each with Meshes/NAME.off,
Corrs/CLASS.pid (first column: the vertex of each landmark) and Corrs/CLASS.sym.info ("i j": landmarks that are mirror images,
"i": one on the symmetry plane). For measuring, not for choosing.

Every mesh is measured with the default options, where a mesh that is said to have no symmetry counts as wrong; those that are
refused are measured once more with `--plausibility 0`, which accepts every map and changes none that was accepted. Prints the
tables of `princeton_tables`.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from datetime import date
from pathlib import Path

import numpy as np

from . import princeton_tables
from .map_metrics import MapMetrics, measure
from .program import Answer, detect, identity, read_answer, write_results
from .remeshed import read_off
from .surface import Surface

SETS = ("SCAPE", "TOSCA")
ACCEPT_ALL = ["--plausibility", "0"]
PICTURES = 10


@dataclass
class Entry:
    """One mesh of the benchmark and its landmarks: the mirror image of `points[i]` is `images[i]`."""

    set: str
    mesh_class: str
    path: Path
    points: np.ndarray
    images: np.ndarray


def read_pairs(path: Path) -> np.ndarray:
    """Rows (landmark, landmark of its mirror image), both ways; lines with more than two numbers, and remarks, say nothing of these."""
    pairs = set()
    for line in path.read_text().splitlines():
        words = line.split()
        if len(words) in (1, 2) and all(word.isdigit() for word in words):
            first, last = int(words[0]), int(words[-1])
            pairs |= {(first, last), (last, first)}
    return np.array(sorted(pairs))


def read_landmarks(corrs: Path, mesh_class: str) -> tuple[np.ndarray, np.ndarray]:
    """Vertices of the landmarks that have a mirror image, and the vertices of these images."""
    vertices = np.array(
        [int(line.split()[0]) for line in (corrs / f"{mesh_class}.pid").read_text().splitlines() if line.strip()]
    )
    pairs = read_pairs(corrs / f"{mesh_class}.sym.info")
    return tuple(vertices[pairs].T)


def benchmark(data: Path, name: str) -> list[Entry]:
    """The meshes of a set. Those that were cut open have another number of vertices than their class: their landmarks
    are void, and they are left out, which leaves 71 and 80 as in the literature."""
    classes: dict[str, list[tuple[Path, int]]] = {}
    for path in sorted((data / name / "Meshes").glob("*.off")):
        if ".hks" in path.name:
            continue
        with open(path) as file:
            file.readline()
            count = int(file.readline().split()[0])
        mesh_class = "1" if name == "SCAPE" else path.stem.rstrip("0123456789")
        classes.setdefault(mesh_class, []).append((path, count))
    entries = []
    for mesh_class, members in classes.items():
        usual = Counter(count for _, count in members).most_common(1)[0][0]
        points, images = read_landmarks(data / name / "Corrs", mesh_class)
        shown = "scape" if name == "SCAPE" else mesh_class
        entries += [Entry(name, shown, path, points, images) for path, count in members if count == usual]
    return entries


def judge(entry: Entry, answer: Answer) -> dict:
    """One mesh's row of the result file."""
    surface = Surface(*read_off(entry.path))
    metrics: MapMetrics = measure(surface, answer.partners, entry.points, entry.images)
    return {
        "set": entry.set, "class": entry.mesh_class, "name": answer.name, "vertices": len(answer.partners),
        "found": answer.found, "plausibility": _rounded(answer.plausibility),
        **{name: _rounded(value) for name, value in asdict(metrics).items()},
        "seconds": {stage: _rounded(seconds, 4) for stage, seconds in answer.seconds.items()},
    }  # fmt: skip


def _rounded(value: float | None, digits: int = 5) -> float | None:
    return None if value is None or not np.isfinite(value) else round(float(value), digits)


def run(program: str, entries: list[Entry], options: list[str], jobs: int) -> tuple[list[dict], dict[str, float]]:
    """Rows of all meshes, and CPU seconds of the whole process by set."""
    rows, cpu = [], {}
    for name in SETS:
        chosen = [entry for entry in entries if entry.set == name]
        if not chosen:
            continue
        with tempfile.TemporaryDirectory() as folder:
            cpu[name] = round(detect(program, [entry.path for entry in chosen], Path(folder), options, jobs), 2)
            answers = [read_answer(Path(folder), entry.path.stem) for entry in chosen]
            with ThreadPoolExecutor(jobs) as pool:
                rows += pool.map(judge, chosen, answers)
        print(f"{name} {' '.join(options) or 'default options'}: {len(chosen)} meshes", file=sys.stderr)
    return rows, cpu


def draw_worst(program: str, entries: list[Entry], rows: list[dict], folder: Path) -> None:
    """Pictures of the maps with the largest mean errors, accepted or not."""
    worst = {row["name"] for row in princeton_tables.worst_first(rows)[:PICTURES]}
    paths = [entry.path for entry in entries if entry.path.stem in worst]
    detect(program, paths, folder, ACCEPT_ALL, write="png")
    print(f"pictures of the worst {len(paths)}: {folder}", file=sys.stderr)


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("--program", default="target/release/intrinsym")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--pictures", type=Path, help=f"folder for pictures of the worst {PICTURES} meshes")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="only these meshes, as cat9")
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    absent = [name for name in SETS if not (arguments.data / name / "Meshes").is_dir()]
    if absent:
        parser.error(f"{arguments.data} holds no {absent[0]}/Meshes: see the top of evaluation/princeton.py")
    entries = [entry for name in SETS for entry in benchmark(arguments.data, name)]
    if arguments.only:
        entries = [entry for entry in entries if entry.path.stem in arguments.only]
    default, cpu = run(arguments.program, entries, [], arguments.jobs)
    refused = [entry for entry, row in zip(entries, default) if not row["found"]]
    accepted, _ = run(arguments.program, refused, ACCEPT_ALL, arguments.jobs)
    result = {
        "date": str(date.today()),
        "program": identity(arguments.program),
        "cpu_seconds": cpu,
        "default": default,
        "refused, accepted": accepted,
    }
    write_results(arguments.out, result)
    print(princeton_tables.full_report(result))
    if arguments.pictures:
        draw_worst(arguments.program, entries, princeton_tables.every_map(result), arguments.pictures)


if __name__ == "__main__":
    main()
