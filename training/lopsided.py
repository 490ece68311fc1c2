"""Solids without a symmetry, of the kinds that are easily taken for symmetric: hands, terrain, food, tools, sofas, rocks.

Each draws a signed distance, as `solids` does. What breaks the symmetry is a tenth of the shape or more: thumbs, hills, toppings.
"""

from __future__ import annotations

import numpy as np

from .skeleton import unit
from .solids import Solid, box

# No two of the sizes that must differ are nearer to each other than this factor.
UNLIKE = 1.25


def hand(rng) -> Solid:
    """A palm with a thumb and four fingers of unlike length and girth, some of them bent."""
    u = rng.uniform
    width, girth = u(0.36, 0.5), u(0.045, 0.06)
    lengths = np.array([0.62, 0.9, 1.0, 0.85]) * u(0.45, 0.65) * u(0.95, 1.05, 4)
    capsules = []
    for place, length in zip(np.linspace(-0.42, 0.42, 4), lengths):
        start = np.array([place * width, 0.2, 0])
        middle = start + [place * u(0.1, 0.3), 0.55 * length, 0]
        end = middle + unit(np.array([place * 0.3, 1, -u(0, 1.2)])) * 0.45 * length
        capsules += [(start, middle, girth), (middle, end, 0.9 * girth)]
    root, knuckle = np.array([0.4 * width, -0.15, 0]), np.array([0.4 * width + u(0.15, 0.25), 0.02, -u(0, 0.1)])
    capsules += [(root, knuckle, 1.3 * girth), (knuckle, knuckle + [u(0.02, 0.12), u(0.12, 0.2), 0], 1.1 * girth)]
    capsules.append((np.array([0, -0.2, 0]), np.array([0, -u(0.45, 0.7), 0]), u(0.1, 0.13)))
    palm = box((0, 0, 0), (0.5 * width, 0.24, girth))
    parts = [palm, *(_capsule(*one) for one in capsules)]
    reach = np.abs([end for one in capsules for end in one[:2]]).max(0) + 0.2
    return Solid(lambda points: np.minimum.reduce([part(points) for part in parts]), reach, 1.6 * girth)


def terrain(rng) -> Solid:
    """A slab of ground with hills and hollows."""
    half = np.array([rng.uniform(0.4, 0.5), rng.uniform(0.4, 0.5)])
    hills = _hills(rng, int(rng.integers(4, 9)), half, (0.08, 0.2), (-0.2, 0.6))
    flat = box((0, 0, 0), (*half, 1.0))

    def distance(points):
        height = sum(rise * np.exp(-((points[..., :2] - at) ** 2).sum(-1) / (2 * size**2)) for at, size, rise in hills)
        return np.maximum(np.maximum(points[..., 2] - height, -0.25 - points[..., 2]), flat(points))

    return Solid(distance, np.array([*half, 1.2]), 0.1)


def topped(rng) -> Solid:
    """A flat round loaf with a crust and single toppings, and sometimes a slice cut out."""
    radius, thick = 0.5, rng.uniform(0.03, 0.06)
    angles = rng.uniform(0, 2 * np.pi, int(rng.integers(5, 9)))
    toppings = [(np.array([*(rng.uniform(0.05, 0.4) * np.array([np.cos(a), np.sin(a)])), thick]), rng.uniform(0.08, 0.2)) for a in angles]
    cut = rng.uniform(0.3, 1.0) if rng.random() < 0.4 else 0.0

    def distance(points):
        away = np.hypot(points[..., 0], points[..., 1])
        loaf = np.maximum(away - radius, np.abs(points[..., 2]) - thick)
        crust = np.hypot(away - radius + 0.03, points[..., 2]) - 1.6 * thick
        balls = [np.linalg.norm(points - at, axis=-1) - size for at, size in toppings]
        angle = np.mod(np.arctan2(points[..., 1], points[..., 0]), 2 * np.pi)
        inside = np.minimum.reduce([loaf, crust, *balls])
        return np.where(angle < cut, np.maximum(inside, 0.02), inside)

    return Solid(distance, np.array([0.65, 0.65, 0.3]), 2 * thick)


