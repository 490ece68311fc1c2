# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices that are at one place, as the copies of a vertex along a seam are, and stay so. No bpy here."""

import numpy as np

#: Vertices nearer than this share of the extent are at one place: single precision keeps no more apart.
_NEAR = 1e-6
#: A direction that no mesh lies across by intent.
_ACROSS = np.array([0.5377, 0.6180, 0.5736])


class Places:
    """Where vertices are, each place once: `all`, (places, 3), and `of`, (vertices,) the place of each."""

    def __init__(self, positions):
        extent = np.ptp(positions, axis=0).max() if len(positions) else 0
        first, number = np.unique(_first_near(positions.astype(float), _NEAR * extent), return_inverse=True)
        self.all, self.of = positions[first], number.ravel()

    def shared(self):
        """(vertices,) bool: those at a place with others."""
        return (np.bincount(self.of) > 1)[self.of]

    def free(self, may_move):
        """(places,) bool: those whose vertices may all move, by (vertices,) bool."""
        return np.bincount(self.of, ~may_move, len(self.all)) == 0

    def moved(self, positions, free):
        """(places, 3) where they go, if the vertices go to the positions: the mean of theirs; those that are not free stay."""
        return np.where(free[:, None], means(self.of, positions), self.all)


def means(of, values):
    """(groups, columns) of the values of the rows of each group, by (rows,) the group of each."""
    return np.stack([np.bincount(of, column) for column in values.T], axis=1) / np.bincount(of)[:, None]


def kept_together(before, after, may_move):
    """(vertices, 3) the positions `after`, but for those that were at one place before: they go to one place, or stay if
    one of them may not move, (vertices,) bool."""
    places = Places(before)
    free = places.free(may_move)[places.of]
    together = np.where(free[:, None], means(places.of, after)[places.of], before)
    return np.where(places.shared()[:, None], together, after)


def _first_near(positions, distance):
    """(vertices,) the first of those that chains of steps of at most the distance join to each. In the order along a direction, each is
    compared with those that follow within that distance."""
    along = positions @ _ACROSS
    order = np.argsort(along, kind="stable")
    along, pairs = along[order], []
    for step in range(1, len(order)):
        close = np.flatnonzero(along[step:] - along[:-step] <= distance)
        if not len(close):
            break
        ends = np.stack([order[close], order[close + step]])
        pairs.append(ends[:, np.linalg.norm(positions[ends[0]] - positions[ends[1]], axis=1) <= distance])
    first = np.arange(len(order))
    one, other = np.concatenate(pairs, axis=1) if pairs else np.empty((2, 0), int)
    while (first[one] != first[other]).any():
        least = np.minimum(first[one], first[other])
        np.minimum.at(first, one, least)
        np.minimum.at(first, other, least)
    return first
