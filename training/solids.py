"""Solids of few flat parts: tables, chairs, angle brackets and thin plates, each with one mirror plane, x = 0.

Each draws a signed distance, which is negative inside. A plate's two sides are alike, so that exchanging them is a reflection
too; it moves vertices by the plate's thickness only. Marching cubes run on a grid that is turned at random, so that left and
right are triangulated independently.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation
from skimage.measure import marching_cubes

from .damage import Sample
from .implicit import largest_piece
from .skeleton import MIRROR, unit

# Cells across the thinnest part, at least.
CELLS_ACROSS = 1.6
# Cells along the longest side of the grid that the area is measured on.
MEASURING_CELLS = 40
# Vertices that marching cubes make for a cell's area of surface, on average over its directions.
VERTICES_OF_CELL = 1.5
# Solids are made this much larger, in thicknesses: it rounds off their edges.
ROUND = 0.08

Distance = Callable[[np.ndarray], np.ndarray]


@dataclass
class Solid:
    """A signed distance, the corner of a box about the origin that holds the shape, and the thickness of its thinnest part."""

    distance: Distance
    reach: np.ndarray
    thickness: float


def box(centre, half) -> Distance:
    """A box along the axes."""

    def distance(points):
        away = np.abs(points - np.array(centre)) - np.array(half)
        return np.linalg.norm(np.maximum(away, 0), axis=-1) + np.minimum(away.max(-1), 0)

    return distance


def of_boxes(boxes: list[tuple]) -> Solid:
    """The union of boxes (centre, half sides), and of the mirror images of those beside the plane."""
    thickness = 2 * min(min(half) for _, half in boxes)
    both = [*boxes, *((np.array(centre) * MIRROR, half) for centre, half in boxes if centre[0] != 0)]
    parts = [box(centre, half) for centre, half in both]
    reach = np.max([np.abs(centre) + half for centre, half in both], axis=0)
    return Solid(lambda points: np.minimum.reduce([part(points) for part in parts]), reach, thickness)


def table(rng) -> Solid:
    """A top on four legs, those in front thicker and nearer to the plane than those behind."""
    u = rng.uniform
    half, height, top, leg = np.array([u(0.4, 0.7), u(0.25, 0.45)]), u(0.2, 0.45), u(0.025, 0.05), u(0.03, 0.06)
    boxes = [((0, 0, height + top), (*half, top))]
    for y, wide, inward in ((1, u(1.3, 2.0), u(0.5, 0.85)), (-1, 1.0, u(0.85, 1.0))):
        thick = leg * wide
        boxes.append(((inward * (half[0] - thick), y * (half[1] - thick), 0), (thick, thick, height + top)))
    return of_boxes(boxes)


def chair(rng) -> Solid:
    """A seat on four legs with a back, sometimes with arm rests."""
    u = rng.uniform
    half, height, seat, leg = np.array([u(0.25, 0.35), u(0.22, 0.35)]), u(0.15, 0.3), u(0.025, 0.04), u(0.03, 0.05)
    back = u(0.25, 0.45)
    boxes = [((0, 0, height), (*half, seat)), ((0, -half[1] + seat, height + back), (half[0], seat, back))]
    boxes += [((half[0] - leg, y * (half[1] - leg), 0), (leg, leg, height)) for y in (1, -1)]
    if rng.random() < 0.5:
        rest = u(0.12, 0.2)
        boxes.append(((half[0] - leg, 0, height + rest), (leg, half[1], seat)))
        boxes.append(((half[0] - leg, half[1] - leg, height + rest / 2), (leg, leg, rest / 2)))
    return of_boxes(boxes)


def bracket(rng) -> Solid:
    """An angle profile of two unlike legs, its third side along x, sometimes with a rib in the plane or two beside it."""
    u = rng.uniform
    width, long, thick = u(0.2, 0.6), u(0.4, 0.6), u(0.03, 0.06)
    short = long * u(0.4, 0.75)
    boxes = [((0, 0, -short), (width, long, thick)), ((0, -long + thick, 0), (width, thick, short + thick))]
    if rng.random() < 0.6:
        beside = rng.choice([0.0, u(0.4, 0.8) * width])
        boxes.append(((beside, -long / 2, -short / 2), (thick, long / 2, short / 2)))
    return of_boxes(boxes)


def plate(rng) -> Solid:
    """A thin sheet: a tapered middle with mirrored and medial lobes."""
    u = rng.uniform
    thickness = u(0.025, 0.06)
    lobes = [(np.array([0, -u(0.3, 0.6)]), np.array([0, u(0.3, 0.6)]), u(0.12, 0.25), u(0.08, 0.2))]
    for _ in range(rng.integers(1, 4)):
        start, angle = np.array([0, u(-0.4, 0.4)]), u(-1.3, 1.3)
        end = start + u(0.3, 0.7) * np.array([np.cos(angle), np.sin(angle)])
        lobe = (u(0.06, 0.14), u(0.05, 0.14))
        lobes += [(start, end, *lobe), (start * MIRROR[:2], end * MIRROR[:2], *lobe)]

    def distance(points):
        flat = np.min([_tapered(points[..., :2], *lobe) for lobe in lobes], axis=0)
        return np.maximum(flat, np.abs(points[..., 2]) - thickness / 2)

    ends = np.abs([end for lobe in lobes for end in lobe[:2]]).max(0) + 0.25
    return Solid(distance, np.array([*ends, thickness]), thickness)


def _tapered(points, start, end, start_radius, end_radius):
    axis = end - start
    along = np.clip((points - start) @ axis / (axis @ axis), 0, 1)
    middle = start + along[..., None] * axis
    return np.linalg.norm(points - middle, axis=-1) - (start_radius + along * (end_radius - start_radius))


def surface(rng, solid: Solid, wanted: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles, about `wanted` vertices unless the thinnest part asks for more."""
    finest = solid.thickness / CELLS_ACROSS
    measured = _marched(solid, np.eye(3), min(2 * solid.reach.max() / MEASURING_CELLS, finest), np.zeros(3))
    corners = measured[0][measured[1]]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    cell = min(np.sqrt(VERTICES_OF_CELL * area / wanted), finest)
    turn = Rotation.random(rng=rng).as_matrix()
    return largest_piece(*_marched(solid, turn, cell, rng.uniform(size=3)))


