# SPDX-License-Identifier: GPL-3.0-or-later
"""Export and import of the pairs of vertices."""

import bpy
import intrinsym
import numpy as np
from bpy_extras.io_utils import ExportHelper, ImportHelper

from . import asymmetry, left_side, mesh_data, pairs_check, pairs_file, stored_map, vertex_map
from .operator_base import MapOperator, MeshOperator


class INTRINSIC_SYMMETRY_OT_export_pairs(ExportHelper, MapOperator, bpy.types.Operator):
    """Save which vertex is the mirror image of which, with confidence, side and exact place, as CSV or JSON"""

    bl_idname = "intrinsic_symmetry.export_pairs"
    bl_label = "Export Symmetry Pairs"
    one_object = only_reads = True

    file_type: bpy.props.EnumProperty(
        name="Format",
        description="What is written",
        items=((".csv", "CSV", "A table, one row a vertex"), (".json", "JSON", "All of it, with the line in between")),
    )
    filter_glob: bpy.props.StringProperty(default="*.csv;*.json", options={"HIDDEN"})

    @property
    def filename_ext(self):
        return self.file_type

    def run_with(self, symmetry, _context, object, _mode):
        path = bpy.path.abspath(self.filepath)
        if bpy.path.basename(path) and not path.lower().endswith((".csv", ".json")):
            path += self.file_type
        try:
            pairs_file.write(path, _columns(symmetry), _about(symmetry, object.data))
        except OSError as problem:
            raise mesh_data.MeshProblem(f'The file "{path}" cannot be written: {problem.strerror}') from None
        return f"{np.count_nonzero(symmetry.partner >= 0):,} vertices with a mirror image saved in {path}"


class INTRINSIC_SYMMETRY_OT_import_pairs(ImportHelper, MeshOperator, bpy.types.Operator):
    """Take pairs of vertices from a CSV, JSON or MAP file as the symmetry of this mesh"""

    bl_idname = "intrinsic_symmetry.import_pairs"
    bl_label = "Import Symmetry Pairs"
    one_object = True

    filter_glob: bpy.props.StringProperty(default="*.csv;*.json;*.map", options={"HIDDEN"})

    def run(self, _context, object, _mode):
        mesh = object.data
        try:
            columns, about = pairs_file.read(bpy.path.abspath(self.filepath))
        except FileNotFoundError:
            raise mesh_data.MeshProblem(f'There is no file "{self.filepath}"') from None
        except OSError as problem:
            raise mesh_data.MeshProblem(f'The file "{self.filepath}" cannot be read: {problem.strerror}') from None
        core_mesh = intrinsym.Mesh(mesh_data.positions(mesh), mesh_data.polygons(mesh))
        pairs_check.check(columns, about, mesh, core_mesh)
        symmetry = _restored(core_mesh, mesh, columns, about)
        left = (1, "the file") if "side" in columns else left_side.left_of(object, symmetry.side)
        stored_map.store(mesh, core_mesh, symmetry, left=left)
        mesh.update()
        more = "" if "side" in columns else "; left and right are those of the mirror plane that fits best"
        paired = np.count_nonzero(symmetry.partner >= 0)
        return f"{paired:,} of {len(mesh.vertices):,} vertices have a mirror image{more}"


def _columns(symmetry):
    points = symmetry.surface_points
    signed = {"face": points.faces, **{f"corner_{place}": points.corners[:, place] for place in range(3)}}
    return {
        "partner": symmetry.partner,
        "confidence": symmetry.confidence,
        "side": symmetry.side,
        **{name: np.where(values == vertex_map.NONE, -1, values.astype(np.int64)) for name, values in signed.items()},
        **{f"weight_{place}": points.barycentrics[:, place] for place in range(3)},
    }


def _about(symmetry, mesh):
    lines = [
        {"edges": line.edges.tolist(), "parameters": line.parameters.tolist(), "closed": line.closed}
        for line in stored_map.fixed_lines(mesh)
    ]
    return {
        "vertices": len(mesh.vertices),
        "connectivity": mesh[stored_map.RECORD]["connectivity"],
        "kind": symmetry.kind.name.lower(),
        "lines": lines,
    }


def _restored(core_mesh, mesh, columns, about):
    partner = columns["partner"]
    found = partner >= 0
    kind = intrinsym.SymmetryKind[about.get("kind", pairs_file.KINDS[0]).upper()]
    points = _surface_points(core_mesh, columns)
    side = columns["side"] if "side" in columns else _sides(mesh, partner)
    symmetry = core_mesh.restore(kind, partner, columns.get("confidence", found.astype(float)), side, points)
    symmetry.fixed_curve = [
        intrinsym.CurveLine(line.edges.astype(np.uint32), line.parameters.astype(np.float32), line.closed)
        for line in about.get("lines", ())
    ]
    return symmetry


def _surface_points(core_mesh, columns):
    """The exact images; at the partners themselves where the file does not say them."""
    if all(name in columns for name in pairs_file.COLUMNS):
        corners = np.stack([columns[f"corner_{place}"] for place in range(3)], axis=1)
        weights = np.stack([columns[f"weight_{place}"] for place in range(3)], axis=1)
        return intrinsym.SurfacePoints(vertex_map.unsigned(columns["face"]), vertex_map.unsigned(corners), weights)
    return vertex_map.at_vertices(core_mesh, columns["partner"])


def _sides(mesh, partner):
    """Sides of the plane whose reflection brings the partners nearest; 0 where a vertex is its own."""
    positions, own = mesh_data.positions(mesh).astype(float), np.arange(len(partner))
    paired = np.flatnonzero((partner >= 0) & (partner != own))
    if not len(paired):
        raise mesh_data.MeshProblem("The file holds no pair of two vertices")
    plane = asymmetry.fitted_plane(positions[paired], positions[partner[paired]], np.ones(len(paired)))
    side = np.zeros(len(partner), np.int8)
    # The farther of two partners decides, so that they are never on one side.
    height = positions @ plane.normal - plane.offset
    side[paired] = np.where(height[paired] > height[partner[paired]], 1, -1)
    return side


register, unregister = bpy.utils.register_classes_factory(
    (INTRINSIC_SYMMETRY_OT_export_pairs, INTRINSIC_SYMMETRY_OT_import_pairs)
)
