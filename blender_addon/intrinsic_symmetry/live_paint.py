# SPDX-License-Identifier: GPL-3.0-or-later
"""What strokes change in sculpt and paint modes, read and written after each: positions, masks, colours, weights."""

import bpy
import numpy as np

from . import mesh_data, side_names
from .live_edit import Positions
from .weights import read_weights

_STROKES = ("SCULPT_OT_", "PAINT_OT_")


class PaintChannel:
    """One array of an object's mesh, (vertices, components) float32. Each kind says how it is read and written."""

    turns, limits = False, None

    def __init__(self, object, key):
        self._object, self.key = object, key
        self.values = self._read()

    def is_alive(self):
        try:
            return len(self._object.data.vertices) == len(self.values)
        except ReferenceError:
            return False

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
        wanted[vertices] = values if self.limits is None else np.clip(values, *self.limits)
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
            fixed |= ~_vertices_of_selected_faces(mesh)
        return np.zeros(len(fixed), bool), fixed, None

    @staticmethod
    def mirrored(_route, there):
        return there

    @staticmethod
    def on_line(_carrier, _vertices, change):
        return change


def _vertices_of_selected_faces(mesh):
    selected, (offsets, corners) = np.empty(len(mesh.polygons), bool), mesh_data.polygons(mesh)
    mesh.polygons.foreach_get("select", selected)
    inside = np.zeros(len(mesh.vertices), bool)
    inside[corners[np.repeat(selected, np.diff(offsets))]] = True
    return inside


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

    limits = 0, 1

    def _read(self):
        mask = self._object.data.attributes.get(".sculpt_mask")
        if mask is None:
            return np.zeros((len(self._object.data.vertices), 1), np.float32)
        return mesh_data.read_attribute(mask)[:, None]

    def _write(self, values, _vertices):
        mesh_data.write_attribute(self._object.data, ".sculpt_mask", "FLOAT", values)
        self._object.data.update()


class Colours(PaintChannel):
    """The active colour attribute. Where corners have colours of their own, a vertex has their mean, and its change is
    theirs."""

    limits = 0, 1

    @property
    def _attribute(self):
        return self._object.data.color_attributes.active_color

    def _read(self):
        values = mesh_data.read_attribute(self._attribute)
        if self._attribute.domain == "POINT":
            return values
        _, corners = mesh_data.polygons(self._object.data)
        count = len(self._object.data.vertices)
        sums = [np.bincount(corners, values[:, column], count) for column in range(4)]
        uses = np.maximum(np.bincount(corners, minlength=count), 1)
        return (np.stack(sums, axis=1) / uses[:, None]).astype(np.float32)

    def _write(self, values, _vertices):
        if self._attribute.domain == "CORNER":
            _, corners = mesh_data.polygons(self._object.data)
            values = mesh_data.read_attribute(self._attribute) + (values - self.values)[corners]
        mesh_data.update_attribute(self._attribute, np.clip(values, 0, 1))
        self._object.data.update()


class Weights(PaintChannel):
    """The active vertex group and, as second column, that of the other side; a group without a side is its own."""

    limits = 0, 1

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
    def mirrored(_route, there):
        return there[:, ::-1]

    @staticmethod
    def on_line(_carrier, _vertices, change):
        """Both groups have the same there."""
        return np.repeat(change[:, :1], change.shape[1], axis=1)


def channels_of(object):
    """One for each array that the object's mode edits and Live can follow."""
    kinds = {"POSITIONS": SculptedPositions, "MASK": Mask, "COLOURS": Colours, "WEIGHTS": Weights}
    return [kinds[key[0]](object, key) for key in keys_of(object)]


def keys_of(object):
    """Names of the arrays, without reading them."""
    colour = object.data.color_attributes.active_color
    colours = [("COLOURS", colour.name)] if colour is not None else []
    if object.mode == "SCULPT" and not object.use_dynamic_topology_sculpting:
        return [("POSITIONS", mesh_data.key_name(object)), ("MASK",), *colours]
    if object.mode == "VERTEX_PAINT":
        return colours
    groups = _groups_of(object)
    return [("WEIGHTS", *groups)] if groups and lacking_group(object) is None else []


def _groups_of(object):
    """In weight paint mode, the names of the active group and that of the other side; one without a side is its own."""
    group = object.vertex_groups.active
    if object.mode != "WEIGHT_PAINT" or group is None:
        return ()
    return tuple(dict.fromkeys((group.name, side_names.counterpart(group.name, object.vertex_groups.keys()))))


def lacking_group(object):
    """Name of the group of the other side that strokes would go to, if there is none."""
    return next((name for name in _groups_of(object) if name not in object.vertex_groups), None)
