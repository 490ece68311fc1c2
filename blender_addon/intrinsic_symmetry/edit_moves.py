# SPDX-License-Identifier: GPL-3.0-or-later
"""How far vertices were moved beside an edit of vertices and faces: since the shape was remembered, or else since edit mode
was entered first with the stored map, or else since the map was stored."""

import numpy as np

from . import entered, mesh_data, stored_map, undo
from .neighbour_means import filled

#: A vertex that moved by less than this share of the size has not moved.
_STILL = 1e-6
#: If more than this share of the vertices has moved, that is a pose.
_POSED = 0.5


def since_stored(mesh):
    """(vertices, 3) since edit mode was entered first with the stored map, or the map was stored."""
    were = mesh_data.read_attribute(mesh.attributes[stored_map.PLACE])
    began = entered.began(mesh, undo.number_of(mesh[stored_map.RECORD]))
    if began is not None:
        number = mesh_data.read_attribute(mesh.attributes[stored_map.NUMBERS[0]]).astype(np.int64) - 1
        were = began[np.clip(number, 0, len(began) - 1)]
    return mesh_data.positions(mesh) - were.astype(float)


def before_carry(mesh, known, old):
    """(vertices, 3) of the vertices `known`, (vertices,) bool, whose numbers are those of the stored map, and of the others
    as their neighbours were; the `old` ones are no duplicates."""
    if (remembered := mesh.attributes.get(stored_map.REMEMBERED)) is not None:
        moved = mesh_data.positions(mesh) - mesh_data.read_attribute(remembered).astype(float)
    else:
        moved = since_stored(mesh) + stored_map.read_moved(mesh)
    places = mesh_data.positions(mesh).astype(float)
    moved = filled(np.where(known[:, None], moved, np.nan), mesh_data.edges(mesh).astype(np.int64), places)
    return _of_edit(mesh, np.nan_to_num(moved), old)


def after_carry(mesh):
    """(vertices, 3) with a map that fits; nothing where no edit was carried."""
    if not stored_map.read_edit(mesh).any():
        return np.zeros((len(mesh.vertices), 3))
    return _of_edit(mesh, since_stored(mesh) + stored_map.read_moved(mesh), np.ones(len(mesh.vertices), bool))


def _of_edit(mesh, moved, old):
    moved[np.abs(moved).max(axis=1) <= _STILL * np.ptp(mesh_data.positions(mesh), axis=0).max(initial=0)] = 0
    return 0 * moved if moved[old].any(axis=1).mean() > _POSED else moved
