"""How maps, verdicts and confidence fare as input gets worse: a curve for each kind of damage.

    python -m evaluation.robustness --out results.json [--quick] [--series holes scan] [--work build/evaluation/robustness]

The shapes are generated people and animals, posed, without mirrored connectivity, the same ones at every severity
(`severity.py`). Errors are measured where a true partner is left. The best map is measured whether it is accepted or not;
"answered" says whether the default options accept it. Confidence is also measured where no true partner is left: a hole, a
cut limb, a prop.
"""

from __future__ import annotations

import argparse
from datetime import date
from pathlib import Path

from training.meshfile import write_shape
from training.mirror_truth import mirror_map
from training.people import People

from .generated import Shape, read_shapes
from .program import Answer, detect, identity, read_answer, write_results
from .robustness_tables import report
from .severity import SERIES, Subject

SEED = 7003
KINDS = ("person", "quadruped", "biped", "bird", "person")
QUICK = 2
# A partner farther from the truth, in sqrt(area), is wrong.
RIGHT = 0.05
# The default of the program's option --plausibility.
ACCEPTED = 0.5


def make(series: str, subjects: list[Subject], people: People, folder: Path) -> list[Shape]:
    """Writes the shapes of a series that are not there yet."""
    names = set()
    for number, severity in enumerate(SERIES[series].severities):
        for index, subject in enumerate(subjects):
            name = f"{series}-{number}-{index:02d}"
            names.add(name)
            if (folder / f"{name}.json").exists():
                continue
            sample = SERIES[series].draw(subject, severity, people)
            if sample is not None:
                mirror = mirror_map(sample.rest, sample.faces, SERIES[series].tolerance)
                description = {
                    "kind": subject.kind,
                    "symmetric": True,
                    "series": series,
                    "severity": severity,
                    "subject": index,
                }
                write_shape(folder, name, sample.posed, sample.faces, mirror, description)
    return [shape for shape in read_shapes(folder) if shape.name in names]


def judge(shape: Shape, answer: Answer) -> dict:
    """One row of the result file; None where there is nothing to measure."""
    row = {key: shape.description[key] for key in ("series", "severity", "subject", "kind")}
    paired = shape.mirror >= 0
    row |= {"vertices": len(paired), "paired_share": round(float(paired.mean()), 4)}
    row |= {
        "plausibility": answer.plausibility,
        "answered": answer.has_map and (answer.plausibility or 0) >= ACCEPTED,
    }
    measures = dict.fromkeys(("mean_error", "wrong_share", "confidence", "confidence_without_partner"))
    if answer.has_map:
        if paired.any():
            errors, stated = shape.errors(answer.partners), answer.confidence[shape.measured()]
            measures |= {
                "mean_error": errors.mean(),
                "wrong_share": (errors > RIGHT).mean(),
                "confidence": stated.mean(),
            }
        if paired.mean() < 0.99:  # a handful of vertices without one is the table's own doing
            measures["confidence_without_partner"] = answer.confidence[~paired].mean()
    return row | {name: None if value is None else round(float(value), 4) for name, value in measures.items()}


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/intrinsym")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument(
        "--work", type=Path, default=Path("build/evaluation/robustness"), help="where shapes and answers are kept"
    )
    parser.add_argument("--series", nargs="+", choices=list(SERIES), default=list(SERIES))
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} shapes instead of {len(KINDS)}")
    arguments = parser.parse_args()
    subjects = [Subject(kind, (SEED, index)) for index, kind in enumerate(KINDS)][
        : QUICK if arguments.quick else None
    ]
    people, rows = People(), []
    folder = arguments.work / "answers"
    folder.mkdir(parents=True, exist_ok=True)
    for series in arguments.series:
        shapes = make(series, subjects, people, arguments.work / "shapes")
        detect(
            arguments.program,
            [shape.path for shape in shapes],
            folder,
            ["--plausibility", "0"],
            write="map,json,ply",
        )
        rows += [judge(shape, read_answer(folder, shape.name)) for shape in shapes]
    result = {
        "date": str(date.today()),
        "program": identity(arguments.program),
        "quick": arguments.quick,
        "rows": rows,
    }
    write_results(arguments.out, result)
    print(report(result))


if __name__ == "__main__":
    main()
