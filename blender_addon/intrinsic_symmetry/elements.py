# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror images of edges, faces and face corners, from those of their vertices."""

import numpy as np

from . import mesh_data, seams


def _by_vertices(mesh, partner, find):
    """What `find` answers for the numbers of the vertices and of their partners; where that is -1, for those of their points:
    what is split on one side alone is one point on both."""
    found = find(np.arange(len(partner)), partner)
    if (found >= 0).all():
        return found
    point = seams.welded(mesh)
    if (point == np.arange(len(point))).all():
        return found
    return np.where(found < 0, find(point, np.where(partner < 0, -1, point[partner])), found)


def edge_partners(mesh, partner):
    """(edges,) the edge between the partners of each edge's ends; -1 where that is no edge of the mesh."""
    ends = mesh_data.edges(mesh).astype(np.int64)
    if not len(ends):
        return np.zeros(0, np.int64)

    def find(number, images):
        return _rows(*(np.sort(each[ends], axis=1).astype(np.int64) @ (len(partner), 1) for each in (number, images)))

    return _by_vertices(mesh, partner, find)


def _rows(keys, wanted):
    """The row of each wanted one among the keys, the first of equal ones, -1 where it is none."""
    order = np.argsort(keys, kind="stable")
    place = order[np.clip(np.searchsorted(keys, wanted, sorter=order), 0, len(keys) - 1)]
    return np.where(keys[place] == wanted, place, -1)


def exact_face_partners(mesh, partner):
    """(faces,) the face of the partners of each face's vertices; -1 where that is no face of the mesh."""
    offsets, corners = mesh_data.polygons(mesh)
    if not len(corners):
        return np.zeros(0, np.int64)

    def find(number, images):
        own, wanted = (map(frozenset, map(np.ndarray.tolist, np.split(each[corners], offsets[1:-1]))) for each in (number, images))
        at = {key: face for face, key in enumerate(own)}
        return np.fromiter((at.get(key, -1) for key in wanted), np.int64, len(offsets) - 1)

    return _by_vertices(mesh, partner, find)


def face_partners(mesh, symmetry):
    """(faces,) the face of the partners, or else the one that holds most of the exact images of its vertices."""
    exact = exact_face_partners(mesh, symmetry.partner)
    offsets, corners = mesh_data.polygons(mesh)
    images = symmetry.surface_points.faces.astype(np.int64)
    images[images == 2**32 - 1] = -1
    for face in np.flatnonzero(exact < 0):
        faces, counts = np.unique(images[corners[offsets[face] : offsets[face + 1]]], return_counts=True)
        exact[face] = faces[counts.argmax()]
    return exact


def corner_partners(mesh, partner, faces):
    """(corners,) the corner at the partner of each corner's vertex in the partner of its face, of `face_partners`;
    -1 where that face has no such corner."""
    offsets, corners = mesh_data.polygons(mesh)
    images_in = np.repeat(faces, np.diff(offsets))

    def find(number, images):
        return corners_at(mesh, images_in, images[corners].astype(np.int64), number)

    return _by_vertices(mesh, partner, find)


def corners_at(mesh, faces, vertices, number=None):
    """The corner of each face at each vertex, or at that of its `number`; -1 where there is none, or face or vertex are below 0."""
    offsets, corners = mesh_data.polygons(mesh)
    face_of, count = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets)), len(mesh.vertices)
    at = corners if number is None else number[corners]
    return np.where(vertices >= 0, _rows(face_of * count + at, faces * count + vertices), -1)


def barycentric(points, triangles):
    """(n, 3) weights of the corners of (n, 3, 3) triangles at the points' feet in their planes."""
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(first, second)
    area = np.maximum(np.einsum("nx,nx->n", normal, normal), 1e-30)
    away = points - triangles[:, 0]
    one = np.einsum("nx,nx->n", np.cross(away, second), normal) / area
    two = np.einsum("nx,nx->n", np.cross(first, away), normal) / area
    return np.stack([1 - one - two, one, two], axis=1)
