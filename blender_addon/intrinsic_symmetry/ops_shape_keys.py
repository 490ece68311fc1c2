# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror shape keys: displacements are carried in local frames, so that they are right on a posed body."""

import bpy
import numpy as np
from intrinsym import Merge

from . import counterparts, left_side, made_key, mesh_data, side_names
from .mirroring import NamedMirrorProperties, blend, carried_together
from .operator_base import MapOperator


class INTRINSIC_SYMMETRY_OT_mirror_shape_keys(NamedMirrorProperties, MapOperator, bpy.types.Operator):
    """Mirror the active shape key, or all, in any pose. The active key is carried to its twin, Smile.L to
    Smile.R; a key without a side in its name is mirrored in place"""

    bl_idname = "intrinsic_symmetry.mirror_shape_keys"
    bl_label = "Mirror Shape Keys"

    all_keys: bpy.props.BoolProperty(
        name="All Keys",
        description="Mirror every key, and not the active one alone with its counterpart",
        default=False,
    )
    exchange_names: bpy.props.BoolProperty(
        name="Exchange L/R Names",
        description="Smile.L is carried to Smile.R, which is made if there is none; otherwise it is mirrored in place",
        default=True,
    )

    @classmethod
    def is_empty(cls, object):
        keys = object.data.shape_keys
        has_some = keys is not None and len(keys.key_blocks) > 1
        return None if has_some else "The object has no shape key beside its basis"

    def run_with(self, symmetry, _context, object, mode):
        symmetry = left_side.agreed(self, object, symmetry)
        keys, active = object.data.shape_keys, object.active_shape_key.name
        there = keys.key_blocks.keys()
        if not self.all_keys:
            self.let_win(active, keys.key_blocks.keys())
        free = self.may_change(object, mode, symmetry)
        count = 0
        for pair in self._chosen(object, symmetry):
            if len(pair) == 1:
                count += self._in_place(symmetry, keys, pair[0], free)
            else:
                count += self._across(symmetry, object, pair, free)
        object.active_shape_key_index = keys.key_blocks.find(active)
        object.data.update()
        return self.with_made(f"{count} shape key{'' if count == 1 else 's'} changed", there, keys.key_blocks.keys())

    def _chosen(self, object, symmetry):
        """Names of the keys to mirror: pairs, the left one first, and single ones that are mirrored in place."""
        keys, active = object.data.shape_keys, object.active_shape_key
        if active == keys.reference_key and not self.all_keys:
            raise mesh_data.MeshProblem("The basis is active: choose a shape key, or Symmetrize Positions")
        names = [key.name for key in keys.key_blocks if key != keys.reference_key]
        chosen = names if self.all_keys else [active.name]
        if not self.exchange_names:
            return [(name,) for name in chosen]
        chosen = self.without_too_long(chosen, names)
        sizes = mesh_data.key_sizes(object.data)[:, [keys.key_blocks.find(name) for name in names]]
        misread, filled = counterparts.one_sided(names, sizes, symmetry, self.merge)
        self.fill([name for name in chosen if name in filled and not keys.key_blocks[name].lock_shape])
        self.leave([name for name in chosen if name in misread], "no side in the name, but it moves one side alone")
        return list(dict.fromkeys(_pair(name, names) for name in chosen if name not in misread))

    def _in_place(self, symmetry, keys, name, free):
        key = keys.key_blocks[name]
        base, moved = _displacement(key)
        carried = carried_together(symmetry, _at_rest(keys), moved, self.merge, **self.how())
        return self._write(keys, key, base + blend(moved, carried, free))

    def _across(self, symmetry, object, pair, free):
        """Each of the pair that the direction changes takes the image of the other."""
        keys = object.data.shape_keys
        present = [keys.key_blocks.get(name) for name in pair]
        if None in present:
            # An exchange leaves what is not there yet: both change.
            source = None if self.merge == Merge.SWAP else 1 - present.index(None)
        else:
            sizes = np.stack([np.linalg.norm(_displacement(key)[1], axis=1) for key in present], axis=1)
            source = counterparts.source_of_keys(sizes, self.merge)
        targets = (0, 1) if source is None else (1 - source,)
        if self.merge == Merge.SWAP and any(key and key.lock_shape for key in present):
            self.leave(pair, "exchange with a locked one")
            return 0
        share = self.trust(symmetry) * free * (0.5 if source is None and self.merge == Merge.AVERAGE else 1)
        for name, key, other in zip(pair, present, present[::-1]):
            if key is None:
                self._made(object, symmetry, name, other)
        present = [keys.key_blocks[name] for name in pair]
        new = []
        for target in targets:
            _, moved = _displacement(present[1 - target])
            carried = carried_together(symmetry, _at_rest(object.data.shape_keys), moved, Merge.SWAP)
            key = present[target]
            base, own = _displacement(key)
            new.append((key, base + blend(own, carried, share)))
        return sum(self._write(keys, key, values) for key, values in new)

    def _made(self, object, symmetry, name, like):
        if not object.data.shape_keys.use_relative:
            self.warn(f'The shape keys are absolute: "{name}" is one more shape in time')
        for problem in made_key.make(object, symmetry, name, like):
            self.warn(f'Check the driver of "{name}": {problem}')

    def _write(self, keys, key, values):
        """Whether the key could be written and changes."""
        if key.lock_shape:
            self.leave([key.name], "locked")
            return False
        before = mesh_data.key_positions(key)
        mesh_data.move_key(keys, key, values)
        return not np.array_equal(mesh_data.key_positions(key), before)


def _pair(name, names):
    """A name and its counterpart, that of the left first; the name alone, if it has no side."""
    side = side_names.side(name, names)
    return (name,) if side == 0 else (name, side_names.counterpart(name, names))[::side]


def _at_rest(keys):
    """(vertices, 3) the shape whose local frames say how a displacement is turned: the basis, also for a key that is relative to
    another one. That may move one side alone, and Blender adds displacements without turning them."""
    return mesh_data.key_positions(keys.reference_key)


def _displacement(key):
    """(vertices, 3) positions of the key that a key is relative to, and how far it moves them."""
    base = mesh_data.key_positions(key.relative_key)
    return base, mesh_data.key_positions(key).astype(float) - base


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_mirror_shape_keys,))
