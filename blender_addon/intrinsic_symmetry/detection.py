# SPDX-License-Identifier: GPL-3.0-or-later
"""One detection: what it works on, the worker thread, and what was found on each mesh in this session."""

import threading

import bpy
import intrinsym

from . import mesh_data

#: What `positions_of` understands, as Blender's enum items.
SOURCES = (
    ("BASE", "Base", "Positions of the mesh itself, without shape keys and modifiers"),
    ("KEY", "Shape Key", "Positions of the active shape key"),
    ("EVALUATED", "Evaluated", "Positions after all shape keys and modifiers, as the viewport shows them"),
)

#: Several symmetries of a mesh, by its session_uid; gone when Blender closes.
_found = {}


def positions_of(object, source, depsgraph):
    """(vertices, 3) float32. Raises MeshProblem."""
    if source == "EVALUATED":
        return mesh_data.evaluated_positions(object, depsgraph)
    if source == "KEY":
        return mesh_data.shown_positions(object)
    return mesh_data.positions(object.data)


def core_mesh_of(object, source, depsgraph):
    """The mesh as the library takes it. Raises MeshProblem, intrinsym.IntrinsymError."""
    return maker_of(object, source, depsgraph)()


def maker_of(object, source, depsgraph):
    """What makes the mesh as the library takes it, in any thread: half a second for 100,000 vertices. Raises MeshProblem;
    what it returns, intrinsym.IntrinsymError."""
    points, polygons = positions_of(object, source, depsgraph), mesh_data.polygons(object.data)
    return lambda: intrinsym.Mesh(points, polygons)


class Job:
    """A detection in a thread of its own, which makes the mesh, too."""

    def __init__(self, make_core_mesh, arguments):
        self.core_mesh, self._make = None, make_core_mesh
        self.stage, self.fraction = "", 0.0
        self._arguments = arguments
        self._progress = intrinsym.Progress(self._report)
        self._answer = self._error = None
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def _report(self, stage, fraction):
        self.stage, self.fraction = stage, fraction

    def _work(self):
        try:
            self.core_mesh = self._make()
            self._answer = self.core_mesh.detect(progress=self._progress, **self._arguments)
        except Exception as error:  # it is raised in the main thread, by `answer`
            self._error = error

    def cancel(self):
        self._progress.cancel()

    def is_running(self):
        return self._thread.is_alive()

    def answer(self):
        """Waits for the `intrinsym.Detection`, or raises the error of the worker."""
        self._thread.join()
        if self._error is not None:
            raise self._error
        return self._answer


def remember(mesh, core_mesh, found):
    """Keeps all symmetries that were found, so that the user can choose among them, as long as the mesh is there."""
    there = {other.session_uid for other in bpy.data.meshes}
    for gone in _found.keys() - there:
        del _found[gone]
    _found[mesh.session_uid] = (core_mesh, found)


def remembered(mesh):
    """(core mesh, detection) of this session, or nothing."""
    return _found.get(mesh.session_uid)


def forget_all():
    _found.clear()
