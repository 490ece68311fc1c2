"""Fits `src/verify/acceptance.rs`: the plausibility that a finished map is a symmetry, without and with its rigid parts.

    python -m evaluation.acceptance FOLDER... [--program target/release/intrinsym] [--keep FOLDER]

Folders are those of `training.generate`. Runs the program with `--plausibility 0`, which answers with the best map
whatever it is, and tells right maps of symmetric shapes (mean error at most 0.1 sqrt(area)) from maps of asymmetric ones,
which weigh as MODELS says. Wrong maps of symmetric shapes are left out: many are another near-symmetry of the shape.
Prints the weights beside those in the source, and what models say of kinds of shapes that they have not seen. `--keep` keeps the answers, so that a second run need not detect again.
"""

from __future__ import annotations

import argparse
import tempfile
from functools import partial
from pathlib import Path

import numpy as np

from . import logistic
from .generated import WRONG, Shape, read_shapes
from .program import detect, read_answer

SOURCE = Path(__file__).parent.parent / "src" / "verify" / "acceptance.rs"
# Measures of `report.judged`, in the order of the weights in the source, and what the models take of each.
FEATURES = {
    "isometry_score": lambda judged: judged["isometry_score"],
    "ln(signature_mismatch + 0.002)": lambda judged: np.log(judged["signature_mismatch"] + 0.002),
    "signature_mismatch": lambda judged: judged["signature_mismatch"],
    "ln(displacement + 0.05)": lambda judged: np.log(judged["displacement"] + 0.05),
    "ln(disagreement + 0.0005)": lambda judged: np.log(judged["disagreement"] + 0.0005),
    "scatter": lambda judged: judged["scatter"],
}
# The models by their names in the source: the measures that each takes, and the share of shapes with a symmetry where its plausibility is a
# probability.
MODELS = {"WEIGHTS": ([0, 1, 3], 0.4), "WEIGHTS_WITH_PARTS": ([2, 3, 4, 5], 0.25)}
LEVELS = (0.33, 0.5, 0.67)


def read_table(program: str, shapes: list[Shape], folder: Path):
    """For each shape that has a map and rigid parts: its features, what the program thinks of it, whether the map is right, and its kind."""
    missing = [shape.path for shape in shapes if not (folder / f"{shape.name}.json").exists()]
    if missing:
        folder.mkdir(parents=True, exist_ok=True)
        detect(program, missing, folder, ["--plausibility", "0"])
    features, plausibility, right, kinds = [], [], [], []
    for shape in shapes:
        answer = read_answer(folder, shape.name)
        judged = answer.report["report"]["judged"]
        if judged and answer.has_map and judged["disagreement"] is not None:
            features.append([measure(judged) for measure in FEATURES.values()])
            plausibility.append(judged["plausibility"])
            right.append(shape.symmetric and float(shape.errors(answer.partners).mean()) <= WRONG)
            kinds.append(shape.description["kind"])
    return np.array(features).reshape(len(kinds), -1), np.array(plausibility), np.array(right, bool), np.array(kinds)


def report(positive: np.ndarray, negative: np.ndarray, shapes: tuple[int, int]) -> str:
    """Shares accepted at some levels, and the area under the curve."""
    area = logistic.area_under_curve(np.r_[positive, negative], np.r_[np.ones(len(positive)), np.zeros(len(negative))])
    lines = [f"area under the curve {area:.3f}"]
    for level in LEVELS:
        lines.append(f"from {100 * level:.0f} % on: {(positive >= level).sum()} of {len(positive)} right maps accepted, "
                     f"{(negative >= level).sum()} of {shapes[1]} asymmetric shapes")  # fmt: skip
    return "\n".join(lines)


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", type=Path, nargs="+", help="of shapes with a symmetry or without")
    parser.add_argument("--program", default="target/release/intrinsym")
    parser.add_argument("--keep", type=Path, help="folder for the program's answers")
    arguments = parser.parse_args()
    shapes = [shape for folder in arguments.folders for shape in read_shapes(folder)]
    symmetric, asymmetric = [shape for shape in shapes if shape.symmetric], [shape for shape in shapes if not shape.symmetric]
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or Path(temporary)
        features, now, right, kinds = read_table(arguments.program, symmetric, folder)
        others, others_now, _, others_kinds = read_table(arguments.program, asymmetric, folder)
    print(f"{len(symmetric)} symmetric shapes: {right.sum()} right maps, {(~right).sum()} wrong, {len(symmetric) - len(right)} without a map")
    print(f"{len(asymmetric)} asymmetric shapes: {len(others)} with a map\n")
    counts = len(symmetric), len(asymmetric)
    label = np.r_[np.ones(right.sum(), bool), np.zeros(len(others), bool)]
    print("\nas the program judges now:\n" + report(now[right], others_now, counts))
    group = np.unique(np.r_[kinds[right], others_kinds], return_inverse=True)[1]
    for model, (columns, share) in MODELS.items():
        balanced = partial(logistic.balanced, share=share)
        rows, names = np.r_[features[right], others][:, columns], [list(FEATURES)[column] for column in columns]
        weights = logistic.fit(rows, label, balanced(label))
        print(f"\n{model}\n" + logistic.weights_table(names, weights, logistic.rust_weights(SOURCE, model)))
        stated = logistic.probability(weights, rows)
        print("\nfitted now:\n" + report(stated[label], stated[~label], counts))
        stated = logistic.cross_validated(rows, label, group, balanced, folds=group.max() + 1)
        print("\nof kinds not seen:\n" + report(stated[label], stated[~label], counts))


if __name__ == "__main__":
    main()
