# SPDX-License-Identifier: GPL-3.0-or-later
"""What is connected: vertices by edges, vertices by faces, faces by their UVs. No bpy here."""

import numpy as np

#: UVs that are nearer than this are at one place.
SAME_UV = 1e-5
#: Blender keeps whole numbers up to this exact, even where it mixes a vertex with itself.
_EXACT = 2**24 - 1


def components(count, pairs):
    """(count,) the least number that is connected with each, by (n, 2) pairs."""
    least = np.arange(count)
    while True:
        both = least[pairs].min(axis=1)
        joined = least.copy()
        for end in (0, 1):
            np.minimum.at(joined, least[pairs[:, end]], both)
        joined = joined[joined]
        if np.array_equal(joined, least):
            return least
        least = joined


def parts(chosen, ends):
    """Numbers of the chosen vertices, (vertices,) bool, of each connected component, by (edges, 2) ends between them."""
    part, rows = components(len(chosen), ends[chosen[ends].all(axis=1)]), np.flatnonzero(chosen)
    order = rows[np.argsort(part[rows], kind="stable")]
    return np.split(order, np.flatnonzero(np.diff(part[order])) + 1) if len(rows) else []


def around(offsets, corners, numbers):
    """(vertices,) a number that says which vertices, by their (vertices,) numbers, come before and after each vertex in
    its faces. Another face, or one that is turned over, makes it another number."""
    after, before = np.arange(1, len(corners) + 1), np.arange(-1, len(corners) - 1)
    after[offsets[1:] - 1], before[offsets[:-1]] = offsets[:-1], offsets[1:] - 1
    sums = np.zeros(len(numbers))
    for other, salt in ((after, 1), (before, 2)):
        sums += np.bincount(corners, _mixed(2 * numbers[corners[other]].astype(np.int64) + salt), len(numbers))
    return sums.astype(np.int64) & _EXACT


def mirrored(offsets, corners, partner):
    """(vertices,) bool: those whose faces are the mirror images of their partners' faces; not where the partner is -1. A face
    whose vertices are all their own partners lies in the line, and is its own mirror image."""
    itself = partner == np.arange(len(partner))
    offsets, corners = _without(np.logical_and.reduceat(itself[corners], offsets[:-1]), offsets, corners)
    face = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    backward = corners[offsets[face] + offsets[face + 1] - 1 - np.arange(len(corners))]
    own, images = around(offsets, corners, np.arange(len(partner))), around(offsets, backward, partner)
    return (partner >= 0) & (images == own[np.maximum(partner, 0)])


def _without(faces, offsets, corners):
    """Offsets and corners of all but those faces, (faces,) bool."""
    sizes = np.diff(offsets)
    return np.append(0, np.cumsum(sizes[~faces])), corners[np.repeat(~faces, sizes)]


def holding(offsets, corners, wanted, chosen):
    """(vertices,) for the chosen ones, (vertices,) bool, a face with all three of the `wanted` corners, (vertices, 3); -1 where
    there is none."""
    count = len(offsets)
    face = np.repeat(np.arange(count - 1), np.diff(offsets))
    keys = np.sort(corners * count + face)  # all faces of a vertex, one after another
    found, rows = np.full(len(chosen), -1), np.flatnonzero(chosen)
    at, end = (np.searchsorted(keys // count, wanted[rows, 0], side) for side in ("left", "right"))
    while len(rows):
        there = at < end
        rows, at, end = rows[there], at[there], end[there]
        held, fits = keys[at] % count, np.ones(len(rows), bool)
        for other in (1, 2):
            sought = wanted[rows, other] * count + held
            fits &= keys[np.minimum(np.searchsorted(keys, sought), len(keys) - 1)] == sought
        found[rows[fits]] = held[fits]
        rows, at, end = rows[~fits], at[~fits] + 1, end[~fits]
    return found


def _mixed(numbers):
    """Each number's bits, thrown together."""
    numbers = (numbers * 0x9E3779B1) & 0xFFFFFFFF
    numbers = ((numbers ^ numbers >> 15) * 0x85EBCA6B) & 0xFFFFFFFF
    return numbers ^ numbers >> 13


def uv_islands(offsets, vertex, uvs):
    """(corners,) number of the UV island: faces are joined where a vertex of both has one place in the UV map."""
    face = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    places = np.column_stack([vertex, np.round(uvs / SAME_UV)]).astype(np.int64)
    point = np.unique(places, axis=0, return_inverse=True)[1].ravel()
    island = np.arange(point.max(initial=-1) + 1)
    while True:
        of_face = np.minimum.reduceat(island[point], offsets[:-1])[face]
        joined = island.copy()
        np.minimum.at(joined, point, of_face)
        joined = joined[joined]
        if np.array_equal(joined, island):
            return island[point]
        island = joined
