# SPDX-License-Identifier: GPL-3.0-or-later
"""Detect: find the symmetry and keep it on the mesh; choose among several; exchange its sides; remove it."""

import bpy
import intrinsym
import numpy as np

from . import assembly, detection, labels, left_side, mesh_data, overlay, preferences, seams, stored_map
from .counterparts import listed
from .operator_base import MapOperator, MeshOperator, sentence
from .ops_positions import forget

#: The running detection, for the panel; only one at a time.
running = []


def keep(object, core_mesh, found, index=0):
    """Stores one of the symmetries found; returns the sentence for the user. Needs object mode."""
    mesh = object.data
    same_faces = all(map(np.array_equal, mesh_data.polygons(mesh), core_mesh.polygons))
    if not same_faces or len(mesh.vertices) != core_mesh.vertex_count:
        raise mesh_data.MeshProblem("The mesh was changed while its symmetry was being found: Detect again")
    left = left_side.left_of(object, found[index].side)
    stored_map.store(mesh, core_mesh, found[index], is_doubtful(found), left)
    mesh.update()
    if is_doubtful(found):
        overlay.show_doubt()
    return f"{in_words(found, index)}. Left from {left[1]}"


def is_doubtful(found):
    return found.outcome is intrinsym.Outcome.DOUBTFUL


def in_words(found, index=0):
    """What was found, how much of the mesh it speaks of, and what speaks against it."""
    family = ". One of a continuous family, as a sphere or a vase has" if found.continuous_family else ""
    coverage = found.report.symmetries[index].coverage
    said = f"{about(found[index])}{family}. {coverage}"
    return f"Doubtful: {said}. {sentence(found.evidence)}" if is_doubtful(found) else said


def _mirror_modifiers(objects):
    """A sentence that says which objects have a Mirror modifier, or nothing."""
    names = [each.name for each in objects if any(modifier.type == "MIRROR" for modifier in each.modifiers)]
    made = "the half that it makes is no part of the mesh. Apply it, then Detect again"
    return f". {listed(names)} has a Mirror modifier: {made}" if names else ""


# From this plausibility on nothing is said of it.
SURE = 0.95


def about(symmetry):
    """One symmetry and its numbers."""
    kind = "Reflection" if symmetry.kind == intrinsym.SymmetryKind.REFLECTION else "Half turn"
    exact = f", {symmetry.exact_share:.0%} from mirrored connectivity" if symmetry.exact_share > 0 else ""
    plausible = f", {symmetry.plausibility:.0%} plausible" if symmetry.plausibility < SURE else ""
    return f"{kind}, mean confidence {symmetry.mean_confidence:.2f}{exact}{plausible}"


