# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertex weights as an array."""

import numpy as np

#: Smaller weights are taken for none.
SMALLEST = 1e-6


def read_weights(object):
    """(vertices, groups) float64; 0 where a vertex is not in a group."""
    weights = np.zeros((len(object.data.vertices), len(object.vertex_groups)))
    for vertex in object.data.vertices:
        for element in vertex.groups:
            weights[vertex.index, element.group] = element.weight
    return weights


def write_weights(object, before, after):
    """Writes the weights that differ."""
    changed = np.abs(after - before) > SMALLEST
    for group in object.vertex_groups:
        column = after[:, group.index]
        for vertex in np.flatnonzero(changed[:, group.index]).tolist():
            weight = column[vertex]
            if weight > SMALLEST:
                group.add((vertex,), weight, "REPLACE")
            else:
                group.remove((vertex,))


def normalized(object, after, rows, free):
    """Weights whose rows sum to 1 over the groups that deform; only the `free` columns, (groups,) bool, are scaled."""
    deforming = _deforming(object)
    held = after[rows][:, deforming & ~free].sum(axis=1)
    scaled = after[np.ix_(rows, deforming & free)]
    total = scaled.sum(axis=1)
    factor = np.where(total > SMALLEST, np.maximum(1 - held, 0) / np.maximum(total, SMALLEST), 1)
    after = after.copy()
    after[np.ix_(rows, deforming & free)] = scaled * factor[:, None]
    return after


def _deforming(object):
    """(groups,) bool: the groups of deforming bones; all, where there is no armature."""
    armature = object.find_armature()
    if armature is None:
        return np.ones(len(object.vertex_groups), bool)
    bones = {bone.name for bone in armature.data.bones if bone.use_deform}
    return np.array([group.name in bones for group in object.vertex_groups])
