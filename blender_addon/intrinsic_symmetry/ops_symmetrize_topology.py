# SPDX-License-Identifier: GPL-3.0-or-later
"""Give one half of the mesh the other half's vertices, edges and faces, across the map, in any pose."""

import functools

import bmesh
import bpy
import intrinsym
import numpy as np
from intrinsym import Merge, SymmetryKind

from . import (
    edit_moves, half_copy, half_data, half_form, half_labels, half_line, half_map, half_pairs, left_side, local_frames,
    mesh_data, ops_attributes, stored_map, vertex_map,
)
from .asymmetry import size
from .counterparts import listed
from .mirroring import DIRECTIONS, MERGE
from .operator_base import MapOperator
from .ops_positions import renew
from .regions import components

#: In the record of a map that this tool has stored: no faces were edited since.
_DONE = "symmetrized"


class INTRINSIC_SYMMETRY_OT_symmetrize_topology(MapOperator, bpy.types.Operator):
    """Make one half of the mesh the mirror image of the other half's faces, in any pose. Faces that are so already stay.
    Copies lie on the surface that was there, and take positions, shape keys, weights, colors and UVs from it; materials,
    seams, creases and sharp edges are the winning half's. So an extrusion or a loop cut on one side arrives on the other"""

    bl_idname = "intrinsic_symmetry.symmetrize_topology"
    bl_label = "Symmetrize Topology"
    each_alone = True

    direction: bpy.props.EnumProperty(
        name="Direction",
        description="Which half is replaced by a mirrored copy of the other",
        items=[("EDITED", "Edited Side", "The half that was edited more since the symmetry was last used or updated "
                "stays; or else the left one")]
        + [entry[:3] for entry in DIRECTIONS[:2]],
    )

    def run_with(self, symmetry, _context, object, mode):
        self._refuse(symmetry, object)
        symmetry = left_side.agreed(self, object, symmetry)
        mesh = object.data
        direction = self._direction(mesh)
        winner = 1 if MERGE[direction] == Merge.POSITIVE_WINS else -1
        before, left_from = len(mesh.polygons), mesh[stored_map.RECORD]["left_from"]
        if half_map.is_mirrored(mesh, symmetry, winner) and not edit_moves.after_carry(mesh).any():
            return self._keep(object, symmetry, direction)
        if self.direction == "EDITED" and mesh[stored_map.RECORD].get(_DONE):
            return "No faces were edited since: nothing to do. Choose a direction to replace a whole half"
        self._say_what_is_replaced(mesh, symmetry, winner)
        edited_only = self.direction == "EDITED" and bool(stored_map.read_edit(mesh).any())
        half = _Half(object, symmetry, winner, edited_only)
        if half.is_new and edited_only:
            self.warn("Left and right do not share their faces: beside the edit the whole half is replaced")
        half.fill(object, symmetry)
        renew(object, half.changed)
        if mode == "EDIT" and half.attached.names:
            self.warn(f"Undo in edit mode does not take back the vertices of {listed(half.attached.names)}")
        exact = vertex_map.pairs(half.known)[half.known.partner >= 0].mean()
        stored_map.store(mesh, half.core_mesh, half.known, left=(1, left_from), exact_share=float(exact))
        mesh[stored_map.RECORD][_DONE] = True
        mesh.update()
        if self.direction != "EDITED":
            self._mirror_attributes(half.known, mesh, direction)
        normals = self._mirror_normals(half.known, mesh, direction, half.copied_faces)
        self._say_lone(half.known)
        way = "Left to right" if winner > 0 else "Right to left"
        farthest = f"{half.moved.max(initial=0):.2%} of the object's size"
        moved = f", {len(half.moved):,} were moved by up to {farthest}" if len(half.moved) else ""
        copied = np.count_nonzero(half.copies)
        return f"{way}: {copied:,} vertices are copies{moved}; {len(mesh.polygons):,} faces now, {before:,} before{normals}"

    def _keep(self, object, symmetry, direction):
        """Where the faces are mirrored already nothing is renumbered. What belongs to faces and edges goes over, if a direction
        was chosen."""
        mesh, core_mesh = object.data, intrinsym.Mesh(mesh_data.positions(object.data), mesh_data.polygons(object.data))
        found = (symmetry.partner >= 0).astype(float)
        points = vertex_map.at_vertices(core_mesh, symmetry.partner)
        exact = core_mesh.restore(symmetry.kind, symmetry.partner, found, symmetry.side, points)
        exact.fixed_curve, record = stored_map.fixed_lines(mesh), mesh[stored_map.RECORD]
        stored_map.store(mesh, core_mesh, exact, record["doubtful"], (1, record["left_from"]), exact_share=1.0)
        changed = self._mirror_attributes(exact, mesh, direction) if self.direction != "EDITED" else []
        mesh.update()
        normals = self._mirror_normals(exact, mesh, direction, np.zeros(len(mesh.polygons), bool))
        self._say_lone(exact)
        return f"The faces are mirrored already: {f'only {listed(changed)} changed' if changed else 'nothing to do'}{normals}"

    def _mirror_attributes(self, symmetry, mesh, direction):
        """Mirrors attributes of faces and edges; names of those that changed."""
        changed = []
        for name in [each.name for each in mesh.attributes if half_data.is_of_faces(each)]:
            values, new = ops_attributes.of_elements(symmetry, mesh, mesh.attributes[name], MERGE[direction])
            if not np.array_equal(values, new):
                mesh_data.update_attribute(mesh.attributes[name], new)
                changed.append(name)
        return changed

    def _say_lone(self, symmetry):
        if lone := np.count_nonzero(symmetry.partner < 0):
            self.warn(f"{lone:,} vertices of parts without a mirror image stay alone")

    def _mirror_normals(self, symmetry, mesh, direction, faces):
        """Mirrors custom normals; those of some faces, (faces,) bool, alone if no direction was chosen. In words, how many
        changed."""
        faces = faces | (self.direction != "EDITED")
        if not mesh.has_custom_normals or not faces.any():
            return ""
        return f". {ops_attributes.mirror_normals(symmetry, mesh, MERGE[direction], faces)}"

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


