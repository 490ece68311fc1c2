# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions that are moved as rigid pieces to where what surrounds them is (B. K. P. Horn, "Closed-form solution of absolute
orientation using orthonormal matrices", 1988), and bent to meet it."""

import numpy as np

from .neighbour_means import filled
from .regions import parts

#: Rings of vertices around a region that it is fitted to.
_AROUND = 2
#: What is around a region has one rigid motion if none of it is off by more than this share of its size.
_ONE = 1e-3


def moved(places, models, inside, fitted, ends, *, sign, still=1e-6, along_lines=False):
    """(vertices, 3) places, of which those `inside`, (vertices,) bool, get the form of the models, (vertices, 3), with
    the orientation of the `sign`: 1, or -1 for mirrored. Only `fitted` ones, (vertices,) bool, say where; the others say
    nothing. Inner ones stay where nothing is around them."""
    near = grown(inside, ends, _AROUND) & (fitted | inside)
    mine = ends[near[ends].all(axis=1)]
    there = places.copy()
    for piece in parts(near, ends):
        border = piece[~inside[piece]]
        if len(border) > 2:
            there[piece] = brought(models[border], places[border], models[piece], sign)
        elif np.isnan(places[piece]).any():
            there[piece] = 0
    missing = np.where(inside[:, None], np.nan, places - there)
    missing[~near] = 0
    bent = there + filled(missing, mine, models, still, along_lines)
    return np.where(inside[:, None] & ~np.isnan(bent), bent, places)


def exact(places, models, inside, fitted, ends, *, sign):
    """As `moved`, but only of the regions around which all that is fitted has one rigid motion, and without bending; and
    (vertices,) bool, which ones these are."""
    near = grown(inside, ends, _AROUND) & (fitted | inside)
    there, found = places.copy(), np.zeros(len(places), bool)
    for piece in parts(near, ends):
        border, own = piece[~inside[piece]], piece[inside[piece]]
        if len(border) > 2 and len(own):
            both = brought(models[border], places[border], models[np.append(border, own)], sign)
            off = np.linalg.norm(both[: len(border)] - places[border], axis=1).max()
            if off <= _ONE * np.ptp(places[border], axis=0).max():
                there[own], found[own] = both[len(border) :], True
    return there, found


def beside(shell, places, models, surface, fitted, ends, *, sign):
    """Places of the vertices `shell` of a connected component, moved by the one rigid motion that brings those that are
    `fitted`, (vertices,) bool, and nearest to it on the `surface` of the models, to their places. It stays where there are
    none."""
    near = np.zeros(len(places), bool)
    near[surface.vertex_mix(models[shell]).rows] = True
    near = grown(near, ends, 1) & fitted
    if np.count_nonzero(near) < 3:
        return places[shell]
    return brought(models[near], places[near], models[shell], sign)


def grown(inside, ends, rings):
    """(vertices,) bool: those inside, and some rings around them, along (edges, 2) ends."""
    inside = inside.copy()
    for _ in range(rings):
        inside[ends[inside[ends].any(axis=1)]] = True
    return inside


def brought(points, places, others, sign):
    """Other points, as the rotation, or the reflection and rotation, moves them that brings points, (n, 3), nearest to
    places."""
    middle, centre = points.mean(axis=0), places.mean(axis=0)
    left, _, right = np.linalg.svd((points - middle).T @ (places - centre))
    right[-1] *= sign * np.sign(np.linalg.det(left @ right))
    return (others - middle) @ (left @ right) + centre
