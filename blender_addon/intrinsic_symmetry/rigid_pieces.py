# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions that are moved as rigid pieces to where what surrounds them is (B. K. P. Horn, "Closed-form solution of absolute
orientation using orthonormal matrices", 1988), and bent to meet it."""

import numpy as np

from .neighbour_means import filled
from .regions import components

#: Rings of vertices around a region that it is fitted to.
_AROUND = 2


def moved(places, models, inside, fitted, ends, *, sign, still=1e-6, along_lines=False):
    """(vertices, 3) places, of which those `inside`, (vertices,) bool, get the form of the models, (vertices, 3), with
    the orientation of the `sign`: 1, or -1 for mirrored. Only `fitted` ones, (vertices,) bool, say where; the others say
    nothing. Inner ones stay where nothing is around them."""
    near = grown(inside, ends, _AROUND) & (fitted | inside)
    mine = ends[near[ends].all(axis=1)]
    region, rows = components(len(places), mine), np.flatnonzero(near)
    order = rows[np.argsort(region[rows], kind="stable")]
    there = places.copy()
    for piece in np.split(order, np.flatnonzero(np.diff(region[order])) + 1):
        border = piece[~inside[piece]]
        if len(border) > 2:
            there[piece] = _brought(models[border], places[border], models[piece], sign)
        elif np.isnan(places[piece]).any():
            there[piece] = 0
    missing = np.where(inside[:, None], np.nan, places - there)
    missing[~near] = 0
    bent = there + filled(missing, mine, models, still, along_lines)
    return np.where(inside[:, None] & ~np.isnan(bent), bent, places)


def grown(inside, ends, rings):
    """(vertices,) bool: those inside, and some rings around them, along (edges, 2) ends."""
    inside = inside.copy()
    for _ in range(rings):
        inside[ends[inside[ends].any(axis=1)]] = True
    return inside


def _brought(points, places, others, sign):
    """Other points, as the rotation, or the reflection and rotation, moves them that brings points, (n, 3), nearest to
    places."""
    middle, centre = points.mean(axis=0), places.mean(axis=0)
    left, _, right = np.linalg.svd((points - middle).T @ (places - centre))
    right[-1] *= sign * np.sign(np.linalg.det(left @ right))
    return (others - middle) @ (left @ right) + centre
