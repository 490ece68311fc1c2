# SPDX-License-Identifier: GPL-3.0-or-later
"""Correct and label: look at eigenfunctions, say which are even or odd, and save that for training."""

from pathlib import Path

import bpy
import intrinsym
import numpy as np

from . import detection, eigenfunctions, label_file, labels, mesh_data, overlay, preferences
from .operator_base import MeshOperator

#: As many as the network judges; a known sign of a higher one changes little.
COUNT = 12
#: An eigenfunction is the same on two triangulations if the cosine between them is at least this.
_SAME = 0.9


class INTRINSIC_SYMMETRY_OT_study(MeshOperator, bpy.types.Operator):
    """Show the eigenfunctions of the mesh as colors, with what the network says of each"""

    bl_idname = "intrinsic_symmetry.study"
    bl_label = "Show Eigenfunctions"

    source: bpy.props.EnumProperty(
        name="Positions", description="Which shape of the mesh is looked at", items=detection.SOURCES
    )

    def run(self, context, object, _mode):
        mesh = object.data
        core_mesh = detection.core_mesh_of(object, self.source, context.evaluated_depsgraph_get())
        found = eigenfunctions.study(mesh, core_mesh, COUNT)
        if not any(labels.network_says(entry) for entry in labels.of(mesh)):
            # One symmetry may be told by the connectivity alone, without eigenfunctions; several never are.
            arguments = preferences.detect_arguments(context)
            arguments["symmetries"] = max(2, arguments.get("symmetries", 1))
            answer = core_mesh.detect(**arguments)
            labels.take_predictions(mesh, answer.report)
        labels.make_entries(mesh, found.pairs.functions.shape[1])
        mesh.intrinsic_symmetry_eigenfunction = max(1, mesh.intrinsic_symmetry_eigenfunction)
        overlay.settings(context).colours = "EIGENFUNCTION"
        return f"{found.pairs.functions.shape[1]} eigenfunctions: say of each whether it is even or odd"


class INTRINSIC_SYMMETRY_OT_step(MeshOperator, bpy.types.Operator):
    """Show the next or the previous eigenfunction"""

    bl_idname = "intrinsic_symmetry.step"
    bl_label = "Step"

    by: bpy.props.IntProperty(name="By", description="How many forward; backward if negative", default=1)

    def run(self, context, object, _mode):
        mesh = object.data
        count = len(labels.of(mesh))
        if eigenfunctions.studied(mesh) is None or count == 0:
            raise mesh_data.MeshProblem("No eigenfunctions are shown: Show Eigenfunctions first")
        mesh.intrinsic_symmetry_eigenfunction = (mesh.intrinsic_symmetry_eigenfunction - 1 + self.by) % count + 1
        overlay.redraw(context=context)


class INTRINSIC_SYMMETRY_OT_judge(MeshOperator, bpy.types.Operator):
    """Say what the shown eigenfunction is; the next Detect obeys"""

    bl_idname = "intrinsic_symmetry.judge"
    bl_label = "Judge Eigenfunction"

    judgement: bpy.props.EnumProperty(name="Judgement", description="What you see", items=labels.JUDGEMENTS)

    def run(self, _context, object, _mode):
        entry = labels.active(object.data)
        if entry is None:
            raise mesh_data.MeshProblem("No eigenfunctions are shown: Show Eigenfunctions first")
        entry.judgement = self.judgement


class INTRINSIC_SYMMETRY_OT_forget_judgements(MeshOperator, bpy.types.Operator):
    """Forget what was said of every eigenfunction of this mesh"""

    bl_idname = "intrinsic_symmetry.forget_judgements"
    bl_label = "Forget Corrections"

    def run(self, _context, object, _mode):
        for entry in labels.of(object.data):
            entry.judgement = "UNJUDGED"


class INTRINSIC_SYMMETRY_OT_save_labels(MeshOperator, bpy.types.Operator):
    """Save the judgements and the mesh as training data of the sign network: two files in a folder"""

    bl_idname = "intrinsic_symmetry.save_labels"
    bl_label = "Save Labels"

    directory: bpy.props.StringProperty(name="Folder", description="Where the two files go", subtype="DIR_PATH")

    def invoke(self, context, _event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def run(self, _context, object, _mode):
        mesh = object.data
        judged = labels.judged(mesh)
        studied = eigenfunctions.studied(mesh)
        if studied is None or not judged:
            raise mesh_data.MeshProblem("Nothing is judged: Show Eigenfunctions, and say even, odd or neither")
        if not self.directory:
            raise mesh_data.MeshProblem("Choose a folder for the labels")
        folder = Path(bpy.path.abspath(self.directory))
        if not folder.is_dir():
            raise mesh_data.MeshProblem(f"There is no folder {folder}")
        vertices, triangles = studied.core_mesh.vertices.astype("<f4"), _triangles(mesh)
        same = eigenfunctions.likeness(studied.pairs, intrinsym.eigen(vertices, triangles, COUNT)) >= _SAME
        kept = {number: label for number, label in judged.items() if number <= len(same) and same[number - 1]}
        if not kept:
            raise mesh_data.MeshProblem("As triangles the mesh has other eigenfunctions: triangulate it, then judge")
        try:
            label_file.write(folder, bpy.path.clean_name(object.name), vertices, triangles, kept)
        except OSError as problem:
            raise mesh_data.MeshProblem(str(problem)) from None
        left_out = f"; {len(judged) - len(kept)} left out that differ on triangles" if len(kept) < len(judged) else ""
        return f"{len(kept)} labels saved in {folder}{left_out}"


def _triangles(mesh):
    mesh.calc_loop_triangles()
    corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return corners.reshape(-1, 3)


_register, _unregister = bpy.utils.register_classes_factory(
    (
        INTRINSIC_SYMMETRY_OT_study,
        INTRINSIC_SYMMETRY_OT_step,
        INTRINSIC_SYMMETRY_OT_judge,
        INTRINSIC_SYMMETRY_OT_forget_judgements,
        INTRINSIC_SYMMETRY_OT_save_labels,
    )
)


def register():
    _register()


def unregister():
    eigenfunctions.forget_all()
    _unregister()
