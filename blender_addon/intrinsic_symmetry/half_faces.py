# SPDX-License-Identifier: GPL-3.0-or-later
"""Which faces have mirror images. No bpy here."""

import numpy as np

from .regions import components, mirrored


def without_images(faces, twin, point):
    """Numbers of those faces, lists of corners, whose mirror images are not among them; a vertex has a `twin` by its
    number, -1 for none, and a `point`, which it shares with others where the mesh is split."""
    paired = [number for number, face in enumerate(faces) if min(twin[corner] for corner in face) >= 0]
    there = {turned([point[corner] for corner in faces[number]]) for number in paired}
    images = {number: [point[twin[corner]] for corner in reversed(faces[number])] for number in paired}
    found = {number for number in paired if turned(images[number]) in there}
    found |= {number for number in paired if all(twin[corner] == corner for corner in faces[number])}
    return [number for number in range(len(faces)) if number not in found]


def lone(offsets, corners, twin, point, touched):
    """Lists of corners of the faces without mirror images, of (faces + 1,) offsets, (n,) corners, and (vertices,) twins and
    points; and (vertices,) bool, such that each of these faces has one of them, and so have the images of others there. Faces
    that share points, or the twins of these, belong together: only those are meant that belong to `touched` vertices,
    (vertices,) bool."""
    apart = ~mirrored(offsets, corners, twin)
    rows = np.flatnonzero(np.logical_or.reduceat(apart[corners], offsets[:-1]))
    faces = [corners[offsets[row] : offsets[row + 1]].tolist() for row in rows]
    faces = [faces[number] for number in without_images(faces, twin.tolist(), point.tolist())]
    ends = [(face[0], corner) for face in faces for corner in face]
    ends += [(corner, point[corner]) for _, corner in ends]
    ends += [(corner, twin[corner]) for _, corner in ends if twin[corner] >= 0]
    group = components(len(twin), np.array(ends, np.int64).reshape(-1, 2))
    meant = np.isin(group, group[touched])
    apart, near = apart & meant, np.zeros(len(twin), bool)
    near[point[apart]] = near[point[twin[apart & (twin >= 0)]]] = True
    return [face for face in faces if meant[face[0]]], near[point]


def turned(corners):
    """The corners of a face, from the least one on."""
    start = corners.index(min(corners))
    return tuple(corners[start:] + corners[:start])