#: A vertex has moved if it did so by more than this share of the size.
_MOVED = 1e-6


class _Half:
    """A mesh whose half was rebuilt, and its map."""

    def __init__(self, object, symmetry, winner, edited_only):
        mesh, bm = object.data, bmesh.new()
        try:
            bm.from_mesh(mesh, face_normals=False, vertex_normals=False)
            self._halves = halves = _halves(bm, mesh, symmetry, winner, edited_only)
            self.is_new = (halves.twin < 0).all()  # not one face stays
            if not (symmetry.partner[halves.labels == half_labels.WINS] >= 0).any():
                raise mesh_data.MeshProblem("No part of the mesh has a mirror image on the other side")
            self._changed = stored_map.is_changed(mesh, symmetry.partner)
            self._moved = edit_moves.after_carry(mesh).any(axis=1)
            self._old, self.attached = half_data.Old(object, halves, symmetry), half_data.Attached(mesh)
            half_labels.refuse_holes(mesh, symmetry, halves)
            gone = half_copy.rebuild(bm, halves)
            _refuse_loss(bm, mesh, symmetry.side * winner > 0, gone)
            bm.to_mesh(mesh)
        finally:
            bm.free()
        self._source, self.copied_faces = _taken(mesh, half_copy.SOURCE), _taken(mesh, half_copy.COPIED) > 0
        self.copies = self._source < 0
        self.core_mesh = intrinsym.Mesh(mesh_data.positions(mesh), mesh_data.polygons(mesh))
        self.known = half_map.known(mesh, self.core_mesh, halves, self._source, winner, symmetry)

    def fill(self, object, symmetry):
        """Places the copy, and gives it what was there; `symmetry` is the map of the old mesh."""
        mesh, old, copies = object.data, self._old, self.copies
        models = self._halves.models(self._source)
        mirrored = copies | (models != self._source)  # of the losing half
        mix, model = (half_data.vertex_mix(each, self._halves, symmetry) for each in (self._source, models))
        line, without = self._halves.on_line(self._source), symmetry.partner < 0
        images = np.where((mirrored | line)[:, None], self._halves.images_of(models), np.nan)
        exact = model.of(vertex_map.pairs(symmetry) & ~self._changed & ~old.lift.any(axis=1))
        known = np.isfinite(images).all(axis=1)
        moving = copies | mirrored & (known | ~exact)
        added = copies & self._of_lone_shells(mesh, model.of(without))
        lifted = self._lifted(mix, model, moving, symmetry)
        places = np.where(known[:, None], images, mix.of(old.positions))
        if (moving & ~known).any():
            whole, loose, fitted = mix.weights.max(axis=1) > vertex_map.WHOLE, moving & ~known, mirrored | line
            kept = fitted & ~loose & (known | whole & exact)
            models = model.of(old.positions)
            form = half_form.Form(mesh, old.surface, mix, models, loose, fitted, whole, kept, added & ~known)
            feet = old.positions - old.lift
            beside = np.linalg.norm(mix.of(symmetry.surface_points.positions(feet)) - model.of(feet), axis=1)
            places = form.placed(images, lifted(old.lift), beside, model.of(without), model.of(self._changed))
        away = np.linalg.norm(places - mix.of(old.positions), axis=1) / size(old.positions)
        shifted = mirrored & ~copies & (away > _MOVED)
        self.moved, self.changed = away[shifted], copies | shifted | model.of(self._changed | self._moved)
        mix.take(copies & model.of(without), old.surface, places)
        old.give_positions(object, mix, places, lifted, moving, model, added)
        old.give_points(object, mix, copies, added)
        old.give_hidden(mesh, mix)
        offsets, corners = mesh_data.polygons(mesh)
        had = old.give_faces(mesh, self.copied_faces, self._halves.were(self._source))
        old.give_corners(mesh, self.copied_faces & ~had & ~added[corners[offsets[:-1]]], places)
        self.attached.renumber(self._source, old.positions, places)

    def _of_lone_shells(self, mesh, without):
        """(vertices,) bool: those of shells all of whose models have no images."""
        shell = components(len(without), mesh_data.edges(mesh).astype(np.int64))
        return ~np.isin(shell, shell[~without])

    def _lifted(self, mix, model, moving, symmetry):
        """A function of the (old vertices, 3) lift: that of the new ones; of those `moving`, (vertices,) bool, it is that of
        their models, turned as the surface is from there to where the mix is."""
        old, halves = self._old, self._halves
        at_rest = model.of(halves.at_rest.astype(float))[:, None, None] > 0.5

        @functools.cache
        def turns():
            turned = mix.of(local_frames.turns(symmetry, old.positions - old.lift))
            return np.where(at_rest, halves.reflection, turned)

        def lifted(lift):
            turned = np.einsum("vxy,vy->vx", turns(), model.of(lift)) if lift.any() else 0 * model.of(lift)
            return np.where(moving[:, None], turned, mix.of(lift))

        return lifted


