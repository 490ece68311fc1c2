# SPDX-License-Identifier: GPL-3.0-or-later
"""Detect on all selected objects, one after another; those of one connectivity share one map."""

from contextlib import nullcontext

import bpy
import intrinsym

from . import detection, left_side, mesh_data, ops_detect, preferences, stored_map
from .operator_base import MeshOperator, in_words

#: So many objects are named in the report.
_MOST_NAMES = 3


class INTRINSIC_SYMMETRY_OT_detect_selected(preferences.DetectOptions, MeshOperator, bpy.types.Operator):
    """Find the symmetry of each selected object by itself. One map serves all objects with the same faces, whatever
    their shape; an object that has a map keeps it"""

    bl_idname = "intrinsic_symmetry.detect_selected"
    bl_label = "Detect on Selected Objects"
    one_object = True

    again: bpy.props.BoolProperty(
        name="Detect Again", description="Do not use the maps that are there already", default=False
    )
    share: bpy.props.BoolProperty(
        name="Share Maps", description="Objects with the same faces take the map of the first of them", default=True
    )

    def draw(self, _context):
        self.layout.use_property_split = True
        self.layout.prop(self, "again")
        self.layout.prop(self, "share")
        preferences.draw_options(self.layout, self)

    @classmethod
    def poll(cls, context):
        with _on_mesh(context):
            return super().poll(context)

    def execute(self, context):
        with _on_mesh(context):
            return super().execute(context)

    def run(self, context, _object, _mode):
        batch = _Batch(context, self)
        while batch.left:
            batch.step(context)
        if batch.without:
            self.warn(self._conclude(batch))
            return ""
        return self._conclude(batch)

    def invoke(self, context, _event):
        if bpy.app.background or ops_detect.running:
            return self.execute(context)
        with _on_mesh(context):
            self._batch = _Batch(context, self)
        self._timer = context.window_manager.event_timer_add(0.05, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        batch = self._batch
        if event.type == "ESC" and event.value == "PRESS":
            batch.cancel()
        elif event.type != "TIMER":
            return {"PASS_THROUGH"}
        elif batch.left and self.poll(context) and not batch.is_busy():
            with _on_mesh(context), mesh_data.object_mode(context):
                batch.step(context, wait=False)
        context.workspace.status_text_set(f"Detecting symmetry: {len(batch.left)} objects left   (Esc to cancel)")
        if batch.left:
            return {"PASS_THROUGH"}
        self.cancel(context)
        self.report({"WARNING" if batch.without else "INFO"}, self._conclude(batch))
        return {"FINISHED"}

    def cancel(self, context):
        """Blender's own: the window closes."""
        self._batch.cancel()
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)

    def _conclude(self, batch):
        counts = (("found", batch.found), ("shared", batch.shared), ("kept", batch.kept), ("without", batch.without))
        said = [f"{len(names)} {word}{_named(names) if word == 'without' else ''}" for word, names in counts if names]
        return f"Symmetries: {', '.join(said) or 'none'}"


def _on_mesh(context):
    """A context where a selected mesh is active, if what is active is none."""
    active, selected = context.active_object, (each for each in context.selected_objects if each.type == "MESH")
    mesh = next(selected, None) if context.mode == "OBJECT" and getattr(active, "type", None) != "MESH" else None
    return context.temp_override(active_object=mesh, object=mesh) if mesh else nullcontext()


def _named(names):
    more = ", ..." if len(names) > _MOST_NAMES else ""
    return f" ({', '.join(names[:_MOST_NAMES])}{more})"


def _key(object):
    """Of an object among all: a linked one may have the name of one of this file."""
    return object.name, getattr(object.library, "filepath", None)


class _Batch:
    """What is left to do, keys of objects; and what was done, their names."""

    def __init__(self, context, operator):
        meshes = {object.data: object for object in context.selected_objects if object.type == "MESH"}
        meshes[context.active_object.data] = context.active_object
        self.left = [_key(object) for object in meshes.values()]
        self.found, self.shared, self.kept, self.without = [], [], [], []
        self._arguments, self._share = operator.arguments(context), operator.share
        self._job, self._maps = None, {}
        if not operator.again:
            self._keep_maps()

    def _keep_maps(self):
        """Objects that have a map which fits are done, and lend it."""
        for key in list(self.left):
            mesh = bpy.data.objects[key].data
            try:
                symmetry = stored_map.load(mesh)
            except stored_map.StaleMap:
                continue
            symmetry.fixed_curve = stored_map.fixed_lines(mesh)
            record = mesh[stored_map.RECORD]
            self._maps.setdefault(record["connectivity"], (symmetry, record["doubtful"]))
            self.kept.append(key[0])
            self.left.remove(key)

    def is_busy(self):
        return self._job is not None and self._job.is_running()

    def cancel(self):
        """Nothing is left to do; what was done stays."""
        self.left.clear()
        if self._job is not None:
            self._job.cancel()

    def step(self, context, wait=True):
        """Starts the next object, or ends it; object mode. `wait`: does both."""
        object = bpy.data.objects.get(self.left[0])
        if object is None:  # deleted meanwhile
            self.left.pop(0)
            return
        try:
            if problem := mesh_data.why_fixed(object):
                raise mesh_data.MeshProblem(f"the mesh {problem}")
            if self._job is None and not self._begin(context, object):
                return
            if wait or not self._job.is_running():
                self._end(object)
        except (mesh_data.MeshProblem, intrinsym.IntrinsymError) as problem:
            self._job = None
            self.without.append(f"{self.left.pop(0)[0]}: {in_words(problem)}")

    def _begin(self, context, object):
        """Takes over a map, or starts the worker; whether there is a worker."""
        core_mesh = detection.core_mesh_of(object, "BASE", context.evaluated_depsgraph_get())
        known = self._maps.get(f"{core_mesh.connectivity_hash:016x}") if self._share else None
        if known is None:
            self._job = detection.Job(lambda: core_mesh, self._arguments)
            return True
        symmetry, is_doubtful = known
        left = left_side.left_of(object, symmetry.side)
        stored_map.store(object.data, core_mesh, symmetry, is_doubtful, left)
        self.shared.append(self.left.pop(0)[0])
        return False

    def _end(self, object):
        job, self._job = self._job, None
        found = job.answer()
        name, _ = self.left.pop(0)
        if not found:
            self.without.append(name)
            return
        ops_detect.keep(object, job.core_mesh, found)
        detection.remember(object.data, job.core_mesh, found)
        self._maps[f"{job.core_mesh.connectivity_hash:016x}"] = (found[0], ops_detect.is_doubtful(found))
        self.found.append(name)


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_detect_selected,))
