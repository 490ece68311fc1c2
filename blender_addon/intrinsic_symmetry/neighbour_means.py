# SPDX-License-Identifier: GPL-3.0-or-later
"""Values between known ones: the mean of each vertex' neighbours, of which nearer ones weigh more; and how far neighbours
are. No bpy here."""

import numpy as np

#: Rounds in which means are taken.
_ROUNDS = 300
#: Two edges are a straight line if the cosine between them is this near to -1.
_STRAIGHT = 1e-4


def filled(values, ends, places, still=1e-6, along_lines=False):
    """(vertices, n) values with NaN replaced, along (edges, 2) ends of vertices at (vertices, 3) places. NaN stays
    where no edges lead to a value. It ends where nothing changes by more than `still`, a share of the largest value.
    `along_lines`: a vertex on a straight line between two neighbours, as on an edge that was cut, has the mean of those
    alone."""
    values = values.copy()
    for column in values.T:
        if np.isnan(column).any():
            _fill(column, ends, places, still, along_lines)
    return values


def longest_edges(ends, places):
    """(vertices,) the length of the longest edge of each, of (edges, 2) ends at (vertices, 3) places."""
    lengths, longest = np.linalg.norm(places[ends[:, 0]] - places[ends[:, 1]], axis=1), np.zeros(len(places))
    for end in (0, 1):
        np.maximum.at(longest, ends[:, end], lengths)
    return longest


def shortest_edges(ends, places):
    """As `longest_edges`; infinite without edges."""
    lengths, shortest = np.linalg.norm(places[ends[:, 0]] - places[ends[:, 1]], axis=1), np.full(len(places), np.inf)
    for end in (0, 1):
        np.minimum.at(shortest, ends[:, end], lengths)
    return shortest


def _fill(column, ends, places, still, along_lines):
    unknown = np.isnan(column)
    to, source = np.vstack([ends, ends[:, ::-1]])[np.append(unknown[ends[:, 0]], unknown[ends[:, 1]])].T
    order = np.argsort(to, kind="stable")
    to, source = to[order], source[order]
    way = places[source] - places[to]
    length = np.linalg.norm(way, axis=1)
    length = np.maximum(length, 1e-6 * length.max(initial=1e-30))
    pull = 1 / length
    if along_lines:
        pair = _lines(to, way / length[:, None], ~unknown[source])
        pull *= (pair[to] == np.arange(len(to))[:, None]).any(axis=1) | (pair[to, 0] < 0)
    rows, row = np.unique(to, return_inverse=True)
    least, is_partial = still * np.abs(column[~unknown]).max(initial=0), True
    for _ in range(_ROUNDS):
        values, before = column[source], column[rows]
        if is_partial:
            missing = np.isnan(values)
            total, is_partial = np.bincount(row, pull * ~missing, len(rows)), missing.any()
            values = np.where(missing, 0, values)
        with np.errstate(invalid="ignore"):
            column[rows] = mean = np.bincount(row, pull * values, len(rows)) / total  # 0 / 0 is not known yet
        if np.array_equal(np.isnan(before), np.isnan(mean)) and np.nanmax(np.abs(mean - before), initial=0) <= least:
            break
    swings = ~np.isnan(before)  # on a mesh of quads means may swing between two values: take the middle
    column[rows[swings]] = (before + mean)[swings] / 2


def between(ends, places, known):
    """(vertices,) bool: those on a straight line between two neighbours that are known, (vertices,) bool."""
    links = np.vstack([ends, ends[:, ::-1]])
    links = links[known[links[:, 1]]]
    to, source = links[np.argsort(links[:, 0], kind="stable")].T
    way = places[source] - places[to]
    pair = _lines(to, way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-30), np.ones(len(to)))
    found = np.zeros(len(places), bool)
    found[to] = pair[to, 0] >= 0
    return found


def _lines(to, ways, known):
    """Of each vertex the two links, sorted by `to`, that make a straight line, -1 for none; of several
    those to known values."""
    best, pair = np.zeros(to.max(initial=-1) + 1), np.full((to.max(initial=-1) + 1, 2), -1)
    for step in range(1, np.bincount(to).max(initial=1)):
        rows = np.flatnonzero(to[:-step] == to[step:])
        bend = 1 + np.einsum("rx,rx->r", ways[rows], ways[rows + step])
        score = 1.0 + known[rows] + known[rows + step] - bend
        fits = (bend < _STRAIGHT) & (score > best[to[rows]])
        rows, score = rows[fits], score[fits]
        order = np.argsort(score, kind="stable")  # the last one of a vertex is kept
        rows, score = rows[order], score[order]
        best[to[rows]], pair[to[rows]] = score, np.stack([rows, rows + step], axis=1)
    return pair
