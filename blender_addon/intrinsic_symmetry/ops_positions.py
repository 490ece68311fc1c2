# SPDX-License-Identifier: GPL-3.0-or-later
"""Symmetrize positions across a pose, and mirror the edit since a remembered state."""

import bpy
import numpy as np
from intrinsym import Merge

from . import mesh_data, stored_map
from .mirroring import DIRECTIONS, MERGE, ConfidenceProperties, MirrorProperties
from .operator_base import MapOperator, MeshOperator

#: POINT attribute, FLOAT_VECTOR: positions of the shape that is being edited, when they were remembered.
REMEMBERED = "sym_remembered"


class INTRINSIC_SYMMETRY_OT_symmetrize(MirrorProperties, MapOperator, bpy.types.Operator):
    """Make the shape symmetric and keep its pose: one side takes the other's form, or both the mean"""

    bl_idname = "intrinsic_symmetry.symmetrize"
    bl_label = "Symmetrize Positions"

    def run_with(self, symmetry, _context, object, mode):
        positions, how = mesh_data.shown_positions(object), self.how()
        inside = self.may_change(object, mode, symmetry)
        if not inside.all():  # what stays holds the border, so that no step appears there
            symmetry = stored_map.load(object.data, only=inside)
            how["minimum_confidence"] = max(how["minimum_confidence"], stored_map.LEAST)
        moved = symmetry.symmetrize_positions(positions, self.merge, **how)
        moved[~inside] = positions[~inside]
        mesh_data.set_shown_positions(object, moved)
        size = np.linalg.norm(positions.max(axis=0) - positions.min(axis=0))
        farthest = np.linalg.norm(moved - positions, axis=1).max()
        return f"Vertices moved by up to {farthest / size:.2%} of the object's size"


class INTRINSIC_SYMMETRY_OT_remember(MeshOperator, bpy.types.Operator):
    """Remember the shape as it is, so that what is edited from now on can be mirrored"""

    bl_idname = "intrinsic_symmetry.remember"
    bl_label = "Remember Shape"

    def run(self, _context, object, _mode):
        mesh_data.write_attribute(object.data, REMEMBERED, "FLOAT_VECTOR", mesh_data.shown_positions(object))
        return "Remembered: edit one side, then Mirror Edit"


class INTRINSIC_SYMMETRY_OT_mirror_edit(ConfidenceProperties, MapOperator, bpy.types.Operator):
    """Mirror what was edited since Remember Shape, in any pose"""

    bl_idname = "intrinsic_symmetry.mirror_edit"
    bl_label = "Mirror Edit"

    direction: bpy.props.EnumProperty(
        name="Direction",
        description="Which side's edit is carried to the other",
        items=[("EDITED", "Edited Side", "Of each pair of vertices, the edit of the one that was moved farther")]
        + [entry[:3] for entry in DIRECTIONS],
        default="EDITED",
    )

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        object = context.active_object
        if object.mode != "EDIT" and REMEMBERED not in object.data.attributes:
            cls.poll_message_set("Remember Shape first, then edit")
            return False
        return True

    def run_with(self, symmetry, _context, object, _mode):
        before = self._remembered(object.data)
        edit = mesh_data.shown_positions(object).astype(float) - before
        merge = MERGE.get(self.direction, Merge.SWAP)
        carried = symmetry.carry_displacement(before, edit, merge, **self.how())
        if self.direction == "EDITED":
            farther = np.linalg.norm(carried, axis=1) > np.linalg.norm(edit, axis=1)
            carried = np.where(farther[:, None], carried, edit)
        after = before + carried
        mesh_data.set_shown_positions(object, after)
        mesh_data.update_attribute(object.data.attributes[REMEMBERED], after)
        changed = np.abs(carried - edit).max(axis=1) > 1e-7 * np.abs(before).max()
        return f"{int(changed.sum())} vertices moved; the new shape is remembered"

    def _remembered(self, mesh):
        attribute = mesh.attributes.get(REMEMBERED)
        if attribute is None or attribute.data_type != "FLOAT_VECTOR":
            raise mesh_data.MeshProblem("No shape is remembered: Remember Shape first, then edit")
        return mesh_data.read_attribute(attribute).astype(float)


register, unregister = bpy.utils.register_classes_factory(
    (
        INTRINSIC_SYMMETRY_OT_symmetrize,
        INTRINSIC_SYMMETRY_OT_remember,
        INTRINSIC_SYMMETRY_OT_mirror_edit,
    )
)
