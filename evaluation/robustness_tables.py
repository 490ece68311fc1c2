"""Table and chart from a result file of `robustness`.

python -m evaluation.robustness_tables docs/results/DATE-robustness.json docs/robustness.png
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

from .markdown import table
from .severity import SERIES

# What the chart and the table show: key of a row, legend, colour.
CURVES = {
    "answered": ("share answered", "#4477aa"),
    "mean_error": ("mean error, sqrt(area)", "#cc3311"),
    "wrong_share": ("share of wrong points", "#ee7733"),
    "confidence": ("mean confidence", "#228833"),
    "confidence_without_partner": ("confidence where no partner is left", "#aa3377"),
}


def mean(rows: list[dict], key: str) -> float:
    """Mean over the shapes that have the measure, NaN if none has."""
    values = [row[key] for row in rows if row[key] is not None]
    return float(np.mean(values)) if values else float("nan")


def levels(rows: list[dict], series: str) -> list[tuple[float, list[dict]]]:
    """Rows of a series by severity."""
    own = [row for row in rows if row["series"] == series]
    found = [
        (severity, [row for row in own if row["severity"] == severity]) for severity in SERIES[series].severities
    ]
    return [(severity, chosen) for severity, chosen in found if chosen]


def series_table(rows: list[dict], series: str) -> str:
    """One row a severity."""
    show = lambda value, digits: "-" if np.isnan(value) else f"{value:.{digits}f}"
    lines = []
    for severity, chosen in levels(rows, series):
        answered = f"{sum(row['answered'] for row in chosen)} of {len(chosen)}"
        measures = [show(mean(chosen, key), 3 if key == "mean_error" else 2) for key in list(CURVES)[1:]]
        lines.append([severity, f"{np.mean([row['vertices'] for row in chosen]):,.0f}", answered, *measures])
    header = [
        SERIES[series].title,
        "vertices",
        "answered",
        "mean error",
        "wrong points",
        "confidence",
        "where no partner is left",
    ]
    return table(header, lines)


def report(result: dict) -> str:
    """Everything, as Markdown."""
    quick = " --quick" if result["quick"] else ""
    source = (
        f"`make evaluate-robustness`{quick}, {result['date']} ([data](results/{result['date']}-robustness.json)):"
    )
    return "\n\n".join(
        [source, *(series_table(result["rows"], series) for series in SERIES if levels(result["rows"], series))]
    )


def draw(result: dict, path: Path) -> None:
    """All series as small charts that share one scale, 0..1."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    shown = [series for series in SERIES if levels(result["rows"], series)]
    figure, axes = plt.subplots(
        -(-len(shown) // 3), 3, figsize=(11, 2.7 * -(-len(shown) // 3)), sharey=True, squeeze=False
    )
    for axis, series in zip(axes.flat, shown):
        found = levels(result["rows"], series)
        places = np.arange(len(found))
        for key, (label, colour) in CURVES.items():
            axis.plot(
                places, [mean(rows, key) for _, rows in found], marker="o", markersize=3, color=colour, label=label
            )
        axis.set_xticks(places, [f"{severity:g}" for severity, _ in found])
        axis.set_title(SERIES[series].title, fontsize=9)
        axis.set_ylim(-0.02, 1.02)
        axis.grid(alpha=0.3)
        axis.tick_params(labelsize=8)
    for axis in axes.flat[len(shown) :]:
        axis.axis("off")
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=len(CURVES), fontsize=9, frameon=False)
    figure.tight_layout(rect=(0, 0.05, 1, 1))
    figure.savefig(path, dpi=100, metadata={"Software": None})
    plt.close(figure)


def main() -> None:
    """Command line entry: draws the chart."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path)
    parser.add_argument("chart", type=Path)
    arguments = parser.parse_args()
    draw(json.loads(arguments.results.read_text()), arguments.chart)


if __name__ == "__main__":
    main()
