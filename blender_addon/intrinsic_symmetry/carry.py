# SPDX-License-Identifier: GPL-3.0-or-later
"""Carries the stored map through an edit of vertices and faces.

Each vertex keeps its number, as an INT and scattered as a FLOAT (`stored_map.NUMBERS`). Blender copies the first to new
vertices or mixes it, and mixes the second, so that they agree on old vertices and their duplicates alone.
`carried_map` does the rest.
"""

import intrinsym
import numpy as np

from . import edit_moves, mesh_data, stored_map, undo
from .carried_map import CarriedMap
from .regions import components

#: Less than this share of the old vertices: the map is not carried.
_LEAST_LEFT = 0.5
#: By how much the float may differ, and the number of the record: Blender mixes some old vertices with themselves.
_SAME, _ROUNDED = 1e-5, 128


def loaded(mesh):
    """The stored map, carried where the mesh was edited, and in words what was carried. Raises MeshProblem."""
    stored_map.refuse_taken(mesh)
    try:
        return stored_map.load(mesh), ""
    except stored_map.ChangedMesh:
        if not stored_map.may_be_carried(mesh) or mesh_data.is_linked(mesh):
            raise
    said = _bring(mesh)
    return stored_map.load(mesh), said


def _bring(mesh):
    """Stores the map that fits the edited mesh; in words, what was done. Raises StaleMap where too much has changed."""
    record = mesh[stored_map.RECORD].to_dict()
    core_mesh = intrinsym.Mesh(mesh_data.positions(mesh), mesh_data.polygons(mesh))
    new_of, original, ours = _identities(mesh, record)
    carried = CarriedMap(mesh, core_mesh, new_of, original, ours)
    symmetry = carried.found(intrinsym.SymmetryKind(record["kind"]))
    symmetry.fixed_curve, lift, edit = _lines(mesh, new_of), carried.lifted(), carried.edit()
    moved = carried.moved()
    left = (1, record["left_from"])
    stored_map.store(mesh, core_mesh, symmetry, record.get("doubtful", False), left, record["exact_share"])
    edits = np.array(carried.edits)
    side = int(np.sign(edits[0] - edits[1])) or record.get("edited_side", 0)
    mesh[stored_map.RECORD].update({"edited": (edits + record.get("edited", (0, 0))).tolist(), "edited_side": side})
    if lift.any():
        mesh_data.write_attribute(mesh, stored_map.LIFT, "FLOAT_VECTOR", lift)
    if moved.any():
        mesh_data.write_attribute(mesh, stored_map.MOVED, "FLOAT_VECTOR", moved)
    if edit.any():
        mesh_data.write_attribute(mesh, stored_map.EDIT, "INT", edit)
    lost = f", {carried.lost:,} have lost their mirror image" if carried.lost else ""
    return f"The symmetry was carried through an edit: {np.count_nonzero(carried.new):,} vertices are new{lost}"


def _identities(mesh, record):
    """(old vertices,) their new numbers, -1 if gone; (vertices,) the old number of each one or of what it duplicates,
    -1 if neither; (vertices,) bool, whether it was made of old ones. Raises StaleMap."""
    own, mixed = (mesh_data.read_attribute(mesh.attributes[name]) for name in stored_map.NUMBERS)
    number = mesh_data.read_attribute(mesh.attributes[undo.NUMBER]).astype(np.int64)
    belongs = np.abs(number - undo.number_of(record)) <= _ROUNDED
    same = np.abs(mixed - stored_map.scattered(own)) <= _SAME
    old = own.astype(np.int64) - 1
    original = np.where(belongs & same & (old >= 0) & (old < record["vertices"]), old, -1)
    new_of = np.full(record["vertices"], -1)
    there = np.flatnonzero(original >= 0)[::-1]
    there = there[np.argsort(-np.linalg.norm(edit_moves.since_stored(mesh)[there], axis=1), kind="stable")]
    new_of[original[there]] = there  # of several the first one that is nearest to where it was
    astray = _astray(mesh, new_of, original)
    torn = _torn(mesh, new_of, original, astray)
    new_of[original[torn]] = -1
    original[astray | torn] = -1
    if (new_of >= 0).mean() < _LEAST_LEFT:
        raise stored_map.ChangedMesh
    return new_of, original, belongs


def _astray(mesh, new_of, original):
    """(vertices,) bool: duplicates that no edges between duplicates join to their original: those of a subdivision. What
    was split off is no longer connected to it."""
    ends = mesh_data.edges(mesh).astype(np.int64)
    shell = components(len(original), ends)
    ends = ends[(original[ends[:, 0]] == original[ends[:, 1]]) & (original[ends[:, 0]] >= 0)]
    group = components(len(original), ends)
    first = new_of[original]
    return (original >= 0) & (group != group[first]) & (shell == shell[first])


def _torn(mesh, new_of, original, astray):
    """(vertices,) bool: where the surface was torn along the line, those that were on it: at one place with a duplicate that is
    `astray`, (vertices,) bool, and each with one side alone."""
    offsets, corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
    side, places = mesh_data.read_attribute(mesh.attributes[stored_map.SIDE]), mesh_data.positions(mesh)
    both = np.ones(len(side), bool)
    for at in (1, -1):
        faces = np.logical_or.reduceat((side == at)[corners], offsets[:-1])
        both &= np.isin(np.arange(len(side)), corners[np.repeat(faces, np.diff(offsets))])
    rows = np.flatnonzero(astray & (side == 0) & ~both)
    first = new_of[original[rows]]
    rows = rows[~both[first] & (places[rows] == places[first]).all(axis=1)]
    return np.isin(original, original[rows]) & ~both


def _lines(mesh, new_of):
    """The line between left and right, without points whose vertices are gone."""
    lines = []
    for line in stored_map.fixed_lines(mesh):
        edges = new_of[line.edges]
        there = (edges >= 0).all(axis=1)
        if there.sum() > 1:
            closed = line.closed and bool(there.all())
            lines.append(intrinsym.CurveLine(edges[there].astype(np.uint32), line.parameters[there], closed))
    return lines
