# SPDX-License-Identifier: GPL-3.0-or-later
"""What strokes change in sculpt and paint modes, read and written after each: positions, masks, colours, weights."""

import bpy
import numpy as np

from . import mesh_data, side_names
from .elements import corner_partners, corners_at, face_partners
from .live_carry import CornerCarrier
from .live_edit import Positions
from .vertex_map import whole
from .weights import read_weights

_STROKES = ("SCULPT_OT_", "PAINT_OT_")


class PaintChannel:
    """One array of an object's mesh, (vertices, components) float32. Each kind says how it is read and written. What a
    stroke makes of a value on one side is the value on the other."""

    turns = False

    def __init__(self, object, key):
        self._object, self.key = object, key
        self.values = self._read()

    def is_alive(self):
        try:
            return len(self._elements()) == len(self.values)
        except ReferenceError:
            return False

    def _elements(self):
        """Those that have the values."""
        return self._object.data.vertices

    def carrier(self, of_vertices):
        """The map of the elements, from that of the vertices."""
        return of_vertices

    @staticmethod
    def is_busy():
        """A stroke, or a filter, is still going on."""
        running = [operator for window in bpy.context.window_manager.windows for operator in window.modal_operators]
        return any(operator.bl_idname.startswith(_STROKES) for operator in running)

    @staticmethod
    def operation():
        return None

    def read(self):
        found = self._read()
        vertices = np.flatnonzero((found != self.values).any(axis=1))
        self.values = found.copy()
        return vertices, found[vertices]

    def write(self, vertices, values):
        """Returns what the vertices hold now: bytes do not hold all."""
        wanted = self.values.copy()
        wanted[vertices] = values
        self._write(wanted, vertices)
        self.values = self._read()
        return self.values[vertices]

    def rest(self):
        pass

    catch_up = rest

    def flags(self, _lit):
        """No vertex is selected; hidden and masked ones are left alone."""
        mesh = self._object.data
        fixed = np.empty(len(mesh.vertices), bool)
        mesh.vertices.foreach_get("hide", fixed)
        if mesh.use_paint_mask_vertex:
            fixed |= ~mesh_data.selected_vertices(mesh)
        elif mesh.use_paint_mask:
            fixed |= ~mesh_data.of_selected_faces(mesh)
        return np.zeros(len(fixed), bool), fixed, None

    def carried(self, plan, base, current):
        """The values at the images, by the share of each image that was painted."""
        painted = np.zeros(base.shape)
        painted[plan.sources] = self._painted(base[plan.sources], current[plan.sources])
        share, there = (self._mirrored(plan.route.carry(values)) for values in (painted, painted * current))
        return there - share * base[plan.targets]

    @staticmethod
    def _painted(before, after):
        """Which components a stroke has given their values, of elements that it has changed."""
        return np.ones(before.shape)

    @staticmethod
    def _mirrored(there):
        return there

    @staticmethod
    def on_line(_carrier, vertices, _base, current):
        return current[vertices]


class SculptedPositions(Positions, PaintChannel):
    """Positions in sculpt mode; the mask says how much of a change arrives."""

    def _read(self):
        return mesh_data.shown_positions(self._object)

    def _write(self, values, _vertices):
        mesh_data.set_shown_positions(self._object, values)

    def flags(self, lit):
        mask = self._object.data.attributes.get(".sculpt_mask")
        share = None if mask is None else 1 - mesh_data.read_attribute(mask).astype(float)
        selected, hidden = np.zeros(len(self.values), bool), np.empty(len(self.values), bool)
        self._object.data.vertices.foreach_get("hide", hidden)
        return selected, hidden, share


class Mask(PaintChannel):
    """The sculpt mask."""

    def _read(self):
        mask = self._object.data.attributes.get(".sculpt_mask")
        if mask is None:
            return np.zeros((len(self._object.data.vertices), 1), np.float32)
        return mesh_data.read_attribute(mask)[:, None]

    def _write(self, values, _vertices):
        mesh_data.write_attribute(self._object.data, ".sculpt_mask", "FLOAT", values)
        self._object.data.update()


