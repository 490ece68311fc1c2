# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertex weights as an array."""

from collections import deque
from itertools import repeat

import numpy as np

#: Smaller weights are taken for none.
SMALLEST = 1e-6
#: How far from 1 a sum of weights may be.
_UNEVEN = 1e-3


def read_weights(object):
    """(vertices, groups) float64; 0 where a vertex is not in a group."""
    weights = np.zeros((len(object.data.vertices), len(object.vertex_groups)), order="F")
    found = np.fromiter(_memberships(object.data), float).reshape(-1, 3)
    vertices, groups = found[:, :2].T.astype(np.intp)
    weights[vertices, groups] = found[:, 2]
    return weights


def _memberships(mesh):
    """Vertex, group, weight, again and again: there is no faster way in Blender's interface than one by one."""
    for number, vertex in enumerate(mesh.vertices):
        for element in vertex.groups:
            yield number
            yield element.group
            yield element.weight


def write_weights(object, before, after):
    """Writes the weights that differ."""
    changed = np.abs(after - before) > SMALLEST
    for group in object.vertex_groups:
        column, vertices = after[:, group.index], np.flatnonzero(changed[:, group.index])
        kept = column[vertices] > SMALLEST
        group.remove(vertices[~kept].tolist())
        stay = vertices[kept]
        deque(map(group.add, zip(stay.tolist()), column[stay].tolist(), repeat("REPLACE")), maxlen=0)


def normalized(object, after, rows, free):
    """Weights whose rows sum to 1 over the groups that deform, and how many rows cannot, since the other groups leave no
    room. Only the `free` columns, (groups,) bool, are scaled."""
    deforming = _deforming(object)
    held = after[rows][:, deforming & ~free].sum(axis=1)
    scaled = after[np.ix_(rows, deforming & free)]
    total = scaled.sum(axis=1)
    factor = np.where(total > SMALLEST, np.maximum(1 - held, 0) / np.maximum(total, SMALLEST), 1)
    after = after.copy()
    after[np.ix_(rows, deforming & free)] = scaled * factor[:, None]
    stuck = (held > SMALLEST) & (np.abs(held + total * factor - 1) > _UNEVEN)
    return after, int(stuck.sum())


def _deforming(object):
    """(groups,) bool: the groups of deforming bones; all, where there is no armature."""
    armature = object.find_armature()
    if armature is None:
        return np.ones(len(object.vertex_groups), bool)
    bones = {bone.name for bone in armature.data.bones if bone.use_deform}
    return np.array([group.name in bones for group in object.vertex_groups])
