# SPDX-License-Identifier: GPL-3.0-or-later
"""What the overlay draws, as arrays: nothing here draws, so that it can be tested without a window.

It reads the mesh as it is on the screen, in edit mode too, and never writes to it.
"""

from dataclasses import dataclass

import bmesh
import numpy as np

from . import eigenfunctions, mesh_data, stored_map

#: More lines than these cannot be told apart.
MOST_PAIRS = 100
#: How far the overlay floats above the surface, as a share of the object's size.
_LIFT = 6e-4

_UNSURE, _SURE = np.array((0.85, 0.15, 0.1)), np.array((0.1, 0.65, 0.95))
_LEFT, _RIGHT, _MIDDLE = (0.95, 0.55, 0.1), (0.15, 0.45, 0.95), (1.0, 1.0, 1.0)
_NEGATIVE, _ZERO, _POSITIVE = np.array((0.05, 0.25, 0.85)), np.array((1.0, 1.0, 1.0)), np.array((0.85, 0.1, 0.05))


@dataclass(frozen=True)
class Shape:
    """A mesh as the viewport shows it."""

    positions: np.ndarray  # (vertices, 3)
    normals: np.ndarray  # (vertices, 3)
    triangles: np.ndarray  # (triangles, 3)
    selected: np.ndarray  # (vertices,) bool
    attributes: dict  # name to (vertices, ...) for those of the stored map that are there

    def lifted(self):
        """(vertices, 3) a little above the surface."""
        size = np.ptp(self.positions, axis=0).max() if len(self.positions) else 0.0
        return self.positions + _LIFT * size * self.normals


def shape_of(object, depsgraph):
    """The Shape of an object in any mode."""
    return _edited(object.data) if object.mode == "EDIT" else _shown(object, depsgraph)


def _shown(object, depsgraph):
    base = object.data
    mesh = object.evaluated_get(depsgraph).data
    if len(mesh.vertices) != len(base.vertices) or len(mesh.polygons) != len(base.polygons):
        mesh = base
    mesh.calc_loop_triangles()
    triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    normals = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("normal", normals)
    stored = {name: base.attributes.get(name) for name in stored_map.KINDS}
    read = {name: mesh_data.read_attribute(found) for name, found in stored.items() if found is not None}
    selected = mesh_data.selected_vertices(base)
    return Shape(mesh_data.positions(mesh), normals.reshape(-1, 3), triangles.reshape(-1, 3), selected, read)


def _edited(mesh):
    data = bmesh.from_edit_mesh(mesh)
    triangles = [[corner.vert.index for corner in triangle] for triangle in data.calc_loop_triangles()]
    read = {}
    for name, kind in stored_map.KINDS.items():
        layers = data.verts.layers
        layer = {"INT": layers.int, "FLOAT": layers.float, "FLOAT_VECTOR": layers.float_vector}[kind].get(name)
        if layer is not None:
            read[name] = np.array([vertex[layer] for vertex in data.verts])
    return Shape(
        np.array([vertex.co for vertex in data.verts], np.float32).reshape(-1, 3),
        np.array([vertex.normal for vertex in data.verts], np.float32).reshape(-1, 3),
        np.array(triangles, np.int32).reshape(-1, 3),
        np.array([vertex.select for vertex in data.verts], bool),
        read,
    )


def fits(shape, mesh):
    """Whether the stored map can belong to the shape: as many vertices and triangles as when it was stored."""
    record = mesh.get(stored_map.RECORD)
    sizes = (len(shape.positions), len(shape.triangles))
    return record is not None and sizes == (record["vertices"], record["triangles"]) and len(shape.attributes) == len(
        stored_map.KINDS
    )


def pair_lines(shape):
    """(2 * pairs, 3) ends and (2 * pairs, 4) colours of lines from selected vertices to their exact images."""
    chosen = np.flatnonzero(shape.selected & (shape.attributes[stored_map.PARTNER] >= 0))
    chosen = chosen[:: max(1, -(-len(chosen) // MOST_PAIRS))]
    corners = np.stack([shape.attributes[name][chosen] for name in stored_map.CORNERS], axis=1)
    images = np.einsum("vk,vkx->vx", shape.attributes[stored_map.BARY][chosen], shape.positions[corners])
    ends = np.stack([shape.positions[chosen], images], axis=1).reshape(-1, 3)
    colours = _with_alpha(confidence_colours(shape.attributes[stored_map.CONFIDENCE][chosen]), 0.8)
    return ends, np.repeat(colours, 2, axis=0)


def line_segments(shape, lines):
    """(2 * segments, 3) ends of the pieces of the line between left and right."""
    lifted, found = shape.lifted(), [np.zeros((0, 3))]
    for line in lines:
        points = line.positions(lifted)
        if line.closed:
            points = np.vstack([points, points[:1]])
        found.append(np.stack([points[:-1], points[1:]], axis=1).reshape(-1, 3))
    return np.concatenate(found)


def surface_colours(shape, object, kind):
    """(vertices, 4) colours of the surface, or nothing where there are none to show."""
    if kind == "EIGENFUNCTION":
        values = eigenfunctions.active_values(object.data)
        known = values is not None and len(values) == len(shape.positions)
        return _with_alpha(diverging_colours(values), 0.75) if known else None
    if not fits(shape, object.data):
        return None
    if kind == "CONFIDENCE":
        return _with_alpha(confidence_colours(shape.attributes[stored_map.CONFIDENCE]), 0.75)
    table = np.array([_MIDDLE, _LEFT, _RIGHT])  # 0, 1, -1
    return _with_alpha(table[shape.attributes[stored_map.SIDE]], 0.6)


def confidence_colours(confidence):
    """(n, 3): red where a vertex should not be trusted, blue where it can be."""
    return _UNSURE + confidence[:, None] * (_SURE - _UNSURE)


def diverging_colours(values):
    """(n, 3): blue below zero, white at it, red above; grey where there is no value."""
    known = np.isfinite(values)
    scale = np.abs(values[known]).max(initial=1e-30)
    share = np.clip(np.where(known, values, 0) / scale, -1, 1)[:, None]
    colours = _ZERO + np.maximum(share, 0) * (_POSITIVE - _ZERO) + np.maximum(-share, 0) * (_NEGATIVE - _ZERO)
    colours[~known] = 0.4
    return colours


def _with_alpha(colours, alpha):
    return np.column_stack([colours, np.full(len(colours), alpha)]).astype(np.float32)
