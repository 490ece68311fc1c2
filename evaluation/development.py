"""The development sets: frozen generated shapes on which mechanisms are kept or deleted (docs/ablation.md).

    python -m evaluation.development FOLDER [--only SET ...] [--count N]

writes FOLDER/SET/NAME.ply with truth and description, as `training.generate` does, and skips those that are there. Left and
right are triangulated independently, except in `flipped` and `mirrored`. Shape number i of a set depends on SEED, the set's
own number and i only.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from training import damage
from training.creatures import ASYMMETRIC_KINDS
from training.damage import Sample
from training.generate import Generator
from training.meshfile import write_shape
from training.mirror_truth import mirror_map

from .severity import with_holes
from .synthetic import rest_error

SEED = 8800
VERTICES = (1_000, 12_000)
CREATURES = ("person", "quadruped", "biped", "bird")


@dataclass
class DevelopmentSet:
    """Shapes of `kinds` in turn; `seed` is its number after SEED, `mirrored` gives left and right the same connectivity."""

    seed: int
    kinds: tuple[str, ...]
    count: int = 20
    damaged: Callable[[np.random.Generator, Sample], Sample] | None = None
    mirrored: bool = False

    def draw(self, generator: Generator, index: int) -> tuple[Sample, np.ndarray, dict]:
        """Sample, truth and description of shape number `index`."""
        sample, mirror, description = generator.draw(SEED + self.seed, index)
        if description["symmetric"]:
            description["truth_error"] = rest_error(sample, mirror)
        if self.damaged:
            sample = self.damaged(np.random.default_rng([SEED + self.seed, index, 1]), sample)
            mirror = mirror_map(sample.rest, sample.faces)
        return sample, mirror, description

    def generator(self) -> Generator:
        """What draws the undamaged shapes."""
        return Generator(list(self.kinds), VERTICES, damaged=False, remeshed_share=0.0 if self.mirrored else 1.0)


SETS = {
    "person": DevelopmentSet(1, ("person", "biped")),
    "animal": DevelopmentSet(2, ("quadruped", "bird")),
    "insect": DevelopmentSet(3, ("insect",)),
    "sea-star": DevelopmentSet(4, ("sea-star",)),
    "blob": DevelopmentSet(5, ("blob",)),
    "random": DevelopmentSet(6, ("random",)),
    "plate": DevelopmentSet(7, ("plate",)),
    "furniture": DevelopmentSet(8, ("table", "chair", "bracket")),
    "holes": DevelopmentSet(9, CREATURES, damaged=lambda rng, sample: with_holes(rng, sample, rng.uniform(0.05, 0.25))),
    "noise": DevelopmentSet(10, CREATURES, 12, lambda rng, sample: damage.add_noise(rng, sample, rng.uniform(0.1, 0.4))),
    "cut-limb": DevelopmentSet(11, CREATURES, 12, damage.cut_limb),
    "flipped": DevelopmentSet(12, CREATURES, 12, lambda rng, sample: damage.flip_edges(rng, sample, rng.uniform(0.02, 0.3)), True),
    "mirrored": DevelopmentSet(13, CREATURES, 8, mirrored=True),
    "none": DevelopmentSet(14, tuple(ASYMMETRIC_KINDS), 60),
}  # fmt: skip


def make(folder: Path, names=tuple(SETS), most: int | None = None) -> None:
    """Writes the shapes of these sets that are not there yet, the first `most` of each."""
    for name in names:
        chosen, generator = SETS[name], None
        for index in range(min(chosen.count, most or chosen.count)):
            shape = f"{name}-{index:03d}"
            if (folder / name / f"{shape}.json").exists():
                continue
            generator = generator or chosen.generator()
            sample, mirror, description = chosen.draw(generator, index)
            write_shape(folder / name, shape, sample.posed, sample.faces, mirror, description)


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", nargs="+", choices=SETS, default=tuple(SETS))
    parser.add_argument("--count", type=int, help="at most so many shapes of each set")
    arguments = parser.parse_args()
    make(arguments.folder, arguments.only, arguments.count)


if __name__ == "__main__":
    main()
