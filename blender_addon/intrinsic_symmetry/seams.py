# SPDX-License-Identifier: GPL-3.0-or-later
"""Where objects of one character touch, several vertices are at one place: the partner of each is the one of the object
that its own object is the mirror image of."""

import numpy as np

from . import mesh_data, stored_map

#: Distance below which vertices are at one place, as a share of the size.
_ONE_PLACE = 1e-6


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
    for vertex in np.flatnonzero(found & ~alone[partner]):
        moved[vertex] = at.get((place[partner[vertex]], image[owners[vertex]]), partner[vertex])
    if (moved != partner).any():
        stored_map.move_partners(body.data, core_mesh, moved)


def _images(owners, partner, counted):
    """(objects,) number of the object that has most of the partners of each."""
    count = owners.max() + 1
    votes = np.zeros((count, count), int)
    np.add.at(votes, (owners[counted], owners[partner[counted]]), 1)
    return votes.argmax(axis=1)