class Colours(PaintChannel):
    """The active colour attribute, of vertices or of face corners."""

    @property
    def _attribute(self):
        return self._object.data.color_attributes.active_color

    @property
    def _is_of_corners(self):
        return self._attribute.domain == "CORNER"

    def _elements(self):
        return getattr(self._attribute, "data", ())

    def _read(self):
        return mesh_data.read_attribute(self._attribute)

    def _write(self, values, _elements):
        mesh_data.update_attribute(self._attribute, values)
        self._object.data.update()

    def carrier(self, of_vertices):
        return of_corners(of_vertices, self._object.data) if self._is_of_corners else of_vertices

    def flags(self, lit):
        selected, fixed, share = super().flags(lit)
        if self._is_of_corners:
            mesh, mode = self._object.data, self._object.mode
            fixed = fixed[mesh_data.polygons(mesh).corners] | ~mesh_data.open_elements(mesh, mode, "CORNER")
            selected = np.zeros(len(fixed), bool)
        return selected, fixed, share


def of_corners(carrier, mesh):
    """The map of face corners, made once: the image of each is that in the mirror image of its face, as far as there is
    one, or else in the face that holds the image of its vertex."""
    if carrier.of_corners is None:
        symmetry, (offsets, vertex) = carrier.symmetry, mesh_data.polygons(mesh)
        points, faces = symmetry.surface_points, face_partners(mesh, symmetry)
        exact = corner_partners(mesh, symmetry.partner, faces)[:, None]
        held = corners_at(mesh, points.faces[vertex][:, None].astype(np.int64), points.corners[vertex].astype(np.int64))
        images = np.where((exact >= 0) & whole(symmetry)[vertex][:, None], exact, held)
        carrier.of_corners = CornerCarrier(carrier, offsets, vertex, images)
    return carrier.of_corners


class Weights(PaintChannel):
    """The active vertex group and, as second column, that of the other side; a group without a side is its own."""

    def __init__(self, object, key):
        self._groups = key[1:]
        super().__init__(object, key)

    def _read(self):
        columns = [self._object.vertex_groups[name].index for name in self._groups]
        return read_weights(self._object)[:, columns].astype(np.float32)

    def _write(self, values, vertices):
        for column, name in enumerate(self._groups):
            group = self._object.vertex_groups[name]
            if not group.lock_weight:
                for vertex in vertices[values[vertices, column] != self.values[vertices, column]].tolist():
                    group.add((vertex,), float(values[vertex, column]), "REPLACE")
        self._object.data.update()

    @staticmethod
    def _painted(before, after):
        """The weight in one group may be painted, and that in the other is not."""
        return before != after

    @staticmethod
    def _mirrored(there):
        return there[:, ::-1]

    @staticmethod
    def on_line(_carrier, vertices, _base, current):
        """Both groups have the same there."""
        return np.repeat(current[vertices, :1], current.shape[1], axis=1)


def channels_of(object):
    """One for each array that the object's mode edits and Live can follow."""
    kinds = {"POSITIONS": SculptedPositions, "MASK": Mask, "COLOURS": Colours, "WEIGHTS": Weights}
    return [kinds[key[0]](object, key) for key in keys_of(object)]


def keys_of(object):
    """Names of the arrays, without reading them."""
    colour = object.data.color_attributes.active_color
    colours = [("COLOURS", colour.name, colour.domain)] if colour is not None else []
    if object.mode == "SCULPT" and not object.use_dynamic_topology_sculpting:
        return [("POSITIONS", mesh_data.key_name(object)), ("MASK",), *colours]
    if object.mode == "VERTEX_PAINT":
        return colours
    groups = _groups_of(object)
    return [("WEIGHTS", *groups)] if groups and all(name in object.vertex_groups for name in groups) else []


def _groups_of(object):
    """In weight paint mode, the names of the active group and that of the other side; one without a side is its own."""
    group = object.vertex_groups.active
    if object.mode != "WEIGHT_PAINT" or group is None:
        return ()
    return tuple(dict.fromkeys((group.name, side_names.counterpart(group.name, object.vertex_groups.keys()))))


def why_not(object):
    """Why strokes do not go to the group of the other side, in words, or nothing."""
    for name in _groups_of(object):
        if name not in object.vertex_groups:
            return f'there is no group "{name}"'
        if object.vertex_groups[name].lock_weight:
            return f'the group "{name}" is locked'
    return None
