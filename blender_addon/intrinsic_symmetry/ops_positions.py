# SPDX-License-Identifier: GPL-3.0-or-later
"""Symmetrize positions across a pose, and mirror the edit since a remembered state."""

import zlib

import bpy
import numpy as np
from intrinsym import Merge

from . import assembly, entered, mesh_data, stored_map
from .asymmetry import reference, size
from .mirroring import DIRECTIONS, MERGE, ConfidenceProperties, MirrorProperties, blend, carried_together
from .operator_base import MapOperator, MeshOperator
from .places import kept_together

#: An edit that counts, as a share of the largest one; how far edits of both sides may differ, as a share of their own.
_STILL, _ALIKE = 1e-3, 0.1


def remembered_name(object):
    """Name of the attribute that belongs to the shape that is being edited."""
    return _name_for(object, object.active_shape_key)


def _name_for(object, key):
    if key is None or key == object.data.shape_keys.reference_key:
        return stored_map.REMEMBERED
    return f"{stored_map.REMEMBERED}_{zlib.crc32(key.name.encode()):08x}"


def _another_is(object):
    """In words, that the shape of another shape key is remembered, or nothing."""
    keys, names = object.data.shape_keys, object.data.attributes.keys()
    if remembered_name(object) in names or not any(map(stored_map.is_remembered, names)):
        return None
    there = [key.name for key in keys.key_blocks if _name_for(object, key) in names] if keys else []
    what = f'The shape key "{there[0]}" is remembered' if there else "A shape key that is gone or has another name now is remembered"
    return f"{what}, and another shape is active: make it active, or Remember Shape again, then edit"


def renew(object, changed):
    """What is remembered becomes the shape of now at the `changed` vertices, (vertices,) bool."""
    keys = object.data.shape_keys
    shapes = {_name_for(object, key): key for key in (keys.key_blocks if keys else [])}
    for name in filter(stored_map.is_remembered, object.data.attributes.keys()):
        key = shapes.get(name)
        now = mesh_data.positions(object.data) if name == stored_map.REMEMBERED or key is None else mesh_data.key_positions(key)
        values = mesh_data.read_attribute(object.data.attributes[name])
        mesh_data.update_attribute(object.data.attributes[name], np.where(changed[:, None], now, values))


def forget(mesh):
    """Removes what is remembered."""
    for name in stored_map.remembered(mesh):
        mesh_data.remove_attribute(mesh, name)


class INTRINSIC_SYMMETRY_OT_symmetrize(MirrorProperties, MapOperator, bpy.types.Operator):
    """Make the shape symmetric and keep its pose: one side takes the other's form, or both the mean"""

    bl_idname = "intrinsic_symmetry.symmetrize"
    bl_label = "Symmetrize Positions"
    on_shown_shape = True

    def run_with(self, symmetry, _context, object, mode):
        positions, free = mesh_data.shown_positions(object), self.may_change(object, mode, symmetry)
        moved = blend(positions, self._symmetric(symmetry, object.data, positions, free), free)
        moved = kept_together(positions, moved, self.with_line(symmetry, self.trust(symmetry) * free) > 0)
        mesh_data.set_shown_positions(object, moved)
        away = np.linalg.norm(moved - positions.astype(float), axis=1)[assembly.shown(object, self.members)]
        return f"Vertices moved by up to {away.max(initial=0) / size(positions):.2%} of the object's size"

    def _symmetric(self, symmetry, mesh, positions, free):
        """An exchange at rest is that of mirrored places, so that another one gives them back; and so it is, whatever the
        direction, where vertices are mirrored already."""
        at = reference("AUTO", symmetry, mesh, positions)
        exact = at.exact(symmetry, positions) | (self.merge == Merge.SWAP and at.plane is not None)
        mirrored = blend(positions.astype(float), at.images(symmetry, positions), self.shares(symmetry)) if exact.any() else 0
        if exact.all():
            return mirrored
        symmetry, how = self.held(mesh, symmetry, free)
        return np.where(exact[:, None], mirrored, symmetry.symmetrize_positions(positions, self.merge, **how))


class INTRINSIC_SYMMETRY_OT_remember(MeshOperator, bpy.types.Operator):
    """Remember the shape as it is, so that what is edited from now on can be mirrored"""

    bl_idname = "intrinsic_symmetry.remember"
    bl_label = "Remember Shape"
    on_shown_shape = True

    def run(self, _context, object, _mode):
        stored_map.refuse_name(object.data, remembered_name(object), "FLOAT_VECTOR")
        stored_map.refuse_groups(object)
        forget(object.data)
        shown = mesh_data.shown_positions(object)
        mesh_data.write_attribute(object.data, remembered_name(object), "FLOAT_VECTOR", shown)
        return "Remembered: edit one side, then Mirror Edit"


