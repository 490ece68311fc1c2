# SPDX-License-Identifier: GPL-3.0-or-later
"""Carries the stored map through an edit of vertices and faces.

Each vertex keeps a number, as an INT and as a FLOAT (`stored_map.NUMBERS`). Blender copies the first to new vertices
and interpolates the second, so that they agree on old vertices and their duplicates alone. `carried_map` does the rest.
"""

import intrinsym
import numpy as np

from . import mesh_data, stored_map, undo
from .carried_map import CarriedMap

#: Less than this share of the old vertices: the map is not carried.
_LEAST_LEFT = 0.5


def loaded(mesh):
    """The stored map, carried where the mesh was edited, and in words what was carried. Raises StaleMap."""
    try:
        return stored_map.load(mesh), ""
    except stored_map.ChangedMesh:
        if not stored_map.may_be_carried(mesh):
            raise
    said = _bring(mesh)
    return stored_map.load(mesh), said


def _bring(mesh):
    """Stores the map that fits the edited mesh; in words, what was done. Raises StaleMap where too much has changed."""
    record = mesh[stored_map.RECORD].to_dict()
    core_mesh = intrinsym.Mesh(mesh_data.positions(mesh), mesh_data.polygons(mesh))
    new_of, original = _identities(mesh, record)
    carried = CarriedMap(mesh, core_mesh, new_of, original)
    symmetry = carried.found(intrinsym.SymmetryKind(record["kind"]))
    symmetry.fixed_curve = _lines(mesh, new_of)
    left = (1, record["left_from"])
    stored_map.store(mesh, core_mesh, symmetry, record.get("doubtful", False), left, record["exact_share"])
    if carried.extruded.any():
        mesh_data.write_attribute(mesh, stored_map.EXTRUDED, "BOOLEAN", carried.extruded)
    return f"The symmetry was carried through an edit: {np.count_nonzero(carried.new):,} vertices are new"


def _identities(mesh, record):
    """(old vertices,) their new numbers, -1 if gone; (vertices,) the old number of each one or of what it duplicates, -1
    if neither. Raises StaleMap."""
    own, mixed = (mesh_data.read_attribute(mesh.attributes[name]) for name in stored_map.NUMBERS)
    belongs = mesh_data.read_attribute(mesh.attributes[undo.NUMBER]) == undo.number_of(record)
    old = own.astype(np.int64) - 1
    original = np.where(belongs & (own == mixed) & (old >= 0) & (old < record["vertices"]), old, -1)
    new_of = np.full(record["vertices"], -1)
    there = np.flatnonzero(original >= 0)[::-1]
    new_of[original[there]] = there  # the first of several
    if (new_of >= 0).mean() < _LEAST_LEFT:
        raise stored_map.ChangedMesh
    return new_of, original


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
