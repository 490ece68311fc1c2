# SPDX-License-Identifier: GPL-3.0-or-later
"""Which faces have mirror images. No bpy here."""

import numpy as np

from .regions import mirrored


def without_images(faces, twin):
    """Numbers of those faces, lists of corners, whose mirror images are not among them; a vertex has a `twin` by its
    number, -1 for none."""
    there = {turned(face) for face in faces}
    images = ([twin[corner] for corner in reversed(face)] for face in faces)
    return [number for number, image in enumerate(images) if min(image) < 0 or turned(image) not in there]


def lone(offsets, corners, twin):
    """Lists of corners of the faces without mirror images, of (faces + 1,) offsets, (n,) corners, and (vertices,) twins; and
    (vertices,) bool, such that each of these faces has one of them."""
    apart = ~mirrored(offsets, corners, twin)
    rows = np.flatnonzero(np.logical_or.reduceat(apart[corners], offsets[:-1]))
    faces = [corners[offsets[row] : offsets[row + 1]].tolist() for row in rows]
    return [faces[number] for number in without_images(faces, twin.tolist())], apart


def turned(corners):
    """The corners of a face, from the least one on."""
    start = corners.index(min(corners))
    return tuple(corners[start:] + corners[:start])
