"""Tables from a result file of `synthetic`."""

from __future__ import annotations

import numpy as np

from .generated import WRONG
from .markdown import table

GROUPS = {
    "people and animals": ("person", "biped", "quadruped", "bird", "insect"),
    "other shapes": ("random", "blob", "sea-star"),
}


def kind_row(name: str, rows: list[dict]) -> list:
    """Counts, and means over the shapes: of all answered, and of those whose map is right."""
    answered = [row for row in rows if row["found"]]
    right = [row for row in answered if row["mean_error"] < WRONG]
    mean = lambda chosen, measure: f"{np.mean([row[measure] for row in chosen]):.4f}" if chosen else "-"
    return [name, len(rows), len(answered), len(answered) - len(right), mean(answered, "mean_error"), mean(answered, "error_95"),
            mean(right, "mean_error"), mean(right, "error_95"), mean(rows, "truth_error")]  # fmt: skip


def error_table(shapes: list[dict]) -> str:
    """One row a kind, and one for each group."""
    header = ["kind", "shapes", "answered", "of them wrong", "mean error", "95th percentile",
              "right maps: mean error", "95th percentile", "the truth's own error"]  # fmt: skip
    lines = []
    for group, kinds in GROUPS.items():
        for kind in kinds:
            lines.append(kind_row(kind, [row for row in shapes if row["kind"] == kind]))
        lines.append(kind_row(f"**{group}**", [row for row in shapes if row["kind"] in kinds]))
    return table(header, [line for line in lines if line[1]])


def confidence_tables(found: dict | None) -> str:
    """Calibration of the confidence of answered shapes."""
    if found is None:
        return "No shape was answered."
    claims = (
        f"{100 * found['sure_and_right'] / found['sure']:.1f} % of {found['sure']:,}"
        if found["sure"]
        else "none made"
    )
    summary = table(["vertices", "expected calibration error", "area under the error-detection curve", "claims of 0.9 or more that are right"],
                    [[f"{found['vertices']:,}", found["calibration_error"], found["area_under_curve"], claims]])  # fmt: skip
    return (
        summary
        + "\n\n"
        + table(["stated", "right", "vertices"], [[*row[:2], f"{row[2]:,}"] for row in found["table"]])
    )


def asymmetric_table(shapes: list[dict]) -> str:
    """How many asymmetric shapes are called symmetric, by kind."""
    kinds = sorted({row["kind"] for row in shapes})
    line = lambda name, rows: [
        name,
        len(rows),
        sum(row["found"] for row in rows),
        f"{100 * np.mean([row['found'] for row in rows]):.1f} %",
    ]
    lines = [line(kind, [row for row in shapes if row["kind"] == kind]) for kind in kinds]
    return table(["without a symmetry", "shapes", "called symmetric", "share"], [*lines, line("**all**", shapes)])


def report(result: dict) -> str:
    """Everything, as Markdown."""
    quick = " --quick" if result["quick"] else ""
    source = (
        f"`make evaluate-synthetic`{quick}, {result['date']} ([data](results/{result['date']}-synthetic.json)):"
    )
    return "\n\n".join(
        [
            source,
            error_table(result["shapes"]),
            confidence_tables(result["confidence"]),
            asymmetric_table(result["asymmetric"]),
        ]
    )
