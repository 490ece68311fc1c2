"""Skeletons: trees of tapered bones, the source of every procedural shape.

The mirror plane of a symmetric skeleton is x = 0. Lengths are in units of about one body height.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

MIRROR = np.array([-1.0, 1.0, 1.0])
SMALLEST_RADIUS = 0.022


def unit(vector: np.ndarray) -> np.ndarray:
    """The vector scaled to length one."""
    return vector / np.linalg.norm(vector)


@dataclass
class Skeleton:
    """Bones as parallel lists; a bone is a capsule whose radius changes linearly from start to end.

    `side` is 0 for a bone in the mirror plane, +1 and -1 for the two bones of a mirrored pair.
    """

    start: list[np.ndarray] = field(default_factory=list)
    end: list[np.ndarray] = field(default_factory=list)
    start_radius: list[float] = field(default_factory=list)
    end_radius: list[float] = field(default_factory=list)
    parent: list[int] = field(default_factory=list)
    side: list[int] = field(default_factory=list)

    def add(self, start, end, start_radius, end_radius, parent, side=0) -> int:
        """Append one bone and return its index; `parent` is -1 for the root."""
        self.start.append(np.array(start, float))
        self.end.append(np.array(end, float))
        self.start_radius.append(max(float(start_radius), SMALLEST_RADIUS))
        self.end_radius.append(max(float(end_radius), SMALLEST_RADIUS))
        self.parent.append(int(parent))
        self.side.append(side)
        return len(self.start) - 1

    def add_pair(self, start, end, start_radius, end_radius, parents) -> tuple[int, int]:
        """Append a bone and its mirror image; returns (right, left)."""
        right = self.add(start, end, start_radius, end_radius, parents[0], +1)
        left = self.add(
            np.asarray(start) * MIRROR, np.asarray(end) * MIRROR, start_radius, end_radius, parents[1], -1
        )
        return right, left

    def descendants(self, bone: int) -> set[int]:
        """The bone and all bones that hang from it."""
        found = {bone}
        for index, parent in enumerate(self.parent):
            if parent in found:
                found.add(index)
        return found


@dataclass
class Tip:
    """Where a limb ended: the last bone (twice if in the plane), its end, direction and radius."""

    bones: tuple[int, int]
    point: np.ndarray
    direction: np.ndarray
    radius: float


@dataclass
class LimbShape:
    """Length, number of bones, first radius, ratio of last to first radius, and how much it bends."""

    length: float
    bones: int
    radius: float
    taper: float
    bend: float = 0.25


def grow_limb(rng, skeleton: Skeleton, origin, parents, direction, shape: LimbShape, how: str = "pair") -> Tip:
    """Grow a chain of bones. `how`: "pair" adds the mirrored chain too, "medial" keeps to the plane,
    "single" adds one chain anywhere (which makes the shape asymmetric)."""
    point, direction, radius = np.array(origin, float), np.array(direction, float), shape.radius
    if how == "medial":
        direction[0] = 0
    direction = unit(direction)
    parents = (parents, parents) if np.isscalar(parents) else parents
    for length in rng.dirichlet(np.full(shape.bones, 6.0)) * shape.length:
        tip, next_radius = point + direction * length, radius * shape.taper ** (1 / shape.bones)
        if how == "pair":
            parents = skeleton.add_pair(point, tip, radius, next_radius, parents)
        else:
            bone = skeleton.add(point, tip, radius, next_radius, parents[0])
            parents = (bone, bone)
        bent = rng.normal(size=3) * shape.bend
        if how == "medial":
            bent[0] = 0
        point, radius, direction = tip, next_radius, unit(direction + bent)
    return Tip(parents, point, direction, radius)


def grow_spine(rng, skeleton: Skeleton, points: np.ndarray, radii: np.ndarray) -> list[int]:
    """Bones through `points` (in the mirror plane) with a radius at each point; returns their indices."""
    bones, parent = [], -1
    for k in range(len(points) - 1):
        parent = skeleton.add(points[k], points[k + 1], radii[k], radii[k + 1], parent)
        bones.append(parent)
    return bones
