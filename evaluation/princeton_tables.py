"""The published tables of the Princeton benchmark with our columns, from a result file of `princeton`."""

from __future__ import annotations


import numpy as np

from .map_metrics import MESH_RIGHT
from .markdown import table

METHODS = ("MT", "BIM", "OFM", "GRS", "FA", "Qiao et al.")
# Correspondence rate / mesh rate in per cent, and seconds a mesh of SCAPE (the last on a GPU), as Qiao et al. print them.
PUBLISHED_RATES = {
    "SCAPE": ("82.0 / 71.8", "84.8 / 76.1", "91.7 / 97.2", "94.5 / 98.6", "97.5 / 100", "98.1 / 100"),
    "TOSCA": ("85.0 / 76", "98.0 / 98.7", "95.1 / 92.6", "94.5 / 100", "97.8 / 100", "98.1 / 100"),
}
PUBLISHED_SECONDS = ("18.0", "304.26", "50.70", "20.28", "6.77", "0.06 (GPU)")
# Correspondence rates in per cent by class of TOSCA.
PUBLISHED_CLASSES = {
    "cat": ("66.0", "93.7", "90.0", "96.5", "95.6", "96.0"),
    "centaur": ("92.0", "100", "96.0", "92.0", "100", "100"),
    "david": ("82.0", "97.4", "94.8", "92.5", "96.2", "97.2"),
    "dog": ("91.0", "100", "93.2", "97.4", "98.8", "100"),
    "horse": ("92.0", "97.1", "95.2", "99.5", "97.3", "96.4"),
    "michael": ("87.0", "98.9", "94.6", "91.4", "96.5", "98.7"),
    "victoria": ("83.0", "98.3", "98.7", "95.5", "96.2", "97.8"),
    "wolf": ("100", "100", "100", "100", "100", "100"),
    "gorilla": ("-", "98.9", "98.9", "100", "100", "100"),
}
SHARES = ("correspondence_rate", "exact_share", "bijectivity", "turned_share", "fixed_share")
WORST = 10


def mean(rows: list[dict], measure: str) -> float:
    """Mean over the meshes that have the measure: a mesh without an answer has no error."""
    values = [row[measure] for row in rows if row[measure] is not None]
    return float(np.mean(values)) if values else float("nan")


def mesh_rate(rows: list[dict]) -> float:
    """Share of meshes of which at least three quarters of the landmarks are right."""
    return float(np.mean([row["correspondence_rate"] >= MESH_RIGHT for row in rows]))


def worst_first(rows: list[dict]) -> list[dict]:
    """Unanswered meshes, then by mean error."""
    return sorted(rows, key=lambda row: (row["found"], -(row["mean_error"] or 0)))


def rates(rows: list[dict]) -> str:
    """Correspondence rate / mesh rate in per cent."""
    return f"{100 * mean(rows, 'correspondence_rate'):.2f} / {100 * mesh_rate(rows):.1f}"


def of_set(rows: list[dict], name: str) -> list[dict]:
    """The meshes of SCAPE or TOSCA."""
    return [row for row in rows if row["set"] == name]


def every_map(result: dict) -> list[dict]:
    """Rows of all meshes as if every map were accepted."""
    accepted = {row["name"]: row for row in result["refused, accepted"]}
    return [accepted.get(row["name"], row) for row in result["default"]]


def published_tables(result: dict) -> str:
    """The three tables of the paper with our columns: default options, and every map accepted."""
    default, every = result["default"], every_map(result)
    ours = ["ours, default", "ours, every map"]
    sets = [name for name in PUBLISHED_RATES if of_set(default, name)]
    both = lambda chosen: [rates(chosen(default)), rates(chosen(every))]
    first = table(["correspondence / mesh rate, %", *METHODS, *ours],
                  [[name, *PUBLISHED_RATES[name], *both(lambda rows: of_set(rows, name))] for name in sets])  # fmt: skip
    classes = [name for name in PUBLISHED_CLASSES if any(row["class"] == name for row in default)]
    rate = lambda rows, name: (
        f"{100 * mean([row for row in rows if row['class'] == name], 'correspondence_rate'):.2f}"
    )
    second = table(["TOSCA, correspondence rate, %", *METHODS, *ours],
                   [[name, *PUBLISHED_CLASSES[name], rate(default, name), rate(every, name)] for name in classes])  # fmt: skip
    seconds = f"{cpu_per_mesh(result, 'SCAPE'):.2f} (CPU)" if "SCAPE" in sets else "-"
    third = table(["seconds a mesh of SCAPE", *METHODS, "ours"], [["", *PUBLISHED_SECONDS, seconds]])
    return "\n\n".join([first, second, third])


