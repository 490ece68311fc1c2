"""Shapes of the generator with their truth, and how far an answer is from it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from training.meshfile import read_ply

from .surface import Surface

# Vertices of each shape whose answer is measured.
MEASURED = 300
# A map whose mean error, in sqrt(area), is above this pairs the wrong limbs, or moves too little.
WRONG = 0.1
# What no answer counts, in sqrt(area), and the most that any answer does.
LARGEST_ERROR = 1.0


@dataclass
class Shape:
    """A generated mesh; `mirror` holds each vertex's true partner, -1 where there is none."""

    name: str
    path: Path
    mirror: np.ndarray
    description: dict

    @property
    def symmetric(self) -> bool:
        """Whether there is a truth to find."""
        return self.description["symmetric"]

    @cached_property
    def surface(self) -> Surface:
        """What distances are measured on."""
        return Surface(*read_ply(self.path))

    def measured(self) -> np.ndarray:
        """A fixed random sample of the vertices that have a true partner."""
        paired = np.flatnonzero(self.mirror >= 0)
        return np.sort(np.random.default_rng(0).permutation(paired)[:MEASURED])

    def errors(self, partners: np.ndarray) -> np.ndarray:
        """Distance of the answer from the truth at each measured vertex, in sqrt(area)."""
        return self.errors_at(self.measured(), partners)

    def errors_at(self, vertices: np.ndarray, partners: np.ndarray) -> np.ndarray:
        """The same at vertices of one's choice, which must have a true partner."""
        answered = partners[vertices]
        errors = np.full(len(vertices), LARGEST_ERROR)
        some = answered >= 0
        errors[some] = self.surface.distances(answered[some], self.mirror[vertices[some]])
        return np.minimum(errors, LARGEST_ERROR)


def read_shapes(folder: Path) -> list[Shape]:
    """All shapes that `training.generate` wrote into a folder, by name. FileNotFoundError if there are none."""
    shapes = []
    for path in sorted(folder.glob("*.ply")):
        description = json.loads(path.with_suffix(".json").read_text())
        mirror = np.loadtxt(path.with_suffix(".mirror"), dtype=int, ndmin=1)
        shapes.append(Shape(path.stem, path, mirror, description))
    if not shapes:
        raise FileNotFoundError(f"no shapes in {folder}")
    return shapes
