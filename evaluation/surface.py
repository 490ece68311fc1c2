"""Distances along a triangle mesh.

Shortest ways in the graph of the edges and of every straight line across up to `DEPTH` triangles unfolded into the plane.
They are never shorter than geodesics, and about 0.2 % longer on the meshes of the Princeton benchmark; the exact
distance (J. Mitchell, D. Mount, C. Papadimitriou, "The Discrete Geodesic Problem", 1987; package pygeodesic) takes a
hundred times as long and settles close calls. Any triangles will do, manifold or not.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

DEPTH = 5
# Distances are first sought within this many sqrt(area): most images lie near the true one.
NEAR = 0.1
SOURCES_AT_ONCE = 64


class Surface:
    """`vertices` (n, 3) and `triangles` (m, 3); distances in units of sqrt(area)."""

    def __init__(self, vertices: np.ndarray, triangles: np.ndarray):
        self.vertices = np.ascontiguousarray(vertices, float)
        self.triangles = np.ascontiguousarray(triangles, np.int64)
        corners = self.vertices[self.triangles]
        # Perpendicular to each triangle, twice its area long.
        self.normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self.area = float(np.linalg.norm(self.normals, axis=1).sum() / 2)

    @property
    def unit(self) -> float:
        """Square root of the area."""
        return float(np.sqrt(self.area))

    @cached_property
    def vertex_normals(self) -> np.ndarray:
        """Unit normals (n, 3), triangles weighted by area."""
        normals = np.zeros_like(self.vertices)
        for corner in range(3):
            np.add.at(normals, self.triangles[:, corner], self.normals)
        return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)

    @cached_property
    def graph(self) -> csr_matrix:
        """Symmetric matrix of the lengths of edges and unfolded lines, in sqrt(area)."""
        rows, columns, lengths = straight_lines(self.vertices / self.unit, self.triangles)
        count = len(self.vertices)
        key = rows * count + columns
        order = np.argsort(key, kind="stable")
        first = np.flatnonzero(np.r_[True, np.diff(key[order]) > 0])
        shortest = np.maximum(np.minimum.reduceat(lengths[order], first), 1e-300)  # csgraph takes 0 for no edge
        key = key[order[first]]
        return csr_matrix((shortest, (key // count, key % count)), shape=(count, count))

    def distances(self, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
        """Distance of each pair; infinite between pieces that do not touch."""
        starts, ends = np.asarray(starts, np.int64), np.asarray(ends, np.int64)
        if len(np.unique(starts)) > len(np.unique(ends)):
            starts, ends = ends, starts
        found = np.where(starts == ends, 0.0, np.inf)
        for limit in (NEAR, np.inf):
            self._seek(starts, ends, found, limit)
        return found

    def _seek(self, starts, ends, found, limit) -> None:
        left = np.flatnonzero(np.isinf(found))
        sources, row = np.unique(starts[left], return_inverse=True)
        for first in range(0, len(sources), SOURCES_AT_ONCE):
            ways = dijkstra(self.graph, indices=sources[first : first + SOURCES_AT_ONCE], limit=limit)
            here = (row >= first) & (row < first + SOURCES_AT_ONCE)
            found[left[here]] = ways[row[here] - first, ends[left[here]]]

    @cached_property
    def _exact(self):
        from pygeodesic.geodesic import PyGeodesicAlgorithmExact  # imported here: only close calls need it

        return PyGeodesicAlgorithmExact(self.vertices, self.triangles)

    def exact_distance(self, start: int, end: int) -> float:
        """The exact distance of one pair; seconds at 12,500 vertices."""
        return float(self._exact.geodesicDistance(int(start), int(end))[0]) / self.unit


def opposite_half_edges(triangles: np.ndarray, vertices: int) -> np.ndarray:
    """For half edge 3 f + k, which runs from corner k to corner k + 1 of f: the one that runs back, or -1.

    Edges that more than two triangles share, or that two run along in the same direction, have none.
    """
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    there, back = start * vertices + end, end * vertices + start
    order = np.argsort(there, kind="stable")
    keys = there[order]
    place = np.minimum(np.searchsorted(keys, back), len(keys) - 1)
    last = np.minimum(place + 1, len(keys) - 1)
    once = (keys[place] == back) & ~((last > place) & (keys[last] == back))
    opposite = np.where(once, order[place], -1)
    known = opposite >= 0
    mutual = known.copy()
    mutual[known] = opposite[opposite[known]] == np.flatnonzero(known)
    return np.where(mutual, opposite, -1)


def straight_lines(vertices: np.ndarray, triangles: np.ndarray):
    """Edges, and lines from a vertex straight across up to `DEPTH` edges: arrays (from, to, length)."""
    opposite = opposite_half_edges(triangles, len(vertices))
    length = lambda a, b: np.linalg.norm(vertices[a] - vertices[b], axis=1)
    flat = triangles.ravel()
    apex, near, far = flat, np.roll(triangles, -1, axis=1).ravel(), np.roll(triangles, -2, axis=1).ravel()
    a, b, c = length(apex, near), length(apex, far), length(near, far)
    found = [(apex, near, a), (apex, far, b)]
    usable = (a > 0) & (b > 0) & (c > 0)
    cosine = np.clip((a**2 + b**2 - c**2) / np.maximum(2 * a * b, 1e-300), -1, 1)
    left = np.c_[a, np.zeros_like(a)]
    right = np.c_[b * cosine, b * np.sqrt(1 - cosine**2)]
    index = np.arange(len(flat))
    crossed = index - index % 3 + (index + 1) % 3
    # The apex sits at the origin; `window` holds the crossed edge's ends, and the rays that bound what the apex sees.
    state = [apex[usable], crossed[usable], *(points[usable] for points in (left, right, left, right))]
    for _ in range(DEPTH):
        lines, state = _cross(vertices, flat, opposite, length, *state)
        found.append(lines)
    return tuple(np.concatenate(parts) for parts in zip(*found))


def _cross(vertices, flat, opposite, length, apex, crossed, left, right, left_ray, right_ray):
    """Unfolds the triangle behind each crossed edge: lines to its far corner where that is seen, and the next edges.

    Edges without length are not crossed: nothing is seen through them.
    """
    ends = flat[crossed], flat[crossed - crossed % 3 + (crossed + 1) % 3]
    inside = (opposite[crossed] >= 0) & (length(*ends) > 0)
    apex, crossed, left, right, left_ray, right_ray = (
        part[inside] for part in (apex, crossed, left, right, left_ray, right_ray)
    )
    behind = opposite[crossed]
    base = behind - behind % 3
    corner, on_right, on_left = (flat[base + (behind + k) % 3] for k in (2, 0, 1))
    to_left, to_right = length(on_left, corner), length(on_right, corner)
    width = length(on_left, on_right)
    along = (to_left**2 - to_right**2 + width**2) / (2 * width)
    away = np.sqrt(np.maximum(to_left**2 - along**2, 0))
    direction = (right - left) / width[:, None]
    outward = np.c_[-direction[:, 1], direction[:, 0]]
    outward *= np.where((outward * left).sum(1) < 0, -1, 1)[:, None]
    place = left + along[:, None] * direction + away[:, None] * outward
    cross = lambda p, q: p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    before_right, after_left = cross(right_ray, place) <= 1e-12, cross(left_ray, place) >= -1e-12
    seen = before_right & after_left
    line = seen & (corner != apex)
    lines = apex[line], corner[line], np.linalg.norm(place[line], axis=1)
    # Beyond the edge to the left of the corner, then beyond the one to its right.
    go_left, go_right = seen | ~before_right, seen | (before_right & ~after_left)
    mixed = lambda own, other: np.where(seen[:, None], own, other)
    beside_left = [apex, base + (behind + 1) % 3, left, place, left_ray, mixed(place, right_ray)]
    beside_right = [apex, base + (behind + 2) % 3, place, right, mixed(place, left_ray), right_ray]
    state = [np.concatenate([p[go_left], q[go_right]]) for p, q in zip(beside_left, beside_right)]
    return lines, state