def cpu_per_mesh(result: dict, name: str) -> float:
    """CPU seconds of the whole process, reading and writing included, per mesh."""
    return result["cpu_seconds"][name] / len(of_set(result["default"], name))


def measures_table(result: dict) -> str:
    """All measures by set and class, with every map accepted."""
    rows = every_map(result)
    groups = [(name, of_set(rows, name)) for name in PUBLISHED_RATES]
    groups += [(name, [row for row in rows if row["class"] == name]) for name in PUBLISHED_CLASSES]
    header = [
        "every map",
        "meshes",
        "corr. %",
        "mesh %",
        "mean error",
        "exact %",
        "bijective %",
        "cycle error",
        "turned over %",
        "fixed %",
    ]
    lines = []
    for name, group in groups:
        if group:
            corr, exact, bijective, turned, fixed = (f"{100 * mean(group, measure):.2f}" for measure in SHARES)
            error, cycle = (f"{mean(group, measure):.4f}" for measure in ("mean_error", "cycle_error"))
            lines.append(
                [
                    name,
                    len(group),
                    corr,
                    f"{100 * mesh_rate(group):.1f}",
                    error,
                    exact,
                    bijective,
                    cycle,
                    turned,
                    fixed,
                ]
            )
    return table(header, lines)


def stages_table(result: dict) -> str:
    """CPU seconds a mesh. The process's seconds, with reading and writing, are counted; stages share them by wall time."""
    rows = result["default"]
    stages = list(dict.fromkeys(stage for row in rows for stage in row["seconds"]))
    lines = []
    for name in PUBLISHED_RATES:
        group = of_set(rows, name)
        if group:
            cpu, wall = cpu_per_mesh(result, name), sum(sum(row["seconds"].values()) for row in group)
            shares = [sum(row["seconds"].get(stage, 0) for row in group) / wall for stage in stages]
            lines.append([name, *(f"{cpu * share:.3f}" for share in shares), f"{cpu:.2f}"])
    return table(["CPU seconds a mesh", *stages, "all"], lines)


def worst_table(result: dict) -> str:
    """The meshes with the largest mean errors, and those that the default refuses."""
    default = {row["name"]: row for row in result["default"]}
    every = every_map(result)
    shown = worst_first(every)[:WORST]
    shown += [row for row in every if not default[row["name"]]["found"] and row not in shown]
    lines = []
    for row in shown:
        verdict = "accepted" if default[row["name"]]["found"] else "refused"
        error = "-" if row["mean_error"] is None else f"{row['mean_error']:.4f}"
        believed = "-" if row["plausibility"] is None else f"{100 * row['plausibility']:.0f} %"
        lines.append([row["name"], error, f"{100 * row['correspondence_rate']:.1f}", believed, verdict])
    return table(["worst first", "mean error", "corr. %", "plausibility", "by default"], lines)


def short_report(result: dict) -> str:
    """One table: both sets, our numbers beside the best published ones."""
    default, every = result["default"], every_map(result)
    lines = []
    for name, published in PUBLISHED_RATES.items():
        own, all_maps = of_set(default, name), of_set(every, name)
        refused = sum(not row["found"] for row in own)
        lines.append([f"{name}, {len(own)}", published[-1], published[-2], rates(own), refused, rates(all_maps),
                      f"{mean(all_maps, 'mean_error'):.4f}"])  # fmt: skip
    header = [
        "Princeton benchmark: landmarks / meshes right, %",
        "the paper",
        "FA",
        "Intrinsym",
        "meshes refused",
        "every map accepted",
        "mean error, sqrt(area)",
    ]
    return f"{table(header, lines)}\n\n`make evaluate`, {result['date']} ([data](docs/results/{result['date']}-princeton.json))."


def full_report(result: dict) -> str:
    """Everything, as Markdown."""
    source = f"`make evaluate`, {result['date']} ([data](results/{result['date']}-princeton.json)):"
    parts = [source, published_tables(result), measures_table(result), stages_table(result), worst_table(result)]
    return "\n\n".join(parts)
