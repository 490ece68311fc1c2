# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror vertex groups: Arm.L goes to Arm.R; a group without a side in its name is mirrored in place."""

import bpy
import numpy as np
from intrinsym import Merge

from . import assembly, counterparts, left_side, mesh_data, side_names
from .mirroring import NamedMirrorProperties, blend
from .operator_base import MapOperator
from .weights import SMALLEST, normalized, read_weights, write_weights


class INTRINSIC_SYMMETRY_OT_mirror_vertex_groups(NamedMirrorProperties, MapOperator, bpy.types.Operator):
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
    normalize: bpy.props.BoolProperty(
        name="Normalize",
        description="Scale the mirrored weights of each changed vertex so that those of all bones sum to 1",
        default=False,
    )

    @classmethod
    def is_empty(cls, object):
        return None if object.vertex_groups else "The object has no vertex groups"

    def run_with(self, symmetry, _context, object, mode):
        symmetry = left_side.agreed(self, object, symmetry)
        if not self.all_groups:
            if object.vertex_groups.active is None:
                raise mesh_data.MeshProblem("No vertex group is active: choose one")
            self.let_win(object.vertex_groups.active.name, object.vertex_groups.keys())
        self.shares(symmetry)  # refuses a half turn
        before = read_weights(object)
        there = object.vertex_groups.keys()
        names = self._understood(object, symmetry, before)
        other = self._counterparts(object, names)
        before = np.pad(before, ((0, 0), (0, len(other) - before.shape[1])))
        trust = self.trust(symmetry) * self.may_change(object, mode, symmetry)
        after, free = self._mirrored(object, symmetry, before, other, trust, names)
        idle = _remove_idle(object, len(there), before, after, other)
        before, after, free = (np.delete(array, idle, axis=-1) for array in (before, after, free))
        rows = np.flatnonzero((np.abs(after - before) > SMALLEST).any(axis=1))
        if self.normalize:
            after, stuck = normalized(object, after, rows, free)
            if stuck:
                self.warn(f"On {stuck} vertices the weights do not sum to 1: groups that stay leave no room")
        write_weights(object, before, after)
        object.data.update()
        said = f"{assembly.shown(object, self.members)[rows].sum()} vertices changed"
        return self.with_made(said, there, object.vertex_groups.keys())

    def _chosen(self, object):
        """Names of the groups that are there to mirror."""
        names = [group.name for group in object.vertex_groups]
        if not self.all_groups:
            active = object.vertex_groups.active.name
            names = [name for name in names if name == active or self._other(object, name) == active]
        return names

    def _other(self, object, name):
        return side_names.counterpart(name, object.vertex_groups.keys()) if self.exchange_names else name

    def _understood(self, object, symmetry, weights):
        """The chosen names without those that are left alone, which are told to the user."""
        names = self._chosen(object)
        if not self.exchange_names:
            return names
        every = [group.name for group in object.vertex_groups]
        names = self.without_too_long(names, every)
        misread, filled = counterparts.one_sided(every, weights, symmetry, self.merge)
        central = counterparts.central(every, weights, symmetry.side)
        self.fill([name for name in names if name in filled and not object.vertex_groups[name].lock_weight])
        self.leave([name for name in names if name in misread], "no side in the name, but weights on one side alone")
        self.leave([name for name in names if name in central], "a side in the name, but weights on both")
        return [name for name in names if name not in misread and name not in central]

    def _counterparts(self, object, names):
        """(groups,) index of the group that is the mirror image of each; makes those that are missing."""
        groups, active = object.vertex_groups, object.vertex_groups.active_index
        pairs = [(name, self._other(object, name)) for name in names]
        for _, counterpart in pairs:
            if counterpart not in groups:
                groups.new(name=counterpart)
        groups.active_index = active
        other = np.arange(len(groups))
        for name, counterpart in pairs:
            other[[groups[name].index, groups[counterpart].index]] = groups[counterpart].index, groups[name].index
        return other

    def _mirrored(self, object, symmetry, before, other, trust, names):
        """The weights, and (groups,) bool: those that could change."""
        image = np.asfortranarray(symmetry.mirror_values(before[:, other], Merge.SWAP))
        taken, after = self.with_line(symmetry, trust), before.copy(order="F")
        free = np.zeros(len(other), bool)
        free[[object.vertex_groups[name].index for name in names]] = True
        chosen = np.flatnonzero((free | free[other]) & (other >= np.arange(len(other))))
        free[:] = False
        for group in chosen:
            for column, share in self._shares_of(object, symmetry.side, (group, other[group]), before, trust, taken):
                after[:, column], free[column] = blend(before[:, column], image[:, column], share), True
        free &= self._unlocked(object, before, after, other, free)
        after[:, ~free] = before[:, ~free]
        return after, free

    def _unlocked(self, object, before, after, other, free):
        """(groups,) bool: not locked, nor in an exchange with a locked one. Those that would change are told to the
        user."""
        locked = np.array([group.lock_weight for group in object.vertex_groups])
        alone = locked[other] & ~locked & (self.merge == Merge.SWAP)
        if not (locked | alone).any():
            return ~locked
        would = free & (np.abs(after - before) > SMALLEST).any(axis=0)
        for held, why in ((locked, "locked"), (alone, "exchange with a locked one")):
            self.leave([group.name for group, told in zip(object.vertex_groups, held & would) if told], why)
        return ~(locked | alone)

    def _shares_of(self, object, side, pair, before, trust, taken):
        """The groups of a pair, or the one that is its own image, each with the (vertices,) share of the image that it
        takes; without those that stay. Where one of a pair alone says what it has beyond the middle, the other becomes
        its image everywhere; where one alone has weights, it keeps those on the line."""
        if pair[0] == pair[1]:
            return [(pair[0], taken)]
        try:
            source = counterparts.source_of_groups(before[:, pair], side, self.merge)
        except counterparts.NothingToTake:
            self.leave([object.vertex_groups[int(index)].name for index in pair], "no weights on the side that wins")
            return []
        if source is None:
            return [(group, taken) for group in pair]
        if counterparts.only_filled(before[:, pair], self.merge) is not None:
            return [(pair[source], 0 * trust), (pair[1 - source], trust)]
        on_line = np.where(side == 0, 0.5 * trust, 0)
        return [(pair[source], on_line), (pair[1 - source], np.where(side == 0, on_line, trust))]


def _remove_idle(object, made, before, after, other):
    """Removes the groups, from number `made` on, that nothing of their counterparts arrives in; their numbers."""
    groups, active = object.vertex_groups, object.vertex_groups.active_index
    arrives = (after[:, made:] > SMALLEST).any(axis=0)
    idle = made + np.flatnonzero((before[:, other[made:]] > SMALLEST).any(axis=0) & ~arrives)
    for group in [groups[number] for number in idle[::-1].tolist()]:
        groups.remove(group)
    groups.active_index = active
    return idle


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_mirror_vertex_groups,))
