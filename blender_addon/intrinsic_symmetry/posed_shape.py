# SPDX-License-Identifier: GPL-3.0-or-later
"""Symmetric in its pose: each side takes the other's lengths and keeps its own bending, whatever the width of the
asymmetry.

A pose bends a surface and leaves its lengths alone, so what is wide is taken from the lengths: each triangle is
stretched in its own plane as much as its mirror image says, without turning, and the positions follow from the edges
that this gives (R. W. Sumner, J. Popovic, "Deformation Transfer for Triangle Meshes", 2004, section 3; here the own side keeps
its rotations). No bpy here.
"""

import numpy as np

from .multilevel import Graph
from .places import Places

#: How strongly old positions hold, against an eigenvalue of the Laplacian at unit area, of which the halves of a body
#: have 10: only so much that what nothing else holds stays where it is.
_HOLD = 0.01
#: Least weight of an edge, where the angles opposite to it give less; least and largest stretch of a triangle.
_LEAST_WEIGHT, _STRETCH = 1e-3, (0.2, 5.0)


class PosedShape:
    """A surface of triangles, (triangles, 3) vertices. `share`, (vertices,) 0..1: how much of the other side's lengths
    each vertex takes; those with 0 stay."""

    def __init__(self, symmetry, triangles, positions, share):
        self._symmetry, self._share = symmetry, share
        self._places = Places(positions)
        self._point, self._count = self._places.of, len(self._places.all)
        corners = self._point[triangles]
        distinct = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
        self._triangles = triangles[distinct]
        # One row for each side of each triangle: from a corner to the next one.
        self._start = self._triangles.T.ravel()
        self._end = np.roll(self._triangles, -1, axis=1).T.ravel()
        self._free = self._places.free(share > 0)
        self._moves = self._free[self._point[self._triangles]].any(axis=1)

    def with_lengths(self, positions, other=None):
        """(vertices, 3) positions whose edges come nearest to those with the lengths of the other side, as it is in
        `other`, (vertices, 3), or else in the positions."""
        places = self._places.moved(positions, self._free)
        positions = places[self._point]
        edges, weights, areas = self._measured(positions)
        change = self._stretched(positions, edges, positions if other is None else other) - edges
        share = np.maximum(self._share[self._start], self._share[self._end])
        ends = self._point[np.stack([self._start, self._end], axis=1)]
        masses = np.bincount(self._point[self._triangles].ravel(), np.repeat(areas / 3, 3), self._count)
        graph = Graph(places, ends, weights, _HOLD * masses / max(areas.sum(), 1e-300), self._free)
        return (places + graph.moved(share[:, None] * change))[self._point]

    def _measured(self, positions):
        """The sides of all triangles, their cotangent weights, and the triangles' areas."""
        edges = positions[self._end] - positions[self._start]
        sides = edges.reshape(3, -1, 3)
        doubled = np.linalg.norm(np.cross(sides[0], sides[1]), axis=1)
        opposite = [-(sides[(side + 1) % 3] * sides[(side + 2) % 3]).sum(axis=1) for side in range(3)]
        cotangents = np.concatenate(opposite) / np.maximum(np.tile(doubled, 3), 1e-300)
        return edges, np.maximum(0.5 * cotangents, _LEAST_WEIGHT), 0.5 * doubled

    def _stretched(self, positions, edges, other):
        """(edges, 3) the edges after each triangle is stretched, in its own plane, to the shape of its mirror image.
        In closed form: a library for matrices takes three times as long, and waits for threads where others compute."""
        images = self._symmetry.surface_points.positions(other)
        own, other = ([at[corner] - at[self._triangles[:, 0]] for corner in self._triangles.T[1:]]
                      for at in (positions, images))
        # Two axes across each other, and what the way to the mirror image makes of them.
        length, first = _unit(own[0])
        along = _dot(first, own[1])
        height, second = _unit(own[1] - along * first)
        used = (self._moves & np.isfinite(other).all(axis=(0, 2)))[:, None] & (length * height > 1e-30)
        with np.errstate(all="ignore"):
            of_first = other[0] / length
            of_second = (other[1] - along * of_first) / height
        of_first, of_second = np.where(used, of_first, first), np.where(used, of_second, second)
        # The axes of the stretch: eigenvectors of the symmetric matrix of their products.
        half = 0.5 * (_dot(of_first, of_first) - _dot(of_second, of_second))
        middle, mixed = _dot(of_first, of_first) - half, _dot(of_first, of_second)
        turn, apart = 0.5 * np.arctan2(mixed, half), np.hypot(half, mixed)
        axes = (np.cos(turn) * first + np.sin(turn) * second, np.cos(turn) * second - np.sin(turn) * first)
        stretched = sides = edges.reshape(3, -1, 3)
        for axis, square in zip(axes, (middle + apart, middle - apart)):
            stretch = np.where(used, np.clip(np.sqrt(np.maximum(square, 0)), *_STRETCH), 1)
            stretched = stretched + (stretch - 1) * _dot(axis, sides) * axis
        return stretched.reshape(-1, 3)


def _dot(a, b):
    """(..., 1) scalar products of vectors, (..., 3)."""
    return (a * b).sum(axis=-1, keepdims=True)


def _unit(vectors):
    """(vectors, 1) lengths, and the vectors scaled to length 1."""
    lengths = np.sqrt(_dot(vectors, vectors))
    return lengths, vectors / np.maximum(lengths, 1e-300)
