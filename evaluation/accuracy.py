"""The gate on accuracy: twenty generated shapes, and the mean error of their maps against the recorded one.

    python -m evaluation.accuracy [--record | --vary] [--program target/release/intrinsym]

draws the shapes of GROUPS, detects them and fails if the mean of a group, or of all, is more than TOLERANCE above or below that in
accuracy.json. `--record` writes accuracy.json. `--vary` detects each shape again with another number of threads, turned and scaled,
and fails if a mean changes by more than STEADY: rounding differs between machines, too. GROUPS holds shapes whose error hardly changes.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from training.generate import Generator
from training.meshfile import read_ply, write_ply, write_shape

from . import assemblies
from .generated import LARGEST_ERROR, Shape, read_shapes
from .markdown import table
from .program import detect, read_answer, write_results

RECORDED = Path(__file__).with_suffix(".json")
# Shapes by group and kind, each by its number. `assemblies` draws those of the last group, `training.generate` the others.
GROUPS = {
    "people": {"person": (2, 3), "biped": (0, 2)},
    "animals": {"quadruped": (2,), "bird": (1,), "insect": (2,), "sea-star": (2,)},
    "trees": {"random": (5,)},
    "blobs": {"blob": (1, 3)},
    "plates": {"plate": (4, 6, 7)},
    "furniture": {"table": (6,), "chair": (8,), "bracket": (3,)},
    "assemblies": {"furniture": (8,), "vehicle": (2, 20)},
}
SEED = 8950
VERTICES = (1_500, 3_000)
TOLERANCE = 0.03
# What `--vary` allows a mean to change by.
STEADY = 0.01
ONE_THREAD, TWO_THREADS = ["--threads", "1"], ["--threads", "2"]
TURNED_AND_SCALED = [scale * Rotation.from_rotvec(turn).as_matrix() for scale, turn in ((1.7, [0.4, -1.1, 0.7]), (0.3, [-2.0, 0.5, 1.3]))]


@dataclass
class Case:
    """A mesh, and the mean error of a map of it in sqrt(area); no answer counts LARGEST_ERROR."""

    group: str
    path: Path
    error: Callable[[np.ndarray], float]


def cases(folder: Path, groups=GROUPS) -> list[Case]:
    """Writes the shapes into `folder`, a subfolder for each group."""
    return [case for group, kinds in groups.items() for case in drawn(folder / group, group, kinds)]


def drawn(folder: Path, group: str, kinds: dict[str, tuple[int, ...]]) -> list[Case]:
    """The shapes of one group."""
    numbered = [(kind, number) for kind, numbers in kinds.items() for number in numbers]
    if group == "assemblies":
        return [assembled(folder, kind, number) for kind, number in numbered]
    generators = {kind: Generator([kind], VERTICES, damaged=False, remeshed_share=1.0) for kind in kinds}
    for kind, number in numbered:
        sample, mirror, description = generators[kind].draw(SEED, number)
        write_shape(folder, f"{kind}-{number}", sample.posed, sample.faces, mirror, description)
    return [Case(group, shape.path, mean_error(shape)) for shape in read_shapes(folder)]


def mean_error(shape: Shape) -> Callable[[np.ndarray], float]:
    """Over all vertices with a partner: the sample that `Shape.errors` takes would make the mean change more than the map does."""
    return lambda partners: float(shape.errors_at(np.flatnonzero(shape.mirror >= 0), partners).mean())


def assembled(folder: Path, kind: str, number: int) -> Case:
    """An assembly; its error is measured at rest, where left and right are mirror images."""
    assembly, variant = assemblies.draw(kind, number)
    vertices, faces, truth = assemblies.laid_out(assembly)
    path = folder / f"assembly-{kind}-{number}-{variant}.ply"
    folder.mkdir(parents=True, exist_ok=True)
    write_ply(path, vertices, faces)
    unit = np.sqrt(assemblies.triangle_areas(truth["rest"], faces).sum())

    def error(partners: np.ndarray) -> float:
        return float(np.minimum(assemblies.rest_distances(partners, truth["rest"], truth["truth"]) / unit, LARGEST_ERROR).mean())

    return Case("assemblies", path, error)


def measured(program: str, chosen: list[Case], options: list[str], transform: np.ndarray | None = None) -> list[dict]:
    """One row a shape: its group and the error of the program's map. `transform` (3, 3) moves the mesh before."""
    with tempfile.TemporaryDirectory() as work:
        meshes = [case.path if transform is None else moved(case.path, Path(work), transform) for case in chosen]
        answers = Path(work) / "answers"
        detect(program, meshes, answers, options, jobs=2)
        errors = [case.error(read_answer(answers, case.path.stem).partners) for case in chosen]
    return [{"name": case.path.stem, "group": case.group, "error": round(error, 6)} for case, error in zip(chosen, errors)]


