# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove asymmetry of any width: exactly about the mirror plane in a rest pose, by lengths in any other."""

import bpy
import numpy as np
from intrinsym import Merge

from . import asymmetry, left_side, mesh_data
from .mirroring import MirrorProperties, blend, shares
from .operator_base import MapOperator
from .places import kept_together
from .posed_shape import PosedShape


class INTRINSIC_SYMMETRY_OT_symmetrize_exactly(MirrorProperties, MapOperator, bpy.types.Operator):
    """Make the shape exactly symmetric about its own mirror plane: the losing side takes the mirrored places of the
    winning side, which stays. A posed body keeps its pose, and its losing side takes the lengths of the other"""

    bl_idname = "intrinsic_symmetry.symmetrize_exactly"
    bl_label = "Symmetrize Exactly"
    on_shown_shape = True

    about: bpy.props.EnumProperty(name="About", description="What the shape is mirrored about", items=asymmetry.ABOUT)
    strength: bpy.props.FloatProperty(
        name="Strength",
        description="Share of the asymmetry that is removed",
        min=0.0, max=1.0, default=1.0, subtype="FACTOR",
    )
    repeat: bpy.props.IntProperty(
        name="Repeat",
        description="How many times; in a pose once is usually enough, as each time moves the body itself, too",
        min=1, max=100, soft_max=10, default=1,
    )

    def run_with(self, symmetry, _context, object, mode):
        symmetry = left_side.agreed(self, object, symmetry)
        before = mesh_data.shown_positions(object).astype(float)
        reference = asymmetry.reference(self.about, symmetry, object.data, before)
        if self.about == "X":
            asymmetry.refuse_beside_x(symmetry, object.data, before)
        inside = self.may_change(object, mode, symmetry)
        posed = reference.plane is None
        once = self._in_pose(symmetry, object.data, before, inside) if posed else self._about(symmetry, reference)
        after = before
        for _ in range(self.repeat):
            after = blend(after, once(after), self.strength * inside)
        after = kept_together(before, after, self.with_line(symmetry, self.trust(symmetry) * inside) > 0)
        mesh_data.set_shown_positions(object, after)
        if self.merge == Merge.SWAP:
            away = np.linalg.norm(after - before, axis=1).max(initial=0) / asymmetry.size(before)
            return f"Exchanged {reference.in_words()}: vertices moved by up to {away:.2%} of the object's size"
        old, now = (reference.asymmetry(symmetry, points)[inside > 0] for points in (before, after))
        return f"Asymmetry {reference.in_words()}: {_mean(old)}, now {_mean(now)} of the object's size"

    def _in_pose(self, symmetry, mesh, positions, inside):
        """Makes positions symmetric in their pose: what is narrow, then the lengths."""
        symmetry, how = self.held(mesh, symmetry, inside)
        shape = PosedShape(symmetry, mesh_data.triangles(mesh), positions, shares(symmetry, self.merge, **how))
        swaps = self.merge == Merge.SWAP  # what is narrow has changed sides already then

        def once(points):
            narrow = symmetry.symmetrize_positions(points, self.merge, **how)
            return shape.with_lengths(narrow, points if swaps else None)

        return once

    def _about(self, symmetry, reference):
        """Makes positions symmetric about a plane."""
        share = self.shares(symmetry)
        on_line = (symmetry.side == 0) & (symmetry.partner >= 0) & (self.merge != Merge.SWAP)
        share[on_line] = np.where(symmetry.confidence[on_line] < self.minimum_confidence, 0.0, 0.5)
        return lambda positions: blend(positions, reference.images(symmetry, positions), share)


def _mean(values):
    return f"{values.mean():.3%}" if len(values) else "nothing"


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_symmetrize_exactly,))
