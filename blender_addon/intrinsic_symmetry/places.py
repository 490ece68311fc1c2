# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices that are at one place, as the copies of a vertex along a seam are, and stay so. No bpy here."""

import numpy as np


class Places:
    """Where vertices are, each place once: `all`, (places, 3), and `of`, (vertices,) the place of each."""

    def __init__(self, positions):
        self.all, number = np.unique(positions, axis=0, return_inverse=True)
        self.of = number.ravel()

    def free(self, may_move):
        """(places,) bool: those whose vertices may all move, by (vertices,) bool."""
        return np.bincount(self.of, ~may_move, len(self.all)) == 0

    def means(self, values):
        """(places, columns) of the values of their vertices."""
        sums = [np.bincount(self.of, column, len(self.all)) for column in values.T]
        return np.stack(sums, axis=1) / np.bincount(self.of)[:, None]

    def moved(self, positions, free):
        """(places, 3) where they go, if the vertices go to the positions: the mean of theirs; those that are not free stay."""
        return np.where(free[:, None], self.means(positions), self.all)


def kept_together(before, after, may_move):
    """(vertices, 3) the positions `after`, but for those that were at one place before: they go to one place, or stay if
    one of them may not move, (vertices,) bool."""
    places = Places(before)
    shared = np.bincount(places.of)[places.of] > 1
    return np.where(shared[:, None], places.moved(after, places.free(may_move))[places.of], after)