def tool(rng) -> Solid:
    """A bent handle with a head whose two ends differ, and a hook to one side."""
    u = rng.uniform
    girth, length = u(0.03, 0.05), u(0.7, 1.0)
    top, side = np.array([u(-0.1, 0.1), 0, length]), u(0.5, 0.9)
    face, claw = top + [u(0.15, 0.3), u(0.0, 0.1), u(-0.05, 0.05)], top - [u(0.3, 0.5), u(0.05, 0.2), u(0.05, 0.2)]
    hook = np.array([0, 0, side * length])
    capsules = [
        (np.zeros(3), np.array([u(0.05, 0.2), 0.1, 0.5 * length]), girth),
        (np.array([0.1, 0.1, 0.5 * length]), top, girth),
        (top, face, girth * u(1.6, 2.4)),
        (top, claw, girth * u(0.9, 1.2)),
        (hook, hook + [u(-0.1, 0.1), u(0.15, 0.3), u(-0.1, 0.1)], girth),
    ]
    parts = [_capsule(*one) for one in capsules]
    reach = np.abs([end for one in capsules for end in one[:2]]).max(0) + 0.15
    return Solid(lambda points: np.minimum.reduce([part(points) for part in parts]), reach, 2 * girth)


def sofa(rng) -> Solid:
    """A seat around a corner, one wing longer and deeper than the other, with a back and one arm rest."""
    u = rng.uniform
    long, short, deep = u(0.6, 0.8), u(0.3, 0.45), u(0.14, 0.2)
    boxes = [((long, 0, 0), (long, deep, 0.1)), ((0, short, 0), (deep / UNLIKE, short, 0.1))]
    boxes += [((long, -deep, 0.2), (long, 0.05, 0.2)), ((-deep / UNLIKE, short, 0.15), (0.05, short, 0.15))]
    boxes.append(((2 * long - 0.05, 0, u(0.1, 0.2)), (0.05, deep, u(0.12, 0.2))))
    parts = [box(centre, half) for centre, half in boxes]
    reach = np.max([np.abs(centre) + half for centre, half in boxes], axis=0)
    return Solid(lambda points: np.minimum.reduce([part(points) for part in parts]), np.array(reach), 0.1)


def rock(rng) -> Solid:
    """An ellipsoid with some broad bumps and dents."""
    axes = 0.4 * UNLIKE ** np.arange(3) * rng.uniform(0.95, 1.05, 3)
    bumps = [(unit(rng.normal(size=3)), rng.uniform(0.25, 0.5), rng.uniform(-0.35, 0.7)) for _ in range(int(rng.integers(5, 9)))]

    def distance(points):
        away = np.linalg.norm(points, axis=-1)
        direction = points / np.maximum(away, 1e-9)[..., None]
        radius = 1 / np.linalg.norm(direction / axes, axis=-1)
        rise = sum(height * np.exp((direction @ at - 1) / size**2) for at, size, height in bumps)
        return away - radius * (1 + rise)

    return Solid(distance, axes * 2.2, 0.2)


def _hills(rng, count: int, half: np.ndarray, sizes, rises) -> list[tuple]:
    """Place, width and height of each."""
    return [(rng.uniform(-0.85, 0.85, 2) * half, rng.uniform(*sizes), rng.uniform(*rises)) for _ in range(count)]


def _capsule(start, end, radius):
    axis = end - start

    def distance(points):
        along = np.clip((points - start) @ axis / (axis @ axis), 0, 1)
        return np.linalg.norm(points - start - along[..., None] * axis, axis=-1) - radius

    return distance


LOPSIDED_KINDS = {"hand": hand, "terrain": terrain, "topped": topped, "tool": tool, "sofa": sofa, "rock": rock}
