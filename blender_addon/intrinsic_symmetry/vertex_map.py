# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps that are known vertex by vertex, as the library takes them."""

import intrinsym
import numpy as np

#: What stands for none in unsigned numbers.
NONE = 2**32 - 1
#: A mirror image is a vertex if its weight is more than this.
WHOLE = 0.999


def unsigned(numbers):
    return np.where(numbers < 0, NONE, numbers).astype(np.uint32)


def at_vertices(core_mesh, partner):
    """`intrinsym.SurfacePoints` that are the partners themselves, each in the first face that uses it. A partner that
    no face uses is none."""
    offsets, corners = (np.asarray(part).astype(np.int64) for part in core_mesh.polygons)
    first = np.full(core_mesh.vertex_count, -1)
    first[corners[::-1]] = np.arange(len(corners))[::-1]
    place = np.where(partner < 0, -1, first[partner])
    face = np.searchsorted(offsets, np.maximum(place, 0), side="right") - 1
    sizes = offsets[face + 1] - offsets[face]
    around = [corners[offsets[face] + (place - offsets[face] + step) % sizes] for step in range(3)]
    triangles = np.where(place[:, None] < 0, -1, np.stack(around, axis=1))
    weights = np.where(place[:, None] < 0, 0.0, (1.0, 0.0, 0.0))
    return intrinsym.SurfacePoints(unsigned(np.where(place < 0, -1, face)), unsigned(triangles), weights)


def whole(symmetry):
    """(vertices,) bool: those whose images are vertices."""
    return (symmetry.surface_points.barycentrics.max(axis=1) > WHOLE) & (symmetry.partner >= 0)


def pairs(symmetry, point=None):
    """(vertices,) bool: those that are the exact images of their images; or are in the same place, by the (vertices,) `point`
    that each is."""
    partner = symmetry.partner.astype(np.int64)
    point = np.arange(len(partner)) if point is None else point
    return whole(symmetry) & (point[partner[partner]] == point)


def between(source, target, points, kind):
    """An `intrinsym.Symmetry` of two meshes with the same faces as one, source first, that exchanges them: vertex v of
    one has its image on the other at row v of `points`, SurfacePoints of either."""
    count, faces = source.vertex_count, source.face_count
    found = points.faces != NONE
    nearest = points.corners[np.arange(count), points.barycentrics.argmax(axis=1)].astype(np.int64)
    partner = [np.where(found, nearest + shift, -1) for shift in (count, 0)]
    corners = [np.where(found[:, None], points.corners + np.int64(shift), NONE) for shift in (count, 0)]
    holding = [np.where(found, points.faces + np.int64(shift), NONE) for shift in (faces, 0)]
    both = intrinsym.SurfacePoints(
        np.concatenate(holding).astype(np.uint32),
        np.concatenate(corners).astype(np.uint32),
        np.tile(points.barycentrics, (2, 1)),
    )
    has_sides = kind == intrinsym.SymmetryKind.REFLECTION
    side = np.repeat((1, -1), count) * np.tile(found, 2) * has_sides
    return _joined(source, target).restore(kind, np.concatenate(partner), np.tile(found, 2).astype(float), side, both)


def _joined(source, target):
    offsets, corners = (np.asarray(part).astype(np.int64) for part in source.polygons)
    polygons = intrinsym.Polygons(
        np.concatenate([offsets, offsets[1:] + offsets[-1]]), np.concatenate([corners, corners + source.vertex_count])
    )
    return intrinsym.Mesh(np.vstack([source.vertices, target.vertices]), polygons)