class INTRINSIC_SYMMETRY_OT_mirror_edit(ConfidenceProperties, MapOperator, bpy.types.Operator):
    """Mirror what was edited since Remember Shape, or else since edit mode was entered, in any pose. The side that was
    not edited takes the edit, or each loses its own to the side that wins"""

    bl_idname = "intrinsic_symmetry.mirror_edit"
    bl_label = "Mirror Edit"
    on_shown_shape = True

    direction: bpy.props.EnumProperty(
        name="Direction",
        description="Which side's edit is carried to the other",
        items=[("EDITED", "Edited Side", "Of each pair of vertices, the edit of the one that was moved farther")]
        + [entry[:3] for entry in DIRECTIONS],
        default="EDITED",
    )

    @classmethod
    def lacks(cls, context, object):
        problem = super().lacks(context, object)
        problem = problem or _another_is(object)
        began = object.mode == "EDIT" or entered.shape_of(object) is not None or entered.is_lost(object)
        if problem is None and not began and remembered_name(object) not in object.data.attributes:
            problem = "Remember Shape first, then edit"
        return problem

    def execute(self, context):
        self._edited = {}  # of each object that was worked on
        done = super().execute(context)
        for object, edited in self._edited.items():
            entered.restart(object, edited)
        return done

    def run_with(self, symmetry, _context, object, mode):
        before = self._remembered(object)
        edit = mesh_data.shown_positions(object).astype(float) - before
        merge = MERGE.get(self.direction, Merge.SWAP)
        carried = carried_together(symmetry, before, edit, merge, **self.how())
        if self.direction == "EDITED":
            farther = np.linalg.norm(carried, axis=1) > np.linalg.norm(edit, axis=1)
            self._say_what_was_replaced(symmetry.side, edit, carried, farther)
            carried = np.where(farther[:, None], carried, edit)
        carried = blend(edit, carried, self.may_change(object, mode, symmetry))
        after = before + carried
        now = {member: mesh_data.shown_positions(member) for member in self.members}
        mesh_data.set_shown_positions(object, after)
        if remembered_name(object) in object.data.attributes:
            mesh_data.update_attribute(object.data.attributes[remembered_name(object)], after)
        self._edited.update(now)
        changed = np.abs(carried - edit).max(axis=1) > 1e-7 * np.abs(before).max()
        changed &= assembly.shown(object, self.members)
        return f"{int(changed.sum())} vertices moved; the new shape is remembered"

    def _say_what_was_replaced(self, side, edit, carried, farther):
        """Where both sides were edited, and not alike, which of them won."""
        size, differs = np.linalg.norm(edit, axis=1), np.linalg.norm(carried - edit, axis=1)
        replaced = farther & (size > _STILL * size.max()) & (differs > _ALIKE * size)
        left, right = (np.count_nonzero(replaced & (side == losing)) for losing in (-1, 1))
        if left or right:
            won = f"the left one on {left} vertices, the right one on {right}"
            self.warn(f"Both sides were edited: the farther edit won, {won}")

    def _remembered(self, object):
        names, wanted = object.data.attributes.keys(), remembered_name(object)
        if wanted in names:
            return mesh_data.read_attribute(object.data.attributes[wanted]).astype(float)
        if another := _another_is(object):
            raise mesh_data.MeshProblem(another)
        key, members = object.active_shape_key, self.members
        if any(map(entered.is_lost, members)):
            raise mesh_data.MeshProblem("Vertices were added or removed in edit mode: Mirror This Edit (Symmetrize "
                                        "Topology) does that. What is moved from now on can be mirrored")
        shapes = {number: entered.shape_of(member, key) for number, member in enumerate(members)}
        shapes = {number: shape for number, shape in shapes.items() if shape is not None}
        if all(np.array_equal(shape, mesh_data.shown_positions(members[number])) for number, shape in shapes.items()):
            raise mesh_data.MeshProblem("Nothing is remembered or edited in this mode: Remember Shape first, then edit")
        return assembly.of_members(object, members, shapes) if len(members) > 1 else shapes[0].astype(float)


register, unregister = bpy.utils.register_classes_factory(
    (
        INTRINSIC_SYMMETRY_OT_symmetrize,
        INTRINSIC_SYMMETRY_OT_remember,
        INTRINSIC_SYMMETRY_OT_mirror_edit,
    )
)
