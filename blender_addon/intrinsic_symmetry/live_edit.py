# SPDX-License-Identifier: GPL-3.0-or-later
"""The vertices of a mesh in edit mode, read and written fast enough for every frame.

A BMesh gives no arrays. But a vertex' `co` is a view of its place, so a kept list of them shows at once what has moved:
comparing it with a list of copies takes a ninth of the time that reading the numbers does. The loops over such lists
run in C, and make no containers that would wake the garbage collector.
"""

import operator
import time
from collections import deque
from itertools import chain, repeat

import bmesh
import bpy
import numpy as np

from . import mesh_data
from .live_carry import differing

#: With a larger share of the vertices written, the normals of all are computed, between the updates: not again until so
#: many times what they took has passed. Shading may lag; positions do not.
_MANY_NORMALS, _REST = 0.3, 4


def counts(mesh):
    """Numbers of vertices and edges, in any mode."""
    if mesh.is_editmode:
        bm = bmesh.from_edit_mesh(mesh)
        return len(bm.verts), len(bm.edges)
    return len(mesh.vertices), len(mesh.edges)


def topology(object):
    """The counts and the polygons, in any mode."""
    if object.data.is_editmode:
        object.update_from_editmode()
    return counts(object.data), mesh_data.polygons(object.data)


def has(object, known, only_counts):
    """Whether an object has a known topology."""
    if counts(object.data) != known[0]:
        return False
    return only_counts or all(map(np.array_equal, known[1], topology(object)[1]))


def _chosen(all, numbers):
    """Of a list, those with the given numbers."""
    return [all[number] for number in numbers.tolist()]


def _numbers(vectors):
    """(vectors, 3) float32."""
    numbers = chain.from_iterable(map(operator.itemgetter(slice(None)), vectors))
    return np.fromiter(numbers, np.float32, 3 * len(vectors)).reshape(-1, 3)


def _places(values):
    """One (x, y, z) after another, of (vectors, 3)."""
    return zip(*(column.tolist() for column in values.T))


def _put(vectors, places):
    deque(map(operator.setitem, vectors, repeat(slice(None)), places), maxlen=0)


class EditVertices:
    """Those of one BMesh, as long as it lives and nothing is added or removed.

    Vertices that an operation has moved are read number by number; the others are compared with copies.
    """

    def __init__(self, mesh, polygons):
        self._mesh, self.bm, self._polygons = mesh, bmesh.from_edit_mesh(mesh), polygons
        self.bm.verts.ensure_lookup_table()
        self.bm.verts.index_update()
        self.vertices, self._faces = list(self.bm.verts), list(self.bm.faces)
        self._views = [vertex.co for vertex in self.vertices]
        self._copies = [view.copy() for view in self._views]
        self.values = _numbers(self._views)
        self._written = self._around = None
        self._old_normals, self._normals_at = False, 0.0
        self._watch(np.zeros(len(self._views), bool))

    def is_alive(self):
        return self.bm.is_valid and bmesh.from_edit_mesh(self._mesh) is self.bm

    def _watch(self, moving):
        """From now on the moving vertices, (vertices,) bool, are read, and the others are compared."""
        self._moving, self._still = np.flatnonzero(moving), np.flatnonzero(~moving)
        self._moving_views = _chosen(self._views, self._moving)
        self._still_views, self._still_copies = (_chosen(all, self._still) for all in (self._views, self._copies))

    def read(self):
        """Vertices that are not where `values` has them any more, and their places."""
        if self._still_views != self._still_copies:
            differs = np.fromiter(map(operator.ne, self._still_views, self._still_copies), bool, len(self._still))
            moving = np.zeros(len(self._views), bool)
            moving[self._moving] = moving[self._still[differs]] = True
            self._watch(moving)
        found = _numbers(self._moving_views)
        new = differing(found, self.values[self._moving])
        vertices, found = self._moving[new], found[new]
        self.values[vertices] = found
        return vertices, found

    def rest(self):
        """The operation is over: the next one may move others."""
        if self._old_normals:
            self._update_normals()
        if len(self._moving):
            _put(_chosen(self._copies, self._moving), _places(self.values[self._moving]))
            self._watch(np.zeros(len(self._views), bool))

    def write(self, vertices, values):
        if vertices is not self._written:
            self._written, self._around = vertices, self._elements_around(vertices)
            self._written_views, self._written_copies = (_chosen(all, vertices) for all in (self._views, self._copies))
        _put(self._written_views, _places(values))
        _put(self._written_copies, self._written_views)
        self.values[vertices] = values
        if len(vertices) <= _MANY_NORMALS * len(self._views):
            deque(map(operator.methodcaller("normal_update"), self._around), maxlen=0)
        else:
            self._old_normals = True
        bmesh.update_edit_mesh(self._mesh, loop_triangles=True, destructive=False)
        return values

    def catch_up(self):
        """There is time between two updates."""
        if self._old_normals and time.perf_counter() >= self._normals_at:
            self._update_normals()

    def _update_normals(self):
        begun = time.perf_counter()
        self.bm.normal_update()
        bmesh.update_edit_mesh(self._mesh, loop_triangles=False, destructive=False)
        self._old_normals, ended = False, time.perf_counter()
        self._normals_at = ended + _REST * (ended - begun)

    def _elements_around(self, vertices):
        """The faces of vertices, then the vertices of those faces: what has another normal if the vertices move."""
        offsets, corners = self._polygons
        chosen, near = np.zeros((2, len(self._views)), bool)
        chosen[vertices] = True
        faces = np.zeros(len(self._faces), bool)
        faces[np.repeat(np.arange(len(faces)), np.diff(offsets))[chosen[corners]]] = True
        near[corners[np.repeat(faces, np.diff(offsets))]] = True
        return _chosen(self._faces, np.flatnonzero(faces)) + _chosen(self.vertices, np.flatnonzero(near))

    def flags_of(self, name):
        """(vertices,) bool: `select` or `hide`."""
        return np.fromiter(map(operator.attrgetter(name), self.vertices), bool, len(self.vertices))


class Positions:
    """What positions become on their way to the other side. Mix in before what reads and writes them."""

    turns = True

    @staticmethod
    def carrier(of_vertices):
        return of_vertices

    @staticmethod
    def carried(plan, base, current):
        plan.change[plan.sources] = current[plan.sources] - base[plan.sources].astype(float)
        return plan.route.together(plan.route.turned(plan.route.carry(plan.change)), plan.change)

    @staticmethod
    def on_line(carrier, vertices, base, current):
        return base[vertices] + carrier.clamped(vertices, current[vertices] - base[vertices].astype(float))


class EditChannel(Positions, EditVertices):
    """Positions in edit mode."""

    def __init__(self, object, polygons):
        super().__init__(object.data, polygons)
        self.key = "EDIT", mesh_data.key_name(object)

    @staticmethod
    def is_busy():
        return False

    @staticmethod
    def operation():
        """The transformation that the user is in the middle of: its steps start from the same positions."""
        for window in bpy.context.window_manager.windows:
            for running in window.modal_operators:
                if running.bl_idname.startswith("TRANSFORM_OT_"):
                    return running.as_pointer()
        return None

    def flags(self, lit):
        """The user's own selection, what may not be written, and how much arrives."""
        selected = self.flags_of("select")
        return selected if lit is None else selected & ~lit, self.flags_of("hide"), None
