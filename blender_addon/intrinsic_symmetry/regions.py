# SPDX-License-Identifier: GPL-3.0-or-later
"""What is connected: vertices by edges, faces by their UVs. No bpy here."""

import numpy as np

#: UVs that are nearer than this are at one place.
SAME_UV = 1e-5


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
