# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror shape keys: displacements are carried in local frames, so that they are right on a posed body."""

import bpy
import numpy as np
from intrinsym import Merge

from . import mesh_data, side_names
from .mirroring import MirrorProperties
from .operator_base import MapOperator


class INTRINSIC_SYMMETRY_OT_mirror_shape_keys(MirrorProperties, MapOperator, bpy.types.Operator):
    """Mirror the active shape key, or all, in any pose. Smile.L becomes Smile.R; a key without a side in its
    name is mirrored in place"""

    bl_idname = "intrinsic_symmetry.mirror_shape_keys"
    bl_label = "Mirror Shape Keys"

    all_keys: bpy.props.BoolProperty(
        name="All Keys",
        description="Mirror every key; of a left and right pair, the one that the direction starts from",
        default=False,
    )
    exchange_names: bpy.props.BoolProperty(
        name="Exchange L/R Names",
        description="Smile.L is carried to Smile.R, which is made if there is none; otherwise it is mirrored in place",
        default=True,
    )

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        keys = context.active_object.data.shape_keys
        if keys is None or len(keys.key_blocks) < 2:
            cls.poll_message_set("The object has no shape key beside its basis")
            return False
        return True

    def run_with(self, symmetry, _context, object, mode):
        keys = object.data.shape_keys
        active = object.active_shape_key
        names = self._chosen(keys, active)
        inside = self.may_change(object, mode, symmetry)[:, None]
        for name in names:
            key = keys.key_blocks[name]
            other = side_names.flip(name) if self.exchange_names else name
            base = mesh_data.key_positions(key.relative_key)
            moved = (mesh_data.key_positions(key) - base).astype(float)
            merge = self.merge if other == name else Merge.SWAP
            target = keys.key_blocks.get(other) or _new_key(object, other, key)
            old = (mesh_data.key_positions(target) - base).astype(float)
            carried = symmetry.carry_displacement(base, moved, merge, **self.how())
            mesh_data.set_key_positions(target, base + np.where(inside, carried, old))
        object.active_shape_key_index = keys.key_blocks.find(active.name)
        object.data.update()
        return f"{len(names)} shape key{'s' if len(names) > 1 else ''} mirrored"

    def _chosen(self, keys, active):
        """Names of the keys to mirror; of a pair, the one on the winning side."""
        reference = keys.reference_key
        if not self.all_keys:
            if active == reference:
                raise mesh_data.MeshProblem("The basis is active: choose a shape key, or Symmetrize Positions")
            return [active.name]
        names = [key.name for key in keys.key_blocks if key != reference]
        if not self.exchange_names:
            return names
        loser = 1 if self.direction == "RIGHT_TO_LEFT" else -1
        return [name for name in names if side_names.flip(name) not in names or side_names.side(name) != loser]


def _new_key(object, name, like):
    """A key with the settings of another, at rest."""
    key = object.shape_key_add(name=name, from_mix=False)
    key.relative_key = like.relative_key
    key.slider_min, key.slider_max = like.slider_min, like.slider_max
    mesh_data.set_key_positions(key, mesh_data.key_positions(like.relative_key))
    return key


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_mirror_shape_keys,))