def _halves(bm, mesh, symmetry, winner, edited_only):
    labels = half_labels.of_shells(mesh, symmetry, winner, mesh_data.edges(mesh).astype(np.int64))
    twin = half_pairs.twins(mesh, symmetry, labels, edited_only)
    if twin is None:
        return half_line.halves(bm, mesh, symmetry, labels)
    return half_pairs.halves(bm, mesh, symmetry, labels, twin, winner, edited_only)


def _refuse_loss(bm, mesh, wins, faces):
    """Raises MeshProblem where what an edit has made on the winning side, (vertices,) bool, is gone in the rebuilt `bm`, or so
    many `faces` are that do not lose."""
    source, kept = bm.verts.layers.int[half_copy.SOURCE], np.zeros(len(wins), bool)
    numbers = np.array([vertex[source] for vertex in bm.verts], np.int64)
    kept[numbers[(numbers >= 0) & (numbers < len(wins))]] = True
    vertices = np.count_nonzero((stored_map.read_edit(mesh) == stored_map.MADE) & wins & ~kept)
    if vertices or faces:
        gone = f"{vertices:,} new vertices" if vertices else f"{faces:,} faces"
        raise mesh_data.MeshProblem(
            f"{gone} would be deleted on both sides. Nothing is changed. Detect again, or make the edit on both sides"
        )


def _taken(mesh, name):
    """Values of an attribute, which is removed."""
    values = mesh_data.read_attribute(mesh.attributes[name])
    mesh_data.remove_attribute(mesh, name)
    return values


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_symmetrize_topology,))
