# SPDX-License-Identifier: GPL-3.0-or-later
"""The vertices of a mesh in edit mode, read and written fast enough for every frame.

A BMesh gives no arrays. But a vertex' `co` is a view of its place, so a kept list of them shows at once what has moved:
comparing it with copies takes a fifth of the time that reading the numbers does.
"""

import operator
from itertools import chain

import bmesh
import bpy
import numpy as np

from . import mesh_data

#: With a larger share of the vertices moving, all are read, and no copies are kept.
_MANY = 0.25
#: With a larger share of the vertices written, the normals of all are computed.
_MANY_NORMALS = 0.3


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


class EditVertices:
    """Those of one BMesh, as long as it lives and nothing is added or removed."""

    def __init__(self, mesh):
        self._mesh, self.bm = mesh, bmesh.from_edit_mesh(mesh)
        self.bm.verts.ensure_lookup_table()
        self.bm.verts.index_update()
        self.vertices = list(self.bm.verts)
        self._views = [vertex.co for vertex in self.vertices]
        self._copies, self._around = None, ([], [], [])
        self.values = self.read_all()
        self._many = False

    def is_alive(self):
        return self.bm.is_valid and bmesh.from_edit_mesh(self._mesh) is self.bm

    def read_all(self):
        numbers = chain.from_iterable(map(operator.itemgetter(slice(None)), self._views))
        return np.fromiter(numbers, np.float32, 3 * len(self._views)).reshape(-1, 3)

    def read(self, moving):
        """Vertices that are not where `values` has them any more, and their places. `moving`, (vertices,) bool, have
        moved before: they are compared number by number, the others as Blender compares vectors."""
        if self._many or moving.mean() > _MANY:
            self._many, self._copies = True, None
            found = self.read_all()
            vertices = np.flatnonzero((found != self.values).any(axis=1))
            self.values[vertices] = found[vertices]
            return vertices, found[vertices]
        if self._copies is None:
            self._copies = [view.copy() for view in self._views]
            self._copies_of(self.values)
        differs = np.fromiter(map(operator.ne, self._views, self._copies), bool, len(self._views))
        return self._take(np.flatnonzero(differs | moving))

    def _copies_of(self, values):
        """Copies are of what was read last, which may be a moment ago."""
        now = self.read_all()
        for vertex in np.flatnonzero((now != values).any(axis=1)).tolist():
            self._copies[vertex][:] = values[vertex].tolist()

    def _take(self, vertices):
        places = [self._views[vertex][:] for vertex in vertices.tolist()]
        found = np.array(places, np.float32).reshape(-1, 3)
        new = (found != self.values[vertices]).any(axis=1)
        vertices, found = vertices[new], found[new]
        self.values[vertices] = found
        self._copy(vertices)
        return vertices, found

    def _copy(self, vertices):
        if self._copies is not None:
            for vertex in vertices.tolist():
                self._copies[vertex] = self._views[vertex].copy()

    def rest(self):
        """The operation is over: the next one may move fewer."""
        self._many = False

    def write(self, vertices, values):
        chosen = vertices.tolist()
        for vertex, place in zip(chosen, values.tolist()):
            self.vertices[vertex].co = place
        self.values[vertices] = values
        self._copy(vertices)
        if len(chosen) > _MANY_NORMALS * len(self.vertices):
            self.bm.normal_update()
        else:
            self._update_normals(chosen)
        bmesh.update_edit_mesh(self._mesh, loop_triangles=True, destructive=False)
        return values

    def _update_normals(self, chosen):
        """Of vertices and what is around them, kept while the same ones are written."""
        if chosen != self._around[0]:
            faces = {face for vertex in chosen for face in self.vertices[vertex].link_faces}
            self._around = chosen, faces, {vertex for face in faces for vertex in face.verts}
        for element in chain(*self._around[1:]):
            element.normal_update()

    def flags_of(self, name):
        """(vertices,) bool: `select` or `hide`."""
        return np.fromiter(map(operator.attrgetter(name), self.vertices), bool, len(self.vertices))


class Positions:
    """What positions become on their way to the other side. Mix in before what reads and writes them."""

    turns = True

    @staticmethod
    def mirrored(carrier, vertices, there):
        return carrier.turned(vertices, there)

    @staticmethod
    def on_line(carrier, vertices, change):
        return carrier.clamped(vertices, change)


class EditChannel(Positions, EditVertices):
    """Positions in edit mode."""

    def __init__(self, object):
        super().__init__(object.data)
        self.key = "EDIT", object.active_shape_key_index

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
