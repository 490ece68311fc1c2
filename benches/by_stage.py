"""Runs benches/by_stage (criterion) and keeps what it measured: times of each stage, and how far they are from the floor.

    make bench-stages                                       # builds, runs this, writes benches/results/DATE
    python3 benches/by_stage.py --out FOLDER 10 35 71 141 316
    python3 benches/by_stage.py --out FOLDER                # only makes the tables again, from FOLDER/criterion.json

Each number f is a generated mesh of 10 f^2 + 2 vertices. FOLDER/criterion.json keeps every sample and criterion's medians
with their confidence intervals; FOLDER/by_stage.md and FOLDER/floor.md are made from it. Needs the standard library alone.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import statistics
import subprocess
import tempfile
from pathlib import Path

BENCH = "cargo bench --profile release --locked --features criterion --bench by_stage -- --quiet --noplot"

# Stages that a detection does not take, or takes as a part of another.
OUTSIDE = ["mesh", "verdict"]


def measure(frequencies: list[str]) -> dict:
    """Runs the bench and collects criterion's files."""
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"CRITERION_HOME": folder, "BENCH_FREQUENCIES": " ".join(frequencies)}
        subprocess.run(BENCH.split(), check=True, env=environment)
        files = sorted(Path(folder).glob("*/*/new/benchmark.json"), key=lambda path: path.stat().st_mtime_ns)
        floors = Path(folder) / "floors.json"
        return {
            "machine": {"machine": platform.machine(), "processors": os.cpu_count()},
            "load_before": load,
            "measurements": [measurement(path) for path in files],
            "floors": json.loads(floors.read_text()) if floors.exists() else [],
        }


def measurement(path: Path) -> dict:
    """Seconds of one stage at one size; `amount` is what a call multiplies or moves, where that is said."""
    benchmark = json.loads(path.read_text())
    median = json.loads((path.parent / "estimates.json").read_text())["median"]
    sample = json.loads((path.parent / "sample.json").read_text())
    interval = median["confidence_interval"]
    return {
        "stage": benchmark["group_id"],
        "of": benchmark["value_str"],
        "median": 1e-9 * median["point_estimate"],
        "lower": 1e-9 * interval["lower_bound"],
        "upper": 1e-9 * interval["upper_bound"],
        "confidence": interval["confidence_level"],
        "amount": next(iter((benchmark["throughput"] or {}).values()), None),
        "samples": [1e-9 * time / count for time, count in zip(sample["times"], sample["iters"])],
    }


def digits(milliseconds: float) -> str:
    """Three digits, or all before the point."""
    places = max(0, 2 - math.floor(math.log10(milliseconds))) if milliseconds > 0 else 0
    return f"{milliseconds:,.{min(places, 3)}f}"


def cell(found: dict | None) -> str:
    if found is None:
        return "-"
    median, lower, upper = (digits(1e3 * found[name]) for name in ("median", "lower", "upper"))
    return f"{median} ({lower} to {upper})"


def exponent(entries: list[dict]) -> str:
    """Growth with the vertices from the second size on."""
    points = [(math.log(int(entry["of"])), math.log(entry["median"])) for entry in entries][1:]
    return f"N^{statistics.linear_regression(*zip(*points)).slope:.2f}" if len(points) > 1 else ""


def by_stage(measurements: list[dict], load: float) -> str:
    """Markdown: milliseconds, a row for each stage in the order of the pipeline, a column for each size."""
    stages = [entry for entry in measurements if entry["amount"] is None]
    sizes = sorted({int(entry["of"]) for entry in stages})
    lines = ["| | " + " | ".join(f"{size:,}" for size in sizes) + " | growth |", "|---" * (len(sizes) + 2) + "|"]
    for name in dict.fromkeys(entry["stage"] for entry in stages if entry["of"] == str(sizes[-1])):
        own = sorted((entry for entry in stages if entry["stage"] == name), key=lambda entry: int(entry["of"]))
        cells = [cell(next((entry for entry in own if entry["of"] == str(size)), None)) for size in sizes]
        growth = exponent(own) if len(own) == len(sizes) else ""
        lines.append(f"| {name} | " + " | ".join(cells) + f" | {growth} |")
    lines += ["", f"Load average of the machine just before: {load:.1f}."]
    return "\n".join(lines) + "\n"


def floor(measurements: list[dict], floors: list[dict], vertices: str) -> str:
    """Markdown: what stages must do, in what time this machine does as much, and the time measured."""
    amounts = [entry for entry in measurements if entry["amount"] is not None]
    rate = {(entry["stage"], entry["of"]): entry["amount"] / min(entry["samples"]) for entry in amounts}
    seconds = {entry["stage"]: entry["median"] for entry in measurements if entry["of"] == vertices}
    double, single = rate["product", "double"], rate["product", "single"]
    lines = [
        f"Fastest samples: {double / 1e9:.0f} Gflop/s in double precision, {single / 1e9:.0f} in single (12,500 x 150 by 150 x 150); "
        f"a copy moves {rate['copy', 'memory'] / 1e9:.0f} GB/s of 512 MB and {rate['copy', 'cache'] / 1e9:.0f} of 512 KB "
        "(bytes read and written).",
        "",
        "| | counted | Mflop double | single | MB | floor, ms | measured, ms | ratio |",
        "|---|---|---|---|---|---|---|---|",
    ]
    totals = [0.0, 0.0]
    for entry in floors:
        computing = entry["double"] / double + entry["single"] / single
        least = max(computing, entry["bytes"] / rate["copy", entry["from"]])
        time = seconds[entry["stage"]]
        if entry["stage"] not in OUTSIDE:
            totals = [totals[0] + least, totals[1] + time]
        work = " | ".join(digits(entry[name] / 1e6) if entry[name] else "" for name in ("double", "single", "bytes"))
        source = " (cache)" if entry["from"] == "cache" and entry["bytes"] else ""
        lines.append(
            f"| {entry['stage']} | {entry['counted']} | {work}{source} | {digits(1e3 * least)} | {digits(1e3 * time)} "
            f"| {time / least:.1f} |"
        )
    least, time = totals
    whole = seconds["detect"]
    lines.append(
        f"| these but mesh and verdict, of {digits(1e3 * whole)} ms | | | | | {digits(1e3 * least)} | {digits(1e3 * time)} "
        f"| {time / least:.1f} |"
    )
    return "\n".join(lines) + "\n"


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("frequencies", nargs="*")
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    kept = arguments.out / "criterion.json"
    if arguments.frequencies:
        arguments.out.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(measure(arguments.frequencies), indent=1) + "\n")
    found = json.loads(kept.read_text())
    (arguments.out / "by_stage.md").write_text(by_stage(found["measurements"], found["load_before"]))
    if found["floors"]:
        (arguments.out / "floor.md").write_text(floor(found["measurements"], found["floors"], "12252"))


if __name__ == "__main__":
    main()
