# SPDX-License-Identifier: GPL-3.0-or-later
"""Give one half of the mesh the other half's vertices, edges and faces, across the map, in any pose."""

import bmesh
import bpy
import intrinsym
import numpy as np
from intrinsym import Merge, SymmetryKind

from . import (
    half_copy, half_data, half_form, half_line, half_map, left_side, local_frames, mesh_data, ops_attributes,
    stored_map, vertex_map,
)
from .counterparts import listed
from .mirroring import DIRECTIONS, MERGE
from .operator_base import MapOperator
from .ops_positions import forget
from .regions import components


class INTRINSIC_SYMMETRY_OT_symmetrize_topology(MapOperator, bpy.types.Operator):
    """Replace one half of the mesh by a mirrored copy of the other half's faces, in any pose. The copy lies on the
    surface that was there, and takes positions, shape keys, weights, colors and UVs from it; materials, seams, creases
    and sharp edges are the winning half's. So an extrusion or a loop cut on one side arrives on the other one"""

    bl_idname = "intrinsic_symmetry.symmetrize_topology"
    bl_label = "Symmetrize Topology"
    each_alone = True

    direction: bpy.props.EnumProperty(
        name="Direction",
        description="Which half is replaced by a mirrored copy of the other",
        items=[("EDITED", "Edited Side", "The half whose faces were edited last stays; without an edit, the left one")]
        + [entry[:3] for entry in DIRECTIONS[:2]],
    )

    def run_with(self, symmetry, _context, object, mode):
        self._refuse(symmetry, object)
        symmetry = left_side.agreed(self, object, symmetry)
        mesh = object.data
        direction = self._direction(mesh)
        winner = 1 if MERGE[direction] == Merge.POSITIVE_WINS else -1
        before, left_from = len(mesh.polygons), mesh[stored_map.RECORD]["left_from"]
        if half_map.is_mirrored(mesh, symmetry, winner):
            return self._keep(object, symmetry, direction)
        self._say_what_is_replaced(mesh, symmetry, winner)
        half = _Half(object, symmetry, winner)
        forget(mesh)
        half.fill(object, symmetry)
        if mode == "EDIT" and half.attached.names:
            self.warn(f"Undo in edit mode does not take back the vertices of {listed(half.attached.names)}")
        stored_map.store(mesh, half.core_mesh, half.known, left=(1, left_from), exact_share=1.0)
        mesh.update()
        self._mirror_normals(object, direction)
        self._say_lone(half.known)
        copied = np.count_nonzero(half.copies)
        way = "Left to right" if winner > 0 else "Right to left"
        return f"{way}: {copied:,} vertices are copies; {len(mesh.polygons):,} faces now, {before:,} before"

    def _keep(self, object, symmetry, direction):
        """Where the faces are mirrored already: what belongs to faces and edges goes over, and nothing is renumbered."""
        mesh, core_mesh = object.data, intrinsym.Mesh(mesh_data.positions(object.data), mesh_data.polygons(object.data))
        found = (symmetry.partner >= 0).astype(float)
        points = vertex_map.at_vertices(core_mesh, symmetry.partner)
        exact = core_mesh.restore(symmetry.kind, symmetry.partner, found, symmetry.side, points)
        exact.fixed_curve, record = stored_map.fixed_lines(mesh), mesh[stored_map.RECORD]
        stored_map.store(mesh, core_mesh, exact, record["doubtful"], (1, record["left_from"]), exact_share=1.0)
        changed = []
        for name in [each.name for each in mesh.attributes if half_data.is_of_faces(each)]:
            values, new = ops_attributes.of_elements(exact, mesh, mesh.attributes[name], MERGE[direction])
            if not np.array_equal(values, new):
                mesh_data.update_attribute(mesh.attributes[name], new)
                changed.append(name)
        mesh.update()
        self._mirror_normals(object, direction)
        self._say_lone(exact)
        return f"The faces are mirrored already: {f'only {listed(changed)} changed' if changed else 'nothing to do'}"

    def _say_lone(self, symmetry):
        if lone := np.count_nonzero(symmetry.partner < 0):
            self.warn(f"{lone:,} vertices of parts without a mirror image stay alone")

    def _mirror_normals(self, object, direction):
        if object.data.has_custom_normals:
            with bpy.context.temp_override(active_object=object, object=object):
                bpy.ops.intrinsic_symmetry.mirror_attribute(name="custom_normal", direction=direction)

    def _direction(self, mesh):
        """The one that was chosen, or from the edited side."""
        if self.direction != "EDITED":
            return self.direction
        return "RIGHT_TO_LEFT" if stored_map.edited_side(mesh) < 0 else "LEFT_TO_RIGHT"

    def _say_what_is_replaced(self, mesh, symmetry, winner):
        """Where the losing side was edited, or has parts that were deleted on the other one."""
        loses, alone = symmetry.side == -winner, half_map.alone(mesh, symmetry)
        deleted = np.count_nonzero(loses & alone & (stored_map.read_edit(mesh) == stored_map.LOST))
        lost, name = (stored_map.edits(mesh)[winner > 0], "right" if winner > 0 else "left")
        lost -= np.count_nonzero(loses & alone) - deleted
        if lost > 0:
            self.warn(f"What was edited on the {name} side is replaced ({lost:,} vertices)")
        if deleted:
            self.warn(f"Parts whose mirror images were deleted are deleted on the {name} side ({deleted:,} vertices)")

    def _refuse(self, symmetry, object):
        """Raises MeshProblem where it cannot work."""
        if symmetry.kind == SymmetryKind.HALF_TURN:
            raise mesh_data.MeshProblem("A half turn has no left and right")
        if mesh_data.has_multires(object):
            raise mesh_data.MeshProblem("The Multires modifier holds detail of the old faces: apply it first")
        if object.data[stored_map.RECORD].get("doubtful"):
            self.warn("The symmetry was doubtful: look at the whole copy")
        if object.data.users > 1:
            self.warn(f"{object.data.users - 1} more objects use this mesh, and change with it")


