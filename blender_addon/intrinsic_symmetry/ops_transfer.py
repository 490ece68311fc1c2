# SPDX-License-Identifier: GPL-3.0-or-later
"""Carry shape keys or weights from the active object to others with the same faces, in whatever pose or shape."""

import bpy
import intrinsym
import numpy as np
from intrinsym import Merge, SymmetryKind

from . import asymmetry, mesh_data, side_names, stored_map, vertex_map
from .mirroring import carried_together
from .operator_base import MeshOperator
from .weights import read_weights, write_weights


class INTRINSIC_SYMMETRY_OT_transfer(MeshOperator, bpy.types.Operator):
    """Carry shape keys or weights of the active object to the other selected ones that have the same faces, in local
    frames; across the symmetry, left goes to right"""

    bl_idname = "intrinsic_symmetry.transfer"
    bl_label = "Transfer to Selected Objects"
    one_object = True

    what: bpy.props.EnumProperty(
        name="What",
        description="What the other objects are given",
        items=(
            ("KEY", "Active Shape Key", "Turned and stretched with the surface, and scaled with its size"),
            ("KEYS", "All Shape Keys", "Turned and stretched with the surface, and scaled with its size"),
            ("WEIGHTS", "Weights", "All vertex groups"),
        ),
    )
    across: bpy.props.BoolProperty(
        name="Across the Symmetry",
        description="What is left here becomes right there, names as well; the active object needs its symmetry",
        default=False,
    )
    replace: bpy.props.BoolProperty(
        name="Replace", description="Write over keys and groups that the other objects have already", default=False
    )

    def run(self, context, object, _mode):
        others = [other for other in context.selected_objects if other.type == "MESH" and other.data != object.data]
        if not others:
            raise mesh_data.MeshProblem(_why_none([other for other in context.selected_objects if other != object]))
        others = list({other.data: other for other in others}.values())  # one of those that share a mesh
        mesh_data.refuse_fixed(others)
        source = _core_mesh(object)
        kind, points = self._map(object, source)
        scales = [_scale(object, other) for other in others]
        targets = [_core_mesh(other, scale) for other, scale in zip(others, scales)]
        for other, target in zip(others, targets):
            if target.connectivity_hash != source.connectivity_hash:
                raise mesh_data.MeshProblem(f'"{other.name}" has other faces than "{object.name}"')
        given, left = 0, []
        for other, target, scale in zip(others, targets, scales):
            joined = vertex_map.between(source, target, points, kind)
            done, kept = self._give(joined, object, other, scale)
            other.data.update()
            given, left = given + done, left + [f"{other.name}: {name}" for name in kept]
        said = f"{given} {'groups' if self.what == 'WEIGHTS' else 'shape keys'} transferred to {len(others)} objects"
        return said + (f"; there already or locked: {', '.join(left[:3])}" if left else "")

    def _map(self, object, source):
        """Kind and SurfacePoints of the map from each vertex of an object to its image on another."""
        if not self.across:
            return SymmetryKind.HALF_TURN, vertex_map.at_vertices(source, np.arange(source.vertex_count))
        symmetry = stored_map.load(object.data)
        return symmetry.kind, symmetry.surface_points

    def _give(self, joined, object, other, scale):
        if self.what == "WEIGHTS":
            return self._give_weights(joined, object, other)
        return self._give_keys(joined, object, other, scale)

    def _name(self, name, names):
        """What one of the names of the active object is called on the other ones."""
        return side_names.counterpart(name, names) if self.across else name

    def _give_keys(self, joined, object, other, scale):
        """How many keys were given, and names of those that were there or locked."""
        keys, kept = _chosen_keys(object, self.what == "KEYS"), []
        every, groups = object.data.shape_keys.key_blocks.keys(), object.vertex_groups.keys()
        side_names.refuse_too_long(self._name(key.name, every) for key in keys)
        if other.data.shape_keys is None:
            other.shape_key_add(name="Basis", from_mix=False)
        made = [key for key in keys if self._name(key.name, every) not in other.data.shape_keys.key_blocks]
        masks = [name for name in dict.fromkeys(key.vertex_group for key in made) if name in groups]
        self._give_groups(joined, object, other, masks, False)
        there = mesh_data.key_positions(other.data.shape_keys.reference_key).astype(float)
        for key in keys:
            name = self._name(key.name, every)
            target = other.data.shape_keys.key_blocks.get(name)
            if target is not None and (not self.replace or target.lock_shape):
                kept.append(target.name)
                continue
            base = mesh_data.key_positions(key.relative_key).astype(float)
            both = np.vstack([mesh_data.key_positions(key) - base, np.zeros_like(there)])
            shapes = np.vstack([base - base.mean(axis=0), (there - there.mean(axis=0)) / scale])
            carried = carried_together(joined, shapes, both, Merge.SWAP)[len(base) :]
            target = target or _at_rest(other, name, key, key.vertex_group and self._name(key.vertex_group, groups))
            mesh_data.set_key_positions(target, there + scale * carried)
        return len(keys) - len(kept), kept

    def _give_weights(self, joined, object, other):
        """How many groups were given, and names of those that were there or locked."""
        if not object.vertex_groups:
            raise mesh_data.MeshProblem(f'"{object.name}" has no vertex groups')
        return self._give_groups(joined, object, other, object.vertex_groups.keys(), self.replace)

    def _give_groups(self, joined, object, other, own, replace):
        """The same for those with `own` names."""
        groups, active = other.vertex_groups, other.vertex_groups.active_index
        names = [self._name(name, object.vertex_groups.keys()) for name in own]
        side_names.refuse_too_long(names)
        may_write = [name not in groups or replace and not groups[name].lock_weight for name in names]
        if not any(may_write):
            return 0, names
        for name, free in zip(names, may_write):
            if free and name not in groups:
                groups.new(name=name)
        groups.active_index = max(active, 0)
        weights = read_weights(object)[:, [object.vertex_groups[name].index for name in own]]
        before = read_weights(other)
        both = np.vstack([weights, np.zeros_like(weights)])
        carried = joined.mirror_values(both, Merge.SWAP)[len(weights) :]
        after = before.copy()
        for column, (name, free) in enumerate(zip(names, may_write)):
            if free:
                after[:, groups[name].index] = carried[:, column]
        write_weights(other, before, after)
        return sum(may_write), [name for name, free in zip(names, may_write) if not free]


