# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of new vertices where both sides got the same edit: faces are compared across edges whose ends are paired. No
bpy here."""

import numpy as np


def pairs(offsets, corners, partner, new, may_pair):
    """{vertex: its partner} of new vertices, (vertices,) bool, in faces of (faces + 1,) offsets and (n,) corners;
    `partner`, (vertices,), is that of the others, -1 without. `may_pair` says of two whether it is possible."""
    known = np.where(new, -1, partner).tolist()
    across = _across(offsets, corners, new)
    at = {}
    for edge in across:
        for vertex in edge:
            at.setdefault(vertex, []).append(edge)
    found, waiting = {}, list(across)
    while waiting:
        start, end = waiting.pop()
        image = across.get((known[end], known[start]))
        for one, other in _matched(across[start, end], image, start, known, new, may_pair) if image else ():
            for vertex, twin in ((one, other), (other, one)):
                known[vertex] = found[vertex] = twin
                waiting += at[vertex]
    return found


def _across(offsets, corners, new):
    """{(start, end): corners of the face}, of all faces that touch new vertices."""
    touched = np.flatnonzero(np.logical_or.reduceat(new[corners], offsets[:-1])) if len(corners) else []
    faces = [corners[offsets[face] : offsets[face + 1]].tolist() for face in touched]
    return {edge: face for face in faces for edge in zip(face, face[1:] + face[:1])}


def _matched(face, image, start, known, new, may_pair):
    """Pairs that are not known yet, if the face is the mirror image of the other one; from `start` one goes forward,
    the other back."""
    size, first, second = len(face), face.index(start), image.index(known[start])
    both = [(face[(first + step) % size], image[(second - step) % len(image)]) for step in range(size)]
    fits = size == len(image) and all(
        known[one] == other if not new[one] else new[other] and known[one] in (-1, other) and known[other] in (-1, one)
        for one, other in both
    )
    added = [pair for pair in both if known[pair[0]] < 0] if fits else []
    return added if all(may_pair(*pair) for pair in added) else []