class _Half:
    """A mesh whose half was rebuilt, and its map."""

    def __init__(self, object, symmetry, winner):
        mesh, bm = object.data, bmesh.new()
        try:
            bm.from_mesh(mesh, face_normals=False, vertex_normals=False)
            self._halves = halves = half_line.halves(bm, mesh, symmetry, winner)
            if not (symmetry.partner[halves.labels == half_line.WINS] >= 0).any():
                raise mesh_data.MeshProblem("No part of the mesh has a mirror image on the other side")
            self._changed = stored_map.is_changed(mesh, symmetry.partner)
            self._old, self.attached = half_data.Old(object, halves), half_data.Attached(mesh)
            half_copy.rebuild(bm, halves)
            bm.to_mesh(mesh)
        finally:
            bm.free()
        self._source, self._copied = _taken(mesh, half_copy.SOURCE), _taken(mesh, half_copy.COPIED) > 0
        self.copies = self._source < 0
        self.core_mesh = intrinsym.Mesh(mesh_data.positions(mesh), mesh_data.polygons(mesh))
        self.known = half_map.known(mesh, self.core_mesh, halves, self._source, winner, symmetry.side)

    def fill(self, object, symmetry):
        """Places the copy, and gives it what was there; `symmetry` is the map of the old mesh."""
        mesh, old, copies = object.data, self._old, self.copies
        models = np.where(copies, -1 - self._source, self._source)
        mix, model = (half_data.vertex_mix(each, self._halves, symmetry) for each in (self._source, models))
        line = self.known.partner == np.arange(len(copies))
        whole = mix.weights.max(axis=1) > vertex_map.WHOLE
        without = symmetry.partner < 0
        added = copies & self._of_lone_shells(mesh, model.of(without))
        kept = (copies | line) & whole & model.of(vertex_map.pairs(symmetry) & ~self._changed & ~old.lift.any(axis=1))
        form = half_form.Form(mesh, old.surface, mix, model.of(old.positions), copies, copies | line, whole, kept, added)
        feet, lifted = old.positions - old.lift, self._lifted(mix, model, symmetry)
        beside = np.linalg.norm(mix.of(symmetry.surface_points.positions(feet)) - model.of(feet), axis=1)
        places = form.placed(lifted(old.lift), beside, model.of(without), model.of(self._changed))
        mix.take(copies & model.of(without), old.surface, places)
        old.give_positions(object, mix, places, lifted, model, added)
        old.give_points(object, mix, copies, added)
        offsets, corners = mesh_data.polygons(mesh)
        old.give_corners(mesh, self._copied & ~added[corners[offsets[:-1]]], places)
        self.attached.renumber(self._source, old.positions, places)

    def _of_lone_shells(self, mesh, without):
        """(vertices,) bool: those of shells all of whose models have no images."""
        shell = components(len(without), mesh_data.edges(mesh).astype(np.int64))
        return ~np.isin(shell, shell[~without])

    def _lifted(self, mix, model, symmetry):
        """A function of the (old vertices, 3) lift: that of the new ones; of copies it is that of their models, turned as
        the surface is from there to where the mix is."""
        old, copies = self._old, self.copies[:, None]
        if not old.lift.any():
            return model.of
        turns = mix.of(local_frames.turns(symmetry, old.positions - old.lift))
        return lambda lift: np.where(copies, np.einsum("vxy,vy->vx", turns, model.of(lift)), mix.of(lift))


def _taken(mesh, name):
    """Values of an attribute, which is removed."""
    values = mesh_data.read_attribute(mesh.attributes[name])
    mesh_data.remove_attribute(mesh, name)
    return values


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_symmetrize_topology,))
