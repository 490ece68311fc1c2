"""Generated assemblies: bones, parts on them, and how the bones turn. Pairs are described on the side x > 0."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from training.posing import capsule_weights, chain, rotation, skin
from training.skeleton import MIRROR, Skeleton, unit

from .shells import Cut, fused, mirrored

SIDES = {"": 1.0, "left ": 1.0, "right ": -1.0}
SOFTNESS = 0.03  # of the weights of parts that span bones, in body heights


@dataclass
class Part:
    """One shell at rest. `mirror` is the name of its twin, itself or None; `real` marks vertices that have a counterpart.
    `bone` None: it bends with all bones near it. `curl`: (origin, direction, length, axis, angle) bends it on its bone."""

    name: str
    mirror: str | None
    vertices: np.ndarray
    faces: np.ndarray
    bone: str | None
    real: np.ndarray
    curl: tuple | None = None


@dataclass
class Assembly:
    """Bones and parts; `turns` holds each bone's rotation in the pose, `shifts` how far it slides."""

    cut: Cut
    rng: np.random.Generator
    skeleton: Skeleton = field(default_factory=Skeleton)
    bones: dict[str, int] = field(default_factory=dict)
    turns: dict[str, np.ndarray] = field(default_factory=dict)
    shifts: dict[str, np.ndarray] = field(default_factory=dict)
    parts: dict[str, Part] = field(default_factory=dict)

    def bone(self, name: str, start, end, radii, parent: str | None) -> None:
        """A bone in the mirror plane."""
        self.bones[name] = self.skeleton.add(start, end, *radii, self.bones.get(parent, -1))

    def bone_pair(self, name: str, start, end, radii, parent: str) -> None:
        """A bone on either side; `parent` is a pair or a bone in the plane."""
        parents = [self.bones.get(side + parent, self.bones.get(parent)) for side in ("left ", "right ")]
        pair = self.skeleton.add_pair(start, end, *radii, parents)
        self.bones["left " + name], self.bones["right " + name] = pair

    def add(self, name: str, shape, bone: str | None, mirror: str | None = "", curl=None) -> None:
        """A part that is its own mirror image; with `mirror` None one that has no counterpart."""
        vertices, faces = shape.made(self.cut)
        real = np.full(len(vertices), mirror is not None)
        self.parts[name] = Part(name, name if mirror == "" else mirror, vertices, faces, bone, real, curl)

    def add_pair(self, name: str, shape, bone: str | None, curl=None) -> None:
        """A part on either side, on the bone of that side if there are two. `curl` draws each side's."""
        left, right = "left " + name, "right " + name
        on = lambda side: side + bone if bone and side + bone in self.bones else bone
        draw = curl or (lambda mirror: None)
        self.add(left, shape, on("left "), right, draw(np.ones(3)))
        self.add(right, shape, on("right "), left, draw(MIRROR))
        part = self.parts[right]
        part.vertices, part.faces = mirrored(part.vertices, part.faces)

    def fuse(self, onto: str, shape) -> None:
        """Joins a prop to a part: its vertices have no counterpart."""
        part = self.parts[onto]
        prop = shape.made(self.cut)
        part.vertices, part.faces = fused((part.vertices, part.faces), prop)
        part.real = np.concatenate([part.real, np.zeros(len(prop[0]), bool)])

    def drop(self, name: str) -> None:
        """Takes a part away; its twin has no counterpart any more."""
        twin = self.parts[self.parts.pop(name).mirror]
        twin.mirror, twin.real = None, np.zeros(len(twin.vertices), bool)

    def turn(self, name: str, axis, low: float, high: float, wobble: float = 0.1) -> None:
        """Draws the rotation of a bone, or of both of a pair, each its own: an angle about `axis`, and a little about any."""
        for side, sign in SIDES.items():
            if side + name in self.bones:
                # A reflection turns axes the other way.
                about = unit(np.asarray(axis, float)) * ([1, sign, sign])
                main = rotation(about, self.rng.uniform(low, high))
                self.turns[side + name] = main @ rotation(unit(self.rng.normal(size=3)), self.rng.normal() * wobble)

    def posed(self, part: Part, transforms: np.ndarray) -> np.ndarray:
        """The vertices of a part in the pose."""
        points = part.vertices
        if part.curl:
            points = curled(points, *part.curl)
        if part.bone is None:
            return skin(points, capsule_weights(part.vertices, self.skeleton, SOFTNESS), transforms)
        transform = transforms[self.bones[part.bone]]
        return points @ transform[:3, :3].T + transform[:3, 3]

    def transforms(self) -> np.ndarray:
        """World transform of every bone."""
        turns = [self.turns.get(name, np.eye(3)) for name in self.bones]
        slides = np.array([self.shifts.get(name, np.zeros(3)) for name in self.bones])
        world = chain(self.skeleton.parent, self.skeleton.start, turns)
        world[:, :3, 3] += slides
        return world

    def middle(self, bone: str, share: float = 0.5) -> np.ndarray:
        """A point of a bone at rest."""
        index = self.bones[bone]
        return (1 - share) * self.skeleton.start[index] + share * self.skeleton.end[index]


def curled(points, origin, direction, length, axis, angle) -> np.ndarray:
    """Bends points around `axis` through `origin`, by `angle` at `length` along `direction`."""
    turned = points.copy()
    for row, point in enumerate(points - origin):
        share = np.clip(point @ direction / length, 0, 1)
        turned[row] = origin + rotation(axis, angle * share) @ point
    return turned
