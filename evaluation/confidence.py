"""Fits `src/verify/confidence.rs`: the probability that a partner is within 0.05 sqrt(area) of the true mirror image.

    python -m evaluation.confidence SYMMETRIC [--evidence target/release/examples/evidence] [--keep FOLDER]

SYMMETRIC is a folder of `training.generate`. The example program `evidence` says of every vertex what the confidence is made
of; 300 vertices of each shape are compared with the truth. A vertex whose true partner is missing is wrong, whatever its
partner. Maps of a plausibility below 33 % are left out (`--answers`
names the folder that `evaluation.acceptance --keep` filled), as are shapes without a map. Prints the weights beside those
in the source, the calibration, and the same in four-fold cross-validation by shape.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from . import logistic
from .generated import MEASURED, Shape, read_shapes
from .program import read_answer

SOURCE = Path(__file__).parent.parent / "src" / "verify" / "confidence.rs"
# A partner this near to the truth, in sqrt(area), is right.
RIGHT = 0.05
# Maps that are less plausible are not asked for their confidence.
PLAUSIBLE = 0.33
# The columns of `Evidence::features` in the source, in the order of WEIGHTS.
FEATURES = (
    "ln(round trip + 0.002)",
    "ln(way + 0.002)",
    "ln(doubt + 0.01)",
    "mean doubt",
)
BATCH = 20


def read_evidence(path: Path) -> np.ndarray | None:
    """Rows of vertex, partner and `FEATURES`; None if there was no map."""
    text = path.read_text()
    return np.loadtxt(text.splitlines(), ndmin=2) if text else None


def gather(program: str, shapes: list[Shape], folder: Path) -> None:
    """Writes the evidence of every shape that has none yet."""
    folder.mkdir(parents=True, exist_ok=True)
    missing = [str(shape.path) for shape in shapes if not (folder / f"{shape.name}.evidence").exists()]
    for first in range(0, len(missing), BATCH):
        subprocess.run([program, str(folder), *missing[first : first + BATCH]], check=True)


def table_of(shape: Shape, folder: Path) -> tuple[np.ndarray, np.ndarray] | None:
    """Features (n, columns) of some vertices, and whether each partner is right; None without a map."""
    rows = read_evidence(folder / f"{shape.name}.evidence")
    if rows is None:
        return None
    own, partner = rows[:, 0].astype(int), rows[:, 1].astype(int)
    row_of, partners = np.full((2, len(shape.mirror)), -1)
    row_of[own], partners[own] = np.arange(len(rows)), partner
    vertices = np.sort(np.random.default_rng(0).permutation(own)[:MEASURED])
    right = shape.mirror[vertices] >= 0
    right[right] = shape.errors_at(vertices[right], partners) <= RIGHT
    return rows[row_of[vertices], 2:], right


def report(stated: np.ndarray, right: np.ndarray) -> str:
    """Calibration in words and as a table."""
    sure = stated >= 0.9
    claims = f"{100 * right[sure].mean():.1f} % of {sure.sum()}" if sure.any() else "none made"
    rows = "\n".join(f"| {said:.2f} | {was:.2f} | {count:,} |" for said, was, count in logistic.calibration_table(stated, right))
    return (
        f"expected calibration error {logistic.calibration_error(stated, right):.3f}, area under the error-detection curve "
        f"{logistic.area_under_curve(stated, right):.3f}, claims of 0.9 or more that are right: {claims}\n\n"
        f"| stated | right | vertices |\n|---|---|---|\n{rows}"
    )


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("symmetric", type=Path)
    parser.add_argument("--evidence", default="target/release/examples/evidence")
    parser.add_argument("--answers", type=Path, help="only shapes whose answer here is plausible by 33 %% or more")
    parser.add_argument("--keep", type=Path, help="folder for the evidence")
    arguments = parser.parse_args()
    shapes = [shape for shape in read_shapes(arguments.symmetric) if shape.symmetric]
    if arguments.answers:
        shapes = [shape for shape in shapes if (read_answer(arguments.answers, shape.name).plausibility or 0) >= PLAUSIBLE]
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or Path(temporary)
        gather(arguments.evidence, shapes, folder)
        tables = [table for table in (table_of(shape, folder) for shape in shapes) if table is not None]
    features = np.concatenate([own for own, _ in tables])
    right = np.concatenate([own for _, own in tables])
    group = np.repeat(np.arange(len(tables)), [len(own) for _, own in tables])
    weights = logistic.fit(features, right)
    shipped = logistic.rust_weights(SOURCE)
    print(f"{len(tables)} shapes, {len(right)} vertices, {100 * right.mean():.1f} % right\n")
    print(logistic.weights_table(list(FEATURES), weights, shipped))
    if len(shipped) == len(weights):
        print("\nwith the weights in the source: " + report(logistic.probability(shipped, features), right))
    print("\nfitted now: " + report(logistic.probability(weights, features), right))
    print("\nfour-fold cross-validation by shape: " + report(logistic.cross_validated(features, right, group), right))


if __name__ == "__main__":
    main()
