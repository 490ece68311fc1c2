# SPDX-License-Identifier: GPL-3.0-or-later
"""Values between known ones: each vertex has the mean of its neighbours, of which nearer ones weigh more. No bpy here."""

import numpy as np

#: Rounds in which means are taken, and a change that ends them, as a share of the largest value.
_ROUNDS, _STILL = 300, 1e-6


def filled(values, ends, places):
    """(vertices, n) values with NaN replaced, along (edges, 2) ends of vertices at (vertices, 3) places. NaN stays where no
    edges lead to a value."""
    values = values.copy()
    for column in values.T:
        unknown = np.isnan(column)
        if unknown.any():
            _fill(column, unknown, ends, places)
    return values


def _fill(column, unknown, ends, places):
    to, source = np.vstack([ends, ends[:, ::-1]])[np.append(unknown[ends[:, 0]], unknown[ends[:, 1]])].T
    length = np.linalg.norm(places[to] - places[source], axis=1)
    pull = 1 / np.maximum(length, 1e-6 * length.max(initial=1e-30))
    rows, row = np.unique(to, return_inverse=True)
    least = _STILL * np.abs(column[~unknown]).max(initial=0)
    for _ in range(_ROUNDS):
        there = ~np.isnan(column[source])
        total = np.bincount(row, pull * there, len(rows))
        mean = np.bincount(row, pull * np.where(there, column[source], 0), len(rows))
        mean = np.where(total > 0, mean / np.maximum(total, 1e-30), np.nan)
        before = column[rows]
        column[rows] = mean
        reached = np.isnan(before) & ~np.isnan(mean)
        if not reached.any() and np.nanmax(np.abs(mean - before), initial=0) <= least:
            break