def _why_none(selected):
    """Why there is nothing to transfer to among objects that are selected beside the active one."""
    meshes = [other for other in selected if other.type == "MESH"]
    if meshes:
        return f'"{meshes[0].name}" shares the mesh of the active object, and so has its keys and weights already'
    if selected:
        return f'"{selected[0].name}" is not a mesh: select the meshes to transfer to, the one to transfer from last'
    return "Select the objects to transfer to, the one to transfer from last"


def _core_mesh(object, scale=1.0):
    return intrinsym.Mesh(mesh_data.positions(object.data) / scale, mesh_data.polygons(object.data))


def _scale(object, other):
    """How much larger the other surface is, in length."""
    areas = [max(asymmetry.vertex_areas(one.data).sum(), 1e-30) for one in (other, object)]
    return float(np.sqrt(areas[0] / areas[1]))


def _chosen_keys(object, every):
    keys = object.data.shape_keys
    found = [] if keys is None else [key for key in keys.key_blocks if key != keys.reference_key]
    found = [key for key in found if every or key == object.active_shape_key]
    if not found:
        raise mesh_data.MeshProblem(f'Choose a shape key of "{object.name}" that is not the basis')
    return found


def _at_rest(object, name, like, group):
    """A new key with the sliders of another object's, and the vertex group with that name."""
    key = object.shape_key_add(name=name, from_mix=False)
    key.slider_min, key.slider_max = like.slider_min, like.slider_max
    key.mute, key.vertex_group = like.mute, group
    return key


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_transfer,))
