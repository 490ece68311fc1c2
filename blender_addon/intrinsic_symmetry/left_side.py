# SPDX-License-Identifier: GPL-3.0-or-later
"""Which side is called left: the one where groups, bones and shape keys lie that are named so; +X where none is."""

import numpy as np
from mathutils.kdtree import KDTree

from . import mesh_data, side_names, stored_map
from .counterparts import balance
from .weights import read_weights

#: What says which side is left, where names do.
_NAMES = "names of"
#: Mean vote of the names from which on they decide.
_CLEAR = 0.1


def left_of(object, side):
    """1 or -1: which of the sides, (vertices,) 1, 0, -1, is left; and what says so, in words."""
    for votes, words in ((_groups, "vertex groups"), (_bones, "bones"), (_keys, "shape keys")):
        found = votes(object, side)
        mean = np.mean([vote for vote in found if vote] or [0])
        if abs(mean) > _CLEAR:
            return (1 if mean > 0 else -1), f"{_NAMES} {words}"
    return _toward_x(mesh_data.positions(object.data), side), stored_map.BY_X


def agreed(operator, object, symmetry):
    """The map with the sides that names say now, unless the user or a file has said them."""
    mesh = object.data
    left_from = mesh[stored_map.RECORD].get("left_from", "")
    if not left_from.startswith((_NAMES, stored_map.BY_X)) or not symmetry.side.any():
        return symmetry
    sign, words = left_of(object, symmetry.side)
    if words == stored_map.BY_X or sign > 0 and words == left_from:
        return symmetry
    stored_map.name_sides(mesh, sign, words)
    if sign > 0:
        return symmetry
    operator.warn(f"Left is now the side that the {words} say")
    return stored_map.load(mesh)


def _groups(object, side):
    return _votes([group.name for group in object.vertex_groups], side, lambda: read_weights(object))


def _keys(object, side):
    keys = object.data.shape_keys
    blocks = keys.key_blocks if keys is not None else []
    return _votes([key.name for key in blocks], side, lambda: mesh_data.key_sizes(object.data))


def _votes(names, side, amounts):
    """One vote, -1..1, of each name; 0 where it has no side."""
    named = np.array([side_names.side(name, names) for name in names])
    return named * balance(amounts(), side) if named.any() else []


def _bones(object, side):
    """Of each bone with a side in its name: the side of the nearest vertex."""
    armature = object.find_armature()
    bones = list(armature.data.bones) if armature else []
    names = [bone.name for bone in bones]
    named = [side_names.side(name, names) for name in names]
    if not any(named):
        return []
    tree = KDTree(len(side))
    for index, point in enumerate(mesh_data.positions(object.data)):
        tree.insert(point, index)
    tree.balance()
    to_object = object.matrix_world.inverted() @ armature.matrix_world
    middles = [to_object @ ((bone.head_local + bone.tail_local) / 2) for bone in bones]
    return [sign * side[tree.find(middle)[1]] for sign, middle in zip(named, middles) if sign]


def _toward_x(positions, side):
    """1 or -1: which of the sides lies more toward +X."""
    if not (np.any(side > 0) and np.any(side < 0)):
        return 1
    return 1 if positions[side > 0, 0].mean() >= positions[side < 0, 0].mean() else -1
