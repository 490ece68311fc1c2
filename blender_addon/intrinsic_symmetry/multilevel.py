# SPDX-License-Identifier: GPL-3.0-or-later
"""Poisson's equation on the graph of a mesh, by conjugate gradients. The preconditioner adds corrections of all scales,
constant in the cells of an octree (J. H. Bramble, J. E. Pasciak, J. Xu, "Parallel Multilevel Preconditioners", 1990),
so that the number of steps hardly grows with the mesh. No bpy here."""

import numpy as np

#: Residual at which it ends, as a share of the first; steps at most.
_ENOUGH, _MOST_STEPS = 1e-4, 1000
#: Cells of the finest level at most, as a share of the points; levels at most.
_FINEST, _MOST_LEVELS = 0.5, 12


class Graph:
    """Points that edges, (edges, 2) and (edges,) weights, hold together, and `hold`, (points,), to where they are.
    Points that are not `free`, (points,) bool, do not move at all."""

    def __init__(self, points, edges, weights, hold, free):
        """Edges between the same points add up. The equation is that of the free points alone."""
        self._ends, self._weights, self._count = edges, weights, len(free)
        self._free = np.flatnonzero(free)
        number = np.full(self._count, -1)
        number[self._free] = np.arange(len(self._free))
        start, end = number[np.concatenate([edges, edges[:, ::-1]])].T
        mine = start >= 0
        start, end, both = start[mine], end[mine], np.concatenate([weights, weights])[mine]
        own = np.arange(len(self._free))  # each row of the matrix has an entry, its diagonal besides
        self._diagonal = np.bincount(start, both, len(own)) + hold[self._free]
        inner = end >= 0
        pairs = np.concatenate([own * self._count + own, start[inner] * self._count + end[inner]])
        pairs, place = np.unique(pairs, return_inverse=True)
        self._row, self._column = np.divmod(pairs, self._count)
        self._matrix = -np.bincount(place.ravel(), np.concatenate([0 * own, both[inner]]), len(pairs))
        self._rows = np.searchsorted(self._row, own)
        self._levels = self._hierarchy(points[self._free]) if len(self._free) else []

    def _hierarchy(self, points):
        """From fine to coarse: the cell of each cell of the level before, and the diagonal of the equation for fields
        that are constant in each cell."""
        levels, start, end = [], self._row, self._column
        matrix, diagonal = self._matrix, self._diagonal
        for cell in _octree(points):
            start, end = cell[start], cell[end]
            inside = start == end
            diagonal = np.bincount(cell, diagonal)
            diagonal += np.bincount(start[inside], matrix[inside], len(diagonal))
            start, end, matrix = start[~inside], end[~inside], matrix[~inside]
            levels.append((cell, np.maximum(diagonal, 1e-12 * diagonal.max())[:, None]))
        return levels

    def moved(self, changes):
        """(points, 3) displacements whose differences along the edges come nearest to (edges, 3) changes, in the
        sense of least squares, while `hold` pulls them to zero."""
        pull, (start, end) = (self._weights[:, None] * changes).T, self._ends.T
        right = [np.bincount(end, each, self._count) - np.bincount(start, each, self._count) for each in pull]
        result = np.zeros((self._count, 3))
        if len(self._free):
            result[self._free] = self._conjugate_gradients(np.stack(right, axis=1)[self._free])
        return result

    def _times(self, field):
        there = self._matrix[:, None] * field.take(self._column, axis=0)
        return self._diagonal[:, None] * field + np.add.reduceat(there, self._rows, axis=0)

    def _preconditioned(self, residual):
        sums, parts = residual, [residual / self._diagonal[:, None]]
        for cell, diagonal in self._levels:
            sums = np.stack([np.bincount(cell, column, len(diagonal)) for column in sums.T], axis=1)
            parts.append(sums / diagonal)
        result = parts.pop()
        for cell, _ in reversed(self._levels):
            result = parts.pop() + result.take(cell, axis=0)
        return result

    def _conjugate_gradients(self, right):
        """Each column by itself."""
        field, residual = np.zeros_like(right), right.copy()
        direction = self._preconditioned(residual)
        product, enough = (residual * direction).sum(axis=0), _ENOUGH * np.linalg.norm(right)
        for step in range(_MOST_STEPS):
            if np.linalg.norm(residual) <= enough:
                break
            image = self._times(direction)
            length = product / np.maximum((direction * image).sum(axis=0), 1e-300)
            field += length * direction
            residual -= length * image
            ahead, before = self._preconditioned(residual), product
            product = (residual * ahead).sum(axis=0)
            direction = ahead + product / np.maximum(before, 1e-300) * direction
        return field


def _octree(points):
    """From fine to coarse: the cell of each point, then that of each cell of the level before."""
    low, size = points.min(axis=0), max(np.ptp(points, axis=0).max(), 1e-300)
    places = np.floor((points - low) / size * 2**_MOST_LEVELS).astype(np.int64)
    for _ in range(_MOST_LEVELS):
        places = places // 2
        distinct, cell = np.unique(places, axis=0, return_inverse=True)
        if len(distinct) <= _FINEST * len(points):
            yield cell.ravel()
            places = distinct