def moved(path: Path, folder: Path, transform: np.ndarray) -> Path:
    """The same mesh under another linear map, in another folder."""
    vertices, faces = read_ply(path)
    write_ply(folder / path.name, vertices @ transform.T, faces)
    return folder / path.name


def means(rows: list[dict]) -> dict[str, float]:
    """Mean error of each group, and of all shapes."""
    groups = dict.fromkeys(row["group"] for row in rows)
    of = lambda chosen: float(np.mean([row["error"] for row in chosen]))
    return {group: of([row for row in rows if row["group"] == group]) for group in groups} | {"all": of(rows)}


def compared(recorded: list[dict], rows: list[dict]) -> tuple[str, list[str]]:
    """The table of both means, and the groups whose mean is off; raises ValueError if they are of other shapes."""
    if [row["name"] for row in recorded] != [row["name"] for row in rows]:
        raise ValueError("accuracy.json is of other shapes: make record-accuracy")
    before, after = means(recorded), means(rows)
    change = {group: after[group] / before[group] - 1 for group in before}
    shown = [[group, f"{before[group]:.5f}", f"{after[group]:.5f}", f"{100 * change[group]:+.2f}"] for group in before]
    return table(["mean error, sqrt(area)", "recorded", "now", "change %"], shown), [group for group in change if not abs(change[group]) <= TOLERANCE]


def gate(program: str, chosen: list[Case]) -> int:
    """Exit status: whether all means are those that accuracy.json holds."""
    shown, off = compared(json.loads(RECORDED.read_text())["shapes"], measured(program, chosen, ONE_THREAD))
    print(shown)
    if off:
        print(f"more than {TOLERANCE:.0%} from accuracy.json: {', '.join(off)}; if on purpose, make record-accuracy and say why", file=sys.stderr)
    return int(bool(off))


def vary(program: str, chosen: list[Case]) -> int:
    """Exit status: whether the means are steady."""
    runs = [measured(program, chosen, ONE_THREAD), measured(program, chosen, TWO_THREADS)]
    runs += [measured(program, chosen, ONE_THREAD, transform) for transform in TURNED_AND_SCALED]
    by_run = [{row["name"]: row["error"] for row in rows} | means(rows) for rows in runs]
    changes = {name: [run[name] / error - 1 for run in by_run[1:]] for name, error in by_run[0].items()}
    shown = [[name, f"{by_run[0][name]:.5f}", *(f"{100 * value:+.2f}" for value in change)] for name, change in changes.items()]
    print(table(["mean error", "as it is", "two threads, change %", *["turned and scaled, change %"] * len(TURNED_AND_SCALED)], shown))
    return int(max(abs(value) for group in means(runs[0]) for value in changes[group]) > STEADY)


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/intrinsym")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--record", action="store_true")
    what.add_argument("--vary", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        chosen = cases(Path(folder))
        if arguments.record:
            rows = measured(arguments.program, chosen, ONE_THREAD)
            write_results(RECORDED, {"shapes": rows})
            print(table(["mean error, sqrt(area)", "recorded"], [[group, f"{mean:.5f}"] for group, mean in means(rows).items()]))
        else:
            sys.exit((vary if arguments.vary else gate)(arguments.program, chosen))


if __name__ == "__main__":
    main()
