# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices that are at one place, as the copies of a vertex along a seam are, and stay so. No bpy here."""

import numpy as np

from .regions import components

#: Vertices nearer than this share of the extent are at one place: single precision keeps no more apart.
_NEAR = 1e-6
#: A direction that no mesh lies across by intent.
_ACROSS = np.array([0.5377, 0.6180, 0.5736])


class Places:
    """Where vertices are, each place once: `all`, (places, 3), and `of`, (vertices,) the place of each. Chains of `pairs`, (n, 2)
    vertices that are near each other, are at one place."""

    def __init__(self, positions):
        self._near = _NEAR * (np.ptp(positions, axis=0).max() if len(positions) else 0)
        self.pairs = _near_pairs(positions.astype(float), self._near)
        first, number = np.unique(components(len(positions), self.pairs), return_inverse=True)
        self.all, self.of = positions[first], number.ravel()

    def shared(self):
        """(vertices,) bool: those at a place with others."""
        return (np.bincount(self.of) > 1)[self.of]

    def alike(self, moves, pairs):
        """(pairs,) bool: whether those of (n, 2) vertices go to one place if they were at one, by (vertices, 3) moves."""
        return np.linalg.norm(moves[pairs[:, 0]] - moves[pairs[:, 1]], axis=1) <= self._near

    def free(self, may_move):
        """(places,) bool: those whose vertices may all move, by (vertices,) bool."""
        return np.bincount(self.of, ~may_move, len(self.all)) == 0

    def moved(self, positions, free):
        """(places, 3) where they go, if the vertices go to the positions: the mean of theirs; those that are not free stay."""
        return np.where(free[:, None], means(self.of, positions), self.all)


def means(of, values):
    """(groups, columns) of the values of the rows of each group, by (rows,) the group of each."""
    return np.stack([np.bincount(of, column) for column in values.T], axis=1) / np.bincount(of)[:, None]


def gathered(values, pairs):
    """(rows, columns) the values, but of rows that pairs, (n, 2), join their mean."""
    rows = np.unique(pairs)
    group = np.unique(components(len(values), pairs)[rows], return_inverse=True)[1].ravel()
    values[rows] = means(group, values[rows])[group]
    return values


def kept_together(before, after, may_move):
    """(vertices, 3) the positions `after`, but for those that were at one place before: they go to one place, or stay if
    one of them may not move, (vertices,) bool."""
    places = Places(before)
    free = places.free(may_move)[places.of]
    together = np.where(free[:, None], means(places.of, after)[places.of], before)
    return np.where(places.shared()[:, None], together, after)


def _near_pairs(positions, distance):
    """(pairs, 2) vertices with no more than the distance between them. In the order along a direction, each is compared with
    those that follow within that distance."""
    along = positions @ _ACROSS
    order = np.argsort(along, kind="stable")
    along, pairs = along[order], [np.empty((0, 2), int)]
    for step in range(1, len(order)):
        close = np.flatnonzero(along[step:] - along[:-step] <= distance)
        if not len(close):
            break
        ends = np.stack([order[close], order[close + step]], axis=1)
        pairs.append(ends[np.linalg.norm(positions[ends[:, 0]] - positions[ends[:, 1]], axis=1) <= distance])
    return np.concatenate(pairs)
