# SPDX-License-Identifier: GPL-3.0-or-later
"""Where several vertices are at one place: at seams, which importers split, and where objects of one character touch. There
the partner of each is the one of the object that its own object is the mirror image of."""

import numpy as np

from . import mesh_data, stored_map
from .regions import components

#: Distance below which vertices are at one place, as a share of the size.
_ONE_PLACE = 1e-6


def welded(mesh):
    """(vertices,) the least vertex with which each is one point: ends of boundary edges in the same place, as the library
    welds them, also where an edit has put faces on these. What an edit has split off stays apart."""
    count = len(mesh.vertices)
    ends = mesh_data.edges(mesh).astype(np.int64)
    faces = np.bincount(mesh_data.edges_of_corners(mesh), minlength=len(ends))
    edit = stored_map.read_edit(mesh)[ends]
    ends = ends[((faces == 1) | (edit > 0).any(axis=1)) & (edit != stored_map.MADE).all(axis=1)]
    used, place = np.unique(ends), np.zeros(count, np.int64)
    points = mesh_data.positions(mesh)[used] + np.float32(0)  # there are two zeros
    place[used] = np.unique(points, axis=0, return_inverse=True)[1].ravel()
    ends = np.take_along_axis(ends, place[ends].argsort(axis=1), axis=1)
    keys = place[ends] @ (count, 1)
    order = np.argsort(keys, kind="stable")
    same = order[np.flatnonzero(np.diff(keys[order]) == 0)[:, None] + (0, 1)]  # (n, 2) edges
    return components(count, ends[same].swapaxes(1, 2).reshape(-1, 2))


def sort_partners(body, owners, core_mesh):
    """Moves partners on the joined object to the vertex at the same place in the right object; `owners`, (vertices,),
    is the number of each vertex's object."""
    partner = mesh_data.read_attribute(body.data.attributes[stored_map.PARTNER]).astype(np.int64)
    points = mesh_data.positions(body.data).astype(float)
    grid = np.round(points / (_ONE_PLACE * np.ptp(points, axis=0).max())).astype(np.int64)
    place = np.unique(grid, axis=0, return_inverse=True)[1].ravel()
    alone, found = np.bincount(place)[place] == 1, partner >= 0
    image = _images(owners, partner, alone & found)
    at = {(place[vertex], owners[vertex]): vertex for vertex in np.flatnonzero(~alone)}
    moved = partner.copy()
    for vertex in np.flatnonzero(found & ~alone[partner] & (owners[partner] != image[owners])):
        moved[vertex] = at.get((place[partner[vertex]], image[owners[vertex]]), partner[vertex])
    if (moved != partner).any():
        stored_map.move_partners(body.data, core_mesh, moved)


def _images(owners, partner, counted):
    """(objects,) number of the object that has most of the partners of each."""
    count = owners.max() + 1
    votes = np.zeros((count, count), int)
    np.add.at(votes, (owners[counted], owners[partner[counted]]), 1)
    return votes.argmax(axis=1)