class INTRINSIC_SYMMETRY_OT_detect(preferences.DetectOptions, MeshOperator, bpy.types.Operator):
    """Find the mirror image of every vertex, in any pose, and keep it on the mesh"""

    bl_idname = "intrinsic_symmetry.detect"
    bl_label = "Detect Symmetry"

    source: bpy.props.EnumProperty(
        name="Positions", description="Which shape of the mesh is looked at", items=detection.SOURCES
    )
    use_labels: bpy.props.BoolProperty(
        name="Use Corrections", description="Obey the signs that were set under Correct and Label", default=True
    )

    together: bpy.props.BoolProperty(
        name="Selected Objects Together",
        description="The selected meshes are one character, with one map over all of them",
        default=False,
    )

    def draw(self, _context):
        self.layout.use_property_split = True
        self.layout.prop(self, "source")
        self.layout.prop(self, "use_labels")
        self.layout.prop(self, "together")
        preferences.draw_options(self.layout, self)

    def execute(self, context):
        try:
            with mesh_data.object_mode(context):
                job = self._start(context)
                return self._finish(job)
        except (mesh_data.MeshProblem, intrinsym.IntrinsymError) as problem:
            self.report({"ERROR"}, sentence(problem))
            return {"CANCELLED"}

    def invoke(self, context, _event):
        if bpy.app.background:
            return self.execute(context)
        if running:
            self.report({"WARNING"}, "A detection is running already; Esc cancels it")
            return {"CANCELLED"}
        try:
            with mesh_data.object_mode(context) as object:
                self._job = self._start(context)
        except (mesh_data.MeshProblem, intrinsym.IntrinsymError) as problem:
            self.report({"ERROR"}, sentence(problem))
            return {"CANCELLED"}
        running.append(self._job)
        self._name = object.name
        manager = context.window_manager
        self._timer = manager.event_timer_add(0.1, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self._job.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self._job.is_running():
            self._show_progress(context)
            return {"PASS_THROUGH"}
        self._leave(context)
        return self._conclude(context)

    def cancel(self, context):
        """Blender's own: the window closes."""
        self._job.cancel()
        self._leave(context)

    def _start(self, context):
        self._members = assembly.selected(context) if self.together else [context.active_object]
        for member in self._members:
            stored_map.refuse_taken(member.data)
            stored_map.refuse_groups(member)
        arguments = self.arguments(context)
        alone = len(self._members) == 1
        signs = labels.known_signs(self._members[0].data) if self.use_labels and alone else []
        if signs:
            arguments["known_signs"] = signs
        if self.source == "EVALUATED" and not alone:
            raise mesh_data.MeshProblem("Several objects together: choose base positions or those of a shape key")
        with assembly.joined(self._members) as body:
            make = detection.maker_of(body, self.source, context.evaluated_depsgraph_get())
        return detection.Job(make, arguments)

    def _finish(self, job):
        """Waits for the worker and keeps what it found; object mode."""
        found, members = job.answer(), self._members
        if len(members) == 1:
            labels.take_predictions(members[0].data, found.report)
        halved = _mirror_modifiers(members)
        if not found:
            self.report({"WARNING"}, f"No symmetry found: {found.evidence}{halved}")
            return {"CANCELLED"}
        with assembly.whole(members) as body:
            text = keep(body, job.core_mesh, found)
            if len(members) > 1:
                seams.sort_partners(body, assembly.owners(body, members), job.core_mesh)
        if len(members) == 1:
            detection.remember(members[0].data, job.core_mesh, found)
        self.report({"WARNING" if is_doubtful(found) or halved else "INFO"}, text + halved)
        return {"FINISHED"}

    def _conclude(self, context):
        """The end of a modal run; the user may have gone to another object meanwhile."""
        object = context.active_object
        if object is None or object.name != self._name:
            self.report({"WARNING"}, f"{self._name} is not the active object any more: its symmetry was not kept")
            return {"CANCELLED"}
        try:
            with mesh_data.object_mode(context):
                return self._finish(self._job)
        except intrinsym.CancelledError:
            self.report({"INFO"}, "Cancelled")
        except (mesh_data.MeshProblem, intrinsym.IntrinsymError) as problem:
            self.report({"ERROR"}, sentence(problem))
        return {"CANCELLED"}

    def _show_progress(self, context):
        fraction = self._job.fraction
        context.window_manager.progress_update(100 * fraction)
        context.workspace.status_text_set(
            f"Detecting symmetry: {self._job.stage}, {fraction:.0%}   (Esc to cancel)"
        )
        for area in context.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()

    def _leave(self, context):
        running.remove(self._job)
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)


class INTRINSIC_SYMMETRY_OT_choose(MeshOperator, bpy.types.Operator):
    """Use another of the symmetries that were found (Preferences: Symmetries says how many are looked for)"""

    bl_idname = "intrinsic_symmetry.choose"
    bl_label = "Choose Symmetry"

    index: bpy.props.IntProperty(name="Number", description="1 is the best one", default=1, min=1, max=32)

    def run(self, _context, object, _mode):
        remembered = detection.remembered(object.data)
        if remembered is None:
            raise mesh_data.MeshProblem("Nothing was found on this mesh since Blender was started: Detect first")
        core_mesh, found = remembered
        if self.index > len(found):
            raise mesh_data.MeshProblem(f"There is no symmetry {self.index}: {len(found)} found")
        return keep(object, core_mesh, found, self.index - 1)


class INTRINSIC_SYMMETRY_OT_exchange_sides(MapOperator, bpy.types.Operator):
    """Call the left side right and the right side left"""

    bl_idname = "intrinsic_symmetry.exchange_sides"
    bl_label = "Exchange Sides"

    def run_with(self, _symmetry, _context, object, _mode):
        stored_map.name_sides(object.data, -1, "Exchange Sides")
        return "Left and right are exchanged"


class INTRINSIC_SYMMETRY_OT_clear(MeshOperator, bpy.types.Operator):
    """Remove the stored symmetry from the mesh, and what was remembered"""

    bl_idname = "intrinsic_symmetry.clear"
    bl_label = "Remove Symmetry"

    @classmethod
    def lacks(cls, _context, object):
        is_there = stored_map.RECORD in object.data or stored_map.remembered(object.data)
        return None if is_there else "No symmetry is stored on this mesh"

    def run(self, _context, object, _mode):
        stored_map.refuse_groups(object)
        stored_map.clear(object.data)
        forget(object.data)
        return "The symmetry was removed"


_register, _unregister = bpy.utils.register_classes_factory(
    (
        INTRINSIC_SYMMETRY_OT_detect,
        INTRINSIC_SYMMETRY_OT_choose,
        INTRINSIC_SYMMETRY_OT_exchange_sides,
        INTRINSIC_SYMMETRY_OT_clear,
    )
)


def register():
    _register()


def unregister():
    for job in running:
        job.cancel()
    detection.forget_all()
    _unregister()
