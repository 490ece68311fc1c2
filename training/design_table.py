"""The paper's design table, remade: which inputs, how many references, how big a network.

    python -m training.design_table --folder build/training --out table.md [--steps 2500]

Every design is trained on the same shapes with the same seed, and measured on the held-out generated
shapes. PointNet and the paper's network cost so much on a CPU that they are trained and measured at 128
points, in few steps (the table says how many): their accuracy is that of a small budget, and no verdict.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from pathlib import Path

import jax
import numpy as np

from . import data, evaluate
from .network import DESIGNS, apply, parameter_count
from .train import BATCH as USUAL_BATCH
from .train import predict, train

UPRIGHT = "positions-upright"
ROWS = (
    ("compact", "ours: t = 3"),
    ("t2", "t = 2"),
    ("t4", "t = 4"),
    ("no-canonical", "random flips in training instead of canonical signs"),
    ("narrow", "ours, narrower: 32-64-128, 512 points"),
    ("small", "ours, smaller: 16-32-64"),
    ("positions", "positions instead of reference eigenfunctions, shapes turned at random"),
    (UPRIGHT, "the same, all shapes upright as they were made"),
    ("diag", "all signs at once (Diag)"),
    ("pointnet", "PointNet with input transform, same input"),
    ("paper", "the paper's network"),
)
SHARE_OF_STEPS = {"paper": 0.02, "pointnet": 0.1}
TRAINING_POINTS = {"paper": 128, "pointnet": 128}
BATCH = {"paper": 16}
RATE = {"paper": 1e-4}


def cpu_milliseconds(design, parameters, statistics) -> float:
    """CPU time to answer all signs of a mesh, median of three, at the design's points."""
    batch = 1 if design.inputs == "all" else design.signs
    x = np.random.default_rng(0).normal(size=(batch, design.points, design.channels)).astype(np.float32)
    run = jax.jit(lambda x: apply(design, parameters, statistics, x)[0])
    run(x).block_until_ready()
    times = []
    for _ in range(3):
        start = time.process_time()
        run(x).block_until_ready()
        times.append(time.process_time() - start)
    return 1000 * float(np.median(times))


def row(name: str, title: str, shapes, test, steps: int) -> str:
    """One line of the table."""
    shipped = DESIGNS["positions" if name == UPRIGHT else name]
    if name == "positions":
        shapes, test = data.turned(shapes, 0), data.turned(test, 1)
    design = replace(shipped, points=TRAINING_POINTS.get(name, shipped.points))
    used = max(1, int(steps * SHARE_OF_STEPS.get(name, 1.0)))
    start = time.process_time()
    parameters, statistics, _ = train(
        design, shapes, used, 0, RATE.get(name, 2e-3), BATCH.get(name, USUAL_BATCH), log=lambda text: None
    )
    minutes = (time.process_time() - start) / 60
    probabilities = evaluate.softmax(predict(design, parameters, statistics, test))
    entries = evaluate.Entries(probabilities, test.labels[:, : design.signs], test.kind)
    everything = np.ones(len(test), bool)
    clear, _ = evaluate.accuracy(entries, everything, evaluate.UNAMBIGUOUS)
    whole = evaluate.whole_shapes(entries, everything)
    cost = cpu_milliseconds(shipped, parameters, statistics)
    return (f"| {title} | {100 * clear:.2f} | {100 * whole:.1f} | {parameter_count(parameters):,} | {shipped.points} "
            f"| {cost:.1f} | {used} x {BATCH.get(name, USUAL_BATCH)} | {minutes:.1f} |")


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, required=True, help="holds train.npz and test.npz")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--steps", type=int, default=2500)
    parser.add_argument("--only", nargs="*", choices=[name for name, _ in ROWS])
    options = parser.parse_args()
    shapes, test = data.load([options.folder / "train.npz"]), data.load([options.folder / "test.npz"])
    lines = ["| design | sign accuracy % | shapes all right % | parameters | points | CPU ms, all signs | steps x batch | CPU min of training |",
             "|---|---|---|---|---|---|---|---|"]
    for name, title in ROWS:
        if options.only and name not in options.only:
            continue
        lines.append(row(name, title, shapes, test, options.steps))
        print(lines[-1], flush=True)
        options.out.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