def _marched(solid: Solid, turn: np.ndarray, cell: float, shift: np.ndarray):
    reach = np.abs(turn) @ solid.reach + 2 * cell
    axes = [np.arange(-most - offset * cell, most + 2 * cell, cell) for most, offset in zip(reach, shift)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    values = solid.distance(grid @ turn) - ROUND * solid.thickness
    vertices, faces, _, _ = marching_cubes(values, 0.0)
    return (vertices * cell + [axis[0] for axis in axes]) @ turn, faces.astype(np.int64)


def bent(rng, points: np.ndarray, upward: np.ndarray, curvature: float) -> np.ndarray:
    """Rolled about a line at right angles to `upward`: sheets at right angles to `upward` keep their lengths."""
    along = np.cross(upward, unit(rng.normal(size=3)))
    along = unit(along)
    away, angle = 1 / curvature - points @ upward, curvature * (points @ along)
    moved = points - np.outer(points @ along, along) - np.outer(points @ upward, upward)
    return moved + np.outer(away * np.sin(angle), along) + np.outer(1 / curvature - away * np.cos(angle), upward)


def solid_shape(rng, draw, is_sheet: bool, amount: float, wanted: int) -> Sample:
    """A meshed solid that `draw` draws, every second one bent: sheets along themselves, which keeps lengths, others a little along any line."""
    rest, faces = surface(rng, draw(rng), wanted)
    upward = np.array([0, 0, 1.0]) if is_sheet else unit(rng.normal(size=3))
    curvature = amount * (2.0 if is_sheet else 0.4)
    posed = bent(rng, rest, upward, curvature) if rng.random() < 0.5 else rest.copy()
    return Sample(rest, posed, faces)


SOLID_KINDS = {"table": table, "chair": chair, "bracket": bracket, "plate": plate}
