# SPDX-License-Identifier: GPL-3.0-or-later
"""Split a shape key into a left and a right one along a soft line, and join two."""

import bpy

from . import asymmetry, left_side, line_distance, mesh_data, side_names, stored_map, undo
from .operator_base import MapOperator, MeshOperator
from .weights import read_weights


class INTRINSIC_SYMMETRY_OT_split_shape_key(MapOperator, bpy.types.Operator):
    """Split the active shape key into a left and a right one, Smile into Smile.L and Smile.R. Together they are the
    old key, which stays"""

    bl_idname = "intrinsic_symmetry.split_shape_key"
    bl_label = "Split Shape Key"

    width: bpy.props.FloatProperty(
        name="Width",
        description="Of the soft line between left and right, as a share of the object's size",
        min=0.0, max=1.0, soft_max=0.2, default=0.04, subtype="FACTOR",
    )

    @classmethod
    def lacks(cls, context, object):
        return super().lacks(context, object) or _without_active_key(object)

    def run_with(self, symmetry, _context, object, _mode):
        symmetry = left_side.agreed(self, object, symmetry)
        mesh, key = object.data, object.active_shape_key
        lines = stored_map.fixed_lines(mesh)
        if not lines:
            raise mesh_data.MeshProblem("This symmetry has no line between left and right")
        if side_names.side(key.name, mesh.shape_keys.key_blocks.keys()):
            raise mesh_data.MeshProblem(f'"{key.name}" has a side in its name already')
        _must_be_free(mesh.shape_keys, f"{key.name}.L", f"{key.name}.R")
        base = mesh_data.key_positions(key.relative_key).astype(float)
        moved = mesh_data.key_positions(key) - base
        width = self.width * asymmetry.size(base)
        distance = line_distance.line_distances(mesh, lines, base, 0.5 * width)
        left = line_distance.left_shares(symmetry, distance, width)
        for suffix, share in ((".L", left), (".R", 1 - left)):
            made = _new_key(object, key.name + suffix, key)
            mesh_data.set_key_positions(made, base + share[:, None] * moved)
        object.active_shape_key_index = mesh.shape_keys.key_blocks.find(f"{key.name}.L")
        soft = int(((left > 0) & (left < 1) & moved.any(axis=1)).sum())
        return f"{key.name}.L and {key.name}.R: {soft} moved vertices lie in the soft line"


class INTRINSIC_SYMMETRY_OT_join_shape_keys(MeshOperator, bpy.types.Operator):
    """Join the active shape key and that of the other side into one, Smile.L and Smile.R into Smile; both stay"""

    bl_idname = "intrinsic_symmetry.join_shape_keys"
    bl_label = "Join Left and Right Shape Keys"

    @classmethod
    def lacks(cls, context, object):
        return super().lacks(context, object) or _without_active_key(object)

    def run(self, _context, object, _mode):
        keys, key = object.data.shape_keys, object.active_shape_key
        other = keys.key_blocks.get(side_names.counterpart(key.name, keys.key_blocks.keys()))
        if other is None or other == key:
            raise mesh_data.MeshProblem(f'"{key.name}" has no key of the other side')
        name = _without_side(key.name, other.name)
        _must_be_free(keys, name)
        same_mask = key.vertex_group == other.vertex_group
        moved = [_moved(object, one, with_mask=not same_mask) for one in (key, other)]
        made = _new_key(object, name, key)
        made.vertex_group = key.vertex_group if same_mask else ""
        mesh_data.set_key_positions(made, mesh_data.key_positions(key.relative_key) + sum(moved))
        object.active_shape_key_index = keys.key_blocks.find(made.name)
        return f"{made.name} is {key.name} and {other.name} together"


def _moved(object, key, with_mask):
    """(vertices, 3) how far a key moves the vertices: as it is, or as its vertex group lets it."""
    moved = mesh_data.key_positions(key) - mesh_data.key_positions(key.relative_key)
    if not with_mask or key.vertex_group not in object.vertex_groups:
        return moved
    return moved * read_weights(object)[:, [object.vertex_groups[key.vertex_group].index]]


def _new_key(object, name, like):
    """A key with the settings of another, its value 0, since that one stays."""
    made = object.shape_key_add(name=name, from_mix=False)
    undo.note_made(object, made)
    made.relative_key, made.interpolation, made.vertex_group = like.relative_key, like.interpolation, like.vertex_group
    made.slider_max, made.slider_min = max(like.slider_max, made.slider_min), like.slider_min
    made.slider_max = like.slider_max  # again: the range never turns over
    made.value = 0
    return made


def _without_active_key(object):
    """Why no shape key can be worked on, or nothing."""
    keys = object.data.shape_keys
    found = keys is not None and object.active_shape_key not in (None, keys.reference_key)
    return mesh_data.why_absolute(object) if found else "Choose a shape key that is not the basis"


def _must_be_free(keys, *names):
    side_names.refuse_too_long(names)
    for name in names:
        if name in keys.key_blocks:
            raise mesh_data.MeshProblem(f'"{name}" is there already: rename or delete it first')


def _without_side(name, other):
    """The name without the word in which it differs from that of the other side, nor the separator before it."""
    begin = next((place for place, (one, two) in enumerate(zip(name, other)) if one != two), len(name))
    words = side_names.LEFT + side_names.RIGHT, side_names.RIGHT + side_names.LEFT
    for word, flipped in zip(*words):
        if name[begin:].lower().startswith(word) and other[begin:].lower().startswith(flipped):
            before, after = name[:begin], name[begin + len(word) :]
            return before.rstrip(" ._-") + after if before else after.lstrip(" ._-")
    return name


register, unregister = bpy.utils.register_classes_factory(
    (INTRINSIC_SYMMETRY_OT_split_shape_key, INTRINSIC_SYMMETRY_OT_join_shape_keys)
)
