"""What each mechanism is worth: the program with one thing changed at a time (docs/ablation.md).

    python -m evaluation.ablate --out results.json [--variants FILE] [--work FOLDER] [--count N] [--test]

`variants.json` maps a variant's name to the fields of the effort that it changes; the first changes none. The example `ablate`
detects each shape by all variants in turn, on one thread, and accepts every map. The shapes are those of `development`; `--test`
adds the meshes at $BENCHMARK_DATA, $REMESHED_DATA and $WATERTIGHT_DATA, as far as they are set. Decide on development sets only.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
from dataclasses import dataclass
from datetime import date
from pathlib import Path

import numpy as np

from . import ablate_tables, development, princeton, remeshed, watertight
from .generated import LARGEST_ERROR, Shape, read_shapes
from .map_metrics import landmark_distances
from .program import identity, write_results
from .surface import Surface

VARIANTS = Path(__file__).parent / "variants.json"


@dataclass
class Case:
    """One mesh of a set, and what says how far a map is off."""

    set: str
    name: str
    path: Path
    error: callable


def development_cases(folder: Path, count: int | None) -> list[Case]:
    """The shapes of the development sets, the sets in turn, so that a run that is cut short has some of each."""
    development.make(folder, most=count)
    rows = []
    for name, chosen in development.SETS.items():
        shapes = read_shapes(folder / name)[: min(chosen.count, count or chosen.count)]
        rows += [(index / len(shapes), Case(name, shape.name, shape.path, shape_error(shape))) for index, shape in enumerate(shapes)]
    return [case for _, case in sorted(rows, key=lambda row: row[0])]


def shape_error(shape: Shape):
    """Mean error of a map of a generated shape; None for a shape without a truth."""
    return lambda partners: float(shape.errors(partners).mean()) if shape.symmetric else None


def landmark_error(path: Path, points: np.ndarray, images: np.ndarray):
    """Mean error of a map at landmarks."""

    def error(partners: np.ndarray) -> float:
        distances = landmark_distances(Surface(*remeshed.read_off(path)), partners[points], images)
        return float(np.minimum(distances, LARGEST_ERROR).mean())

    return error


def test_cases() -> list[Case]:
    """The meshes of the test sets that environment variables name."""
    cases = []
    if folder := os.environ.get("BENCHMARK_DATA"):
        for name in princeton.SETS:
            for entry in princeton.benchmark(Path(folder), name):
                error = landmark_error(entry.path, entry.points, entry.images)
                cases.append(Case(name, f"{name}-{entry.path.stem}", entry.path, error))
    if folder := os.environ.get("REMESHED_DATA"):
        for path in sorted(Path(folder).glob("*/vtx_5k/*.off")):
            name = f"{path.parts[-3]}, remeshed"
            error = lambda partners, path=path: remeshed.mean_error(path, partners)
            cases.append(Case(name, f"{path.parts[-3]}-{path.stem}", path, error))
    if folder := os.environ.get("WATERTIGHT_DATA"):
        corrs = Path(folder) / "Corrs"
        for number in watertight.CLASSES:
            pairs = princeton.read_pairs(corrs / f"{number}.sym.info")
            for mesh in range(watertight.MESHES * (number - 1) + 1, watertight.MESHES * number + 1):
                path = Path(folder) / "Meshes" / f"{mesh}.off"
                points, images = watertight.read_vertices(corrs, mesh)[pairs].T
                cases.append(Case("SHREC'07", f"watertight-{mesh}", path, landmark_error(path, points, images)))
    return cases


def run(program: str, cases: list[Case], variants: Path, folder: Path) -> list[dict]:
    """Runs the example over all meshes; its lines, one a mesh and variant."""
    folder.mkdir(parents=True, exist_ok=True)
    listed, log = folder / "list.txt", folder / "log.jsonl"
    listed.write_text("".join(f"{case.name} {case.path}\n" for case in cases))
    log.unlink(missing_ok=True)
    subprocess.run([program, str(folder), str(listed), str(variants)], check=True)
    return [json.loads(line) for line in log.read_text().splitlines()]


def judged(cases: list[Case], lines: list[dict], folder: Path) -> list[dict]:
    """One row a mesh and variant: its error (None without a truth), plausibility and CPU seconds."""
    known, rows = {case.name: case for case in cases}, []
    for line in lines:
        case, path = known[line["mesh"]], folder / line["variant"] / f"{line['mesh']}.map"
        error = case.error(np.loadtxt(path, dtype=int, ndmin=1)) if path.exists() else LARGEST_ERROR
        rows.append({
            "set": case.set, "name": case.name, "variant": line["variant"], "error": None if error is None else round(error, 5),
            "plausibility": round(line.get("plausibility") or 0.0, 4), "cpu": round(line["cpu"], 4),
        })  # fmt: skip
    return rows


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/examples/ablate")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--work", type=Path, default=Path("build/evaluation/ablation"), help="where shapes and answers are kept")
    parser.add_argument("--variants", type=Path, default=VARIANTS)
    parser.add_argument("--count", type=int, help="at most so many shapes of each development set")
    parser.add_argument("--test", action="store_true", help="the test sets, too")
    arguments = parser.parse_args()
    cases = development_cases(arguments.work / "shapes", arguments.count) + (test_cases() if arguments.test else [])
    answers = arguments.work / "answers"
    rows = judged(cases, run(arguments.program, cases, arguments.variants, answers), answers)
    result = {
        "date": str(date.today()), "program": identity("target/release/intrinsym"),
        "variants": json.loads(arguments.variants.read_text()), "rows": rows,
    }  # fmt: skip
    write_results(arguments.out, result)
    print(ablate_tables.report(result))


if __name__ == "__main__":
    main()
