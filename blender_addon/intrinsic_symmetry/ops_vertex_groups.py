# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror vertex groups: Arm.L goes to Arm.R; a group without a side in its name is mirrored in place."""

import bpy
import numpy as np
from intrinsym import Merge

from . import side_names
from .mirroring import MirrorProperties, blend
from .operator_base import MapOperator

#: Smaller weights are taken for none.
_SMALLEST = 1e-6


def read_weights(object):
    """(vertices, groups) float64; 0 where a vertex is not in a group."""
    weights = np.zeros((len(object.data.vertices), len(object.vertex_groups)))
    for vertex in object.data.vertices:
        for element in vertex.groups:
            weights[vertex.index, element.group] = element.weight
    return weights


def write_weights(object, before, after):
    """Writes the weights that differ."""
    changed = np.abs(after - before) > _SMALLEST
    for group in object.vertex_groups:
        column = after[:, group.index]
        for vertex in np.flatnonzero(changed[:, group.index]).tolist():
            weight = column[vertex]
            if weight > _SMALLEST:
                group.add((vertex,), weight, "REPLACE")
            else:
                group.remove((vertex,))


def mirrored_weights(symmetry, weights, counterparts, share):
    """(vertices, groups): each vertex takes, in each group, its image's weight in the counterpart of that group."""
    image = symmetry.mirror_values(weights[:, counterparts], Merge.SWAP)
    return blend(weights, image, share)


class INTRINSIC_SYMMETRY_OT_mirror_vertex_groups(MirrorProperties, MapOperator, bpy.types.Operator):
    """Mirror vertex weights across the symmetry, in any pose; locked groups stay as they are"""

    bl_idname = "intrinsic_symmetry.mirror_vertex_groups"
    bl_label = "Mirror Vertex Groups"

    all_groups: bpy.props.BoolProperty(
        name="All Groups", description="Mirror all groups; otherwise the active one and its counterpart", default=True
    )
    exchange_names: bpy.props.BoolProperty(
        name="Exchange L/R Names",
        description="Weights of Arm.L go to Arm.R, which is made if there is none; otherwise each group stays itself",
        default=True,
    )

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if not context.active_object.vertex_groups:
            cls.poll_message_set("The object has no vertex groups")
            return False
        return True

    def run_with(self, symmetry, _context, object, mode):
        share = self.shares(symmetry) * self.may_change(object, mode, symmetry)
        names = self._chosen(object)
        counterparts = self._counterparts(object, names)
        before = read_weights(object)
        after = mirrored_weights(symmetry, before, counterparts, share)
        chosen = {object.vertex_groups[name].index for name in names}
        for group in object.vertex_groups:
            if group.lock_weight or group.index not in chosen:
                after[:, group.index] = before[:, group.index]
        write_weights(object, before, after)
        object.data.update()
        return f"{int((np.abs(after - before) > _SMALLEST).any(axis=1).sum())} vertices changed"

    def _chosen(self, object):
        """Names of the groups to mirror, counterparts included; makes those that are missing."""
        active = object.vertex_groups.active
        names = [group.name for group in object.vertex_groups] if self.all_groups else [active.name]
        if self.exchange_names:
            names += [name for name in map(side_names.flip, names) if name not in names]
        for name in names:
            if name not in object.vertex_groups:
                object.vertex_groups.new(name=name)
        if active is not None:
            object.vertex_groups.active = object.vertex_groups[active.name]
        return names

    def _counterparts(self, object, names):
        """(groups,) index of the group that each takes its weights from."""
        counterparts = np.arange(len(object.vertex_groups))
        if self.exchange_names:
            for name in names:
                other = object.vertex_groups[side_names.flip(name)]
                counterparts[object.vertex_groups[name].index] = other.index
        return counterparts


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_mirror_vertex_groups,))
