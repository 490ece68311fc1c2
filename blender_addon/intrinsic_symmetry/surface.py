# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface of some faces, its nearest points, and values mixed from its vertices and face corners."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from mathutils.bvhtree import BVHTree

from . import mesh_data
from .elements import barycentric

#: A point is outside of a triangle from this weight of a corner on.
_OUTSIDE = -1e-3
#: A triangle has no area if it is less than this share of its longest side's square.
_NO_AREA = 1e-9


@dataclass(frozen=True)
class Mix:
    """Rows of other numbers: three of each, and their weights."""

    rows: np.ndarray  # (n, 3) int
    weights: np.ndarray  # (n, 3)

    def of(self, values):
        """(n, ...) values; those that are no real numbers, from the row that weighs most."""
        if values.dtype.kind != "f":
            return values[self.rows[np.arange(len(self.rows)), self.weights.argmax(axis=1)]]
        return np.einsum("nk,nk...->n...", self.weights, values[self.rows])

    def at(self, chosen):
        return Mix(self.rows[chosen], self.weights[chosen])

    def take(self, chosen, surface, points):
        """Gives the chosen rows, (n,) bool, the vertices of a surface where it is nearest to the points."""
        if chosen.any():
            there = surface.vertex_mix(points[chosen])
            self.rows[chosen], self.weights[chosen] = there.rows, there.weights


class Surface:
    """Triangles that have an area, with one of the chosen vertices, (vertices,) bool, or with three, where `which` is
    `np.all`; triangle 0 is the first of them."""

    def __init__(self, mesh, positions, chosen, which=np.any):
        mesh.calc_loop_triangles()
        loops = np.empty(3 * len(mesh.loop_triangles), np.int32)
        faces = np.empty(len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("loops", loops)
        mesh.loop_triangles.foreach_get("polygon_index", faces)
        corners = np.asarray(mesh_data.polygons(mesh)[1]).astype(np.int64)
        loops = loops.reshape(-1, 3)
        inside = which(chosen[corners[loops]], axis=1) & _has_area(positions[corners[loops]])
        self._loops, self.faces = loops[inside], faces[inside]
        self.vertices, self.positions = corners[self._loops], positions
        self._places = positions[self.vertices]
        self._first = np.searchsorted(self.faces, self.faces)  # triangles are in the order of their faces
        self._count = np.bincount(self.faces, minlength=self.faces.max(initial=0) + 1)[self.faces]

    @cached_property
    def _tree(self):
        triangles = np.arange(self._loops.size).reshape(-1, 3)
        return BVHTree.FromPolygons(self._places.reshape(-1, 3).tolist(), triangles.tolist())

    def feet(self, points):
        """Triangles of the nearest points of the surface, and the weights of their vertices there."""
        found = [self._tree.find_nearest(point) for point in points.tolist()]
        triangle, feet = np.array([each[2] for each in found]), np.array([each[0] for each in found])
        weights = np.maximum(barycentric(feet, self._places[triangle]), 0)
        return triangle, weights / weights.sum(axis=1, keepdims=True)

    def vertex_mix(self, points):
        """The Mix of vertices at the nearest points of the surface."""
        triangle, weights = self.feet(points)
        return Mix(self.vertices[triangle], weights)

    def nearest(self, points, chosen):
        """(points,) number of the nearest triangle, of the chosen ones."""
        found = np.zeros(len(points), np.int64)
        found[chosen] = [self._tree.find_nearest(point)[2] for point in points[chosen].tolist()]
        return found

    def mix(self, points, below, beside, island):
        """The Mix of face corners at points: of the face that is below the new face where it holds the point; else of
        the triangle beside the point, if that is in the same island, or of the face below, extended."""
        best, depth = below.copy(), np.full(len(points), -np.inf)
        for step in range(self._count.max()):
            there = np.flatnonzero(step < self._count[below])
            triangle = self._first[below[there]] + step
            least = barycentric(points[there], self._places[triangle]).min(axis=1)
            better = least > depth[there]
            best[there[better]], depth[there[better]] = triangle[better], least[better]
        same = island[self._loops[beside, 0]] == island[self._loops[best, 0]]
        chosen = np.where(same & (depth < _OUTSIDE), beside, best)
        return Mix(self._loops[chosen], barycentric(points, self._places[chosen]))


def _has_area(triangles):
    """(n,) bool, for (n, 3, 3) corners: whether these are not on one line."""
    sides = triangles[:, 1:] - triangles[:, :1]
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    return area > _NO_AREA * (sides**2).sum(axis=2).max(axis=1)
