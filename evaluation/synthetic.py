"""Generated shapes with dense truth: how far maps are off, and whether confidence and refusals can be believed.

    python -m evaluation.synthetic --out results.json [--quick] [--work build/evaluation/synthetic]

Symmetric shapes: people, animals and others of `training.generate`, posed, triangulated so that left and right share no
connectivity, every second one with noise. The truth is a vertex, so it misses the mirror point itself by about half an edge:
`truth_error`. Asymmetric shapes: trees, unbalanced creatures and lumps; the default options should refuse them. The seeds are
used nowhere else, neither in training nor in fitting.
"""

from __future__ import annotations

import argparse
from datetime import date
from pathlib import Path

import numpy as np

from training import damage
from training.creatures import ASYMMETRIC_KINDS, SYMMETRIC_KINDS
from training.generate import Generator
from training.meshfile import write_shape
from training.skeleton import MIRROR

from .generated import Shape, read_shapes
from .logistic import area_under_curve, calibration_error, calibration_table
from .program import detect, identity, read_answer, write_results
from .surface import Surface
from .synthetic_tables import report

SEED, ASYMMETRIC_SEED = 7001, 7002
SYMMETRIC_VERTICES, ASYMMETRIC_VERTICES = (3_000, 12_000), (1_000, 6_000)
KINDS = ["person", *SYMMETRIC_KINDS]
# Shapes of each symmetric kind, and asymmetric shapes in all: full, and quick.
COUNTS = {False: (16, 500), True: (2, 24)}
NOISE = (0.05, 0.25)  # standard deviations of the noise, in mean edges
# A partner this near to the truth, in sqrt(area), is what confidence is about.
RIGHT = 0.05


def make_symmetric(count: int, folder: Path) -> None:
    """Writes `count` shapes of each kind that are not there yet."""
    generator = Generator(KINDS, SYMMETRIC_VERTICES, damaged=False, remeshed_share=1.0)
    for index in range(count * len(KINDS)):
        name = f"{KINDS[index % len(KINDS)]}-{index:04d}"
        if (folder / f"{name}.json").exists():
            continue
        sample, mirror, description = generator.draw(SEED, index)
        truth_error = rest_error(sample, mirror)
        if index // len(KINDS) % 2:
            rng = np.random.default_rng([SEED, index, 1])
            sample, description["damage"] = damage.add_noise(rng, sample, float(rng.uniform(*NOISE))), "noise"
        write_shape(folder, name, sample.posed, sample.faces, mirror, description | {"truth_error": truth_error})


def rest_error(sample, mirror: np.ndarray) -> float:
    """Mean distance, in sqrt(area), of the true vertex from the mirror point, in the rest pose."""
    paired = mirror >= 0
    apart = np.linalg.norm(sample.rest[mirror[paired]] - sample.rest[paired] * MIRROR, axis=1)
    return float(apart.mean() / Surface(sample.rest, sample.faces).unit)


def make_asymmetric(count: int, folder: Path) -> None:
    """Writes `count` shapes without a symmetry that are not there yet."""
    kinds = list(ASYMMETRIC_KINDS)
    generator = Generator(kinds, ASYMMETRIC_VERTICES, damaged=False)
    for index in range(count):
        name = f"{kinds[index % len(kinds)]}-{index:04d}"
        if not (folder / f"{name}.json").exists():
            sample, mirror, description = generator.draw(ASYMMETRIC_SEED, index)
            write_shape(folder, name, sample.posed, sample.faces, mirror, description)


def answers(program: str, shapes: list[Shape], folder: Path, write: str) -> list:
    """The program's answers with default options."""
    for old in folder.glob("*"):
        old.unlink()
    folder.mkdir(parents=True, exist_ok=True)
    detect(program, [shape.path for shape in shapes], folder, [], write=write)
    return [read_answer(folder, shape.name) for shape in shapes]


def judge(shape: Shape, answer) -> tuple[dict, np.ndarray, np.ndarray]:
    """One shape's row of the result file; confidence and error of its measured vertices."""
    errors, stated = shape.errors(answer.partners), answer.confidence[shape.measured()]
    plausibility = answer.plausibility
    row = {
        "name": shape.name, "kind": shape.description["kind"], "vertices": len(shape.mirror), "noise": shape.description["damage"] == "noise",
        "truth_error": round(shape.description["truth_error"], 5), "found": answer.found,
        "plausibility": None if plausibility is None else round(plausibility, 4),
        "mean_error": round(float(errors.mean()), 5), "error_95": round(float(np.quantile(errors, 0.95)), 5),
        "mean_confidence": round(float(stated.mean()), 4), "right_share": round(float((errors <= RIGHT).mean()), 4),
        "seconds": round(sum(answer.seconds.values()), 3),
    }  # fmt: skip
    return row, stated, errors


def confidence_summary(stated: np.ndarray, errors: np.ndarray) -> dict:
    """Whether stated confidences hold, over all measured vertices of the answered shapes."""
    right, sure = errors <= RIGHT, stated >= 0.9
    return {
        "vertices": len(stated),
        "calibration_error": round(calibration_error(stated, right), 4),
        "area_under_curve": round(area_under_curve(stated, right), 4),
        "sure": int(sure.sum()),
        "sure_and_right": int((sure & right).sum()),
        "table": [[round(said, 3), round(was, 3), count] for said, was, count in calibration_table(stated, right)],
    }


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/intrinsym")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument(
        "--work", type=Path, default=Path("build/evaluation/synthetic"), help="where shapes and answers are kept"
    )
    parser.add_argument("--quick", action="store_true", help="two shapes of a kind, 24 asymmetric ones")
    arguments = parser.parse_args()
    each, asymmetric = COUNTS[arguments.quick]
    symmetric_folder, asymmetric_folder = arguments.work / "symmetric", arguments.work / "asymmetric"
    make_symmetric(each, symmetric_folder)
    make_asymmetric(asymmetric, asymmetric_folder)
    wanted = lambda folder, count: [shape for shape in read_shapes(folder) if int(shape.name[-4:]) < count]
    shapes = wanted(symmetric_folder, each * len(KINDS))
    judged = [
        judge(*pair)
        for pair in zip(shapes, answers(arguments.program, shapes, arguments.work / "answers", "map,json,ply"))
    ]
    found = [(stated, errors) for row, stated, errors in judged if row["found"]]
    lopsided = wanted(asymmetric_folder, asymmetric)
    others = answers(arguments.program, lopsided, arguments.work / "asymmetric_answers", "map,json")
    result = {
        "date": str(date.today()), "program": identity(arguments.program), "quick": arguments.quick,
        "confidence": confidence_summary(*(np.concatenate(part) for part in zip(*found))) if found else None,
        "shapes": [row for row, _, _ in judged],
        "asymmetric": [{"name": shape.name, "kind": shape.description["kind"], "found": answer.found,
                        "plausibility": answer.plausibility and round(answer.plausibility, 4)}
                       for shape, answer in zip(lopsided, others)],
    }  # fmt: skip
    write_results(arguments.out, result)
    print(report(result))


if __name__ == "__main__":
    main()
