# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes as numpy arrays.

Everything here needs object mode, where Blender's arrays can be read and written at once; `object_mode` goes there
from any mode and comes back.
"""

from contextlib import contextmanager

import bpy
import intrinsym
import numpy as np


#: Whether `object_mode` is between leaving a mode and coming back.
passing = False


#: How many times as far from the middle as the others a vertex may be.
_FAR = 1e8


class MeshProblem(Exception):
    """What the user has to know; the text is shown as it is."""


def why_not(context, only_read=False):
    """Why the active object cannot be worked on, or `only_read`; or nothing."""
    object = context.active_object
    if object is None or object.type != "MESH":
        return "Needs an active mesh object"
    problem = why_fixed(object, object.mode == "EDIT", only_read)
    return f"The mesh {problem}" if problem else None


def why_fixed(object, is_left=False, only_read=False):
    """Why an object's mesh cannot be written, or `only_read`, to follow its name; or nothing. `is_left`: edit mode is left
    before."""
    mesh = object.data
    if is_linked(mesh) and not only_read:
        return "is linked from another file: make it local first"
    if mesh.is_editmode and not is_left:
        through = ": leave it first" if object.mode == "EDIT" else " through another object: leave that first"
        return f"is in edit mode{through}"
    return None


def is_linked(mesh):
    return mesh.library is not None or mesh.override_library is not None


def refuse_fixed(objects):
    """Raises MeshProblem if the mesh of one of the objects cannot be written; in object mode."""
    for object in objects:
        if problem := why_fixed(object):
            raise MeshProblem(f'"{object.name}" {problem}')


class NothingSelected(MeshProblem):
    """Of several objects in edit mode, those without a selection are passed over."""


def worked_on(context):
    """The active object, and those that are in edit mode with it."""
    active = context.active_object
    together = context.objects_in_mode_unique_data if active.mode == "EDIT" else []
    return [active] + [other for other in together if other != active and other.data != active.data]


@contextmanager
def object_mode(context):
    """The active object, in object mode; the mode it was in comes back at the end."""
    global passing
    object = context.active_object
    mode = object.mode
    if mode == "OBJECT":
        yield object
        return
    if mode != "EDIT":
        _mend_selection(object.data)
    passing = True
    try:
        bpy.ops.object.mode_set(mode="OBJECT")
        try:
            yield object
        finally:
            bpy.ops.object.mode_set(mode=mode)
    finally:
        passing = False


def _mend_selection(mesh):
    """Removes a selection of edges that are no flags. Blender 5.0.1 makes such a one where it computes the edges itself, as
    in `from_pydata`, and crashes when a paint mode is left with a paint mask on."""
    chosen = mesh.attributes.get(".select_edge")
    if chosen is not None and chosen.data_type != "BOOLEAN":
        remove_attribute(mesh, ".select_edge")


def polygons(mesh):
    """Faces of any size, as `intrinsym.Polygons`."""
    corners = np.empty(len(mesh.loops), np.int32)
    _stored(mesh, (".corner_vert", "value"), (mesh.loops, "vertex_index"), corners)
    offsets = np.empty(len(mesh.polygons) + 1, np.int32)
    mesh.polygons.foreach_get("loop_start", offsets[:-1])
    offsets[-1] = len(corners)
    return intrinsym.Polygons(offsets, corners)


def triangles(mesh):
    """(triangles, 3) vertices of the triangles that Blender draws the faces with."""
    mesh.calc_loop_triangles()
    corners = np.empty((len(mesh.loop_triangles), 3), np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners.reshape(-1))
    return corners


def edges(mesh):
    """(edges, 2) vertex numbers."""
    ends = np.empty((len(mesh.edges), 2), np.int32)
    return _stored(mesh, (".edge_verts", "value"), (mesh.edges, "vertices"), ends)


def edges_of_corners(mesh):
    """(corners,) the edge that begins at each face corner."""
    numbers = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", numbers)
    return numbers


def positions(mesh):
    """(vertices, 3) float32 of the base shape."""
    places = np.empty((len(mesh.vertices), 3), np.float32)
    return _stored(mesh, ("position", "vector"), (mesh.vertices, "co"), places)


def normals(mesh):
    """(vertices, 3) float32 of the base shape; in object mode."""
    values = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertex_normals.foreach_get("vector", values.reshape(-1))
    return values


def refuse_nowhere(points):
    """Raises MeshProblem where vertices have no place."""
    nowhere = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(nowhere):
        raise MeshProblem(f"Vertex {nowhere[0]} has NaN or infinity: move or delete it")


def refuse_far(points):
    """Raises MeshProblem where vertices have no place, or single ones are so far away that the others are one point beside them."""
    if not len(points):
        return
    refuse_nowhere(points)
    away = np.linalg.norm(points - np.median(points, axis=0).astype(float), axis=1)
    usual = np.median(away)
    far = np.flatnonzero(away > _FAR * usual)
    if usual > 0 and len(far):
        raise MeshProblem(f"Vertex {far[0]} is too far from all others: move or delete it")


def _stored(mesh, attribute, elements, array):
    """Fills an array with one of the mesh' own attributes, which is read in one piece. In edit mode there is none, and
    the elements are read one by one."""
    if mesh.is_editmode or not array.size:
        source, values = elements
    else:
        source, values = mesh.attributes[attribute[0]].data, attribute[1]
    source.foreach_get(values, array.reshape(-1))
    return array


def key_positions(key):
    """(vertices, 3) float32 of a shape key."""
    values = np.empty((len(key.points), 3), np.float32)
    key.points.foreach_get("co", values.reshape(-1))
    return values


def set_key_positions(key, values):
    key.points.foreach_set("co", np.ascontiguousarray(values, np.float32).ravel())


def key_sizes(mesh):
    """(vertices, keys) how far each shape key moves each vertex."""
    moves = [key_positions(key) - key_positions(key.relative_key) for key in mesh.shape_keys.key_blocks]
    return np.linalg.norm(np.stack(moves, axis=1), axis=2)


def evaluated_positions(object, depsgraph):
    """(vertices, 3) float32 after all modifiers."""
    evaluated = object.evaluated_get(depsgraph).data
    if len(evaluated.vertices) != len(object.data.vertices):
        raise MeshProblem(
            f"The modifiers of {object.name} turn {len(object.data.vertices)} vertices into "
            f"{len(evaluated.vertices)}: choose base positions, or switch those modifiers off"
        )
    return positions(evaluated)


def shown_positions(object):
    """(vertices, 3) float32 of the shape that edits go to: the active shape key, or the base shape."""
    key = object.active_shape_key
    return positions(object.data) if key is None else key_positions(key)


def key_name(object):
    """Name of the active shape key, the basis or another; empty without keys. Its number may be another one's when keys
    are removed or moved."""
    return getattr(object.active_shape_key, "name", "")


def shown_key(object):
    """Name of the shape key that edits go to; empty for the basis or without keys."""
    key = object.active_shape_key
    return "" if key is None or key == object.data.shape_keys.reference_key else key.name


def has_multires(object):
    """Whether sculpted detail is kept in a modifier, beside the mesh."""
    return any(modifier.type == "MULTIRES" and modifier.total_levels for modifier in object.modifiers)


def why_absolute(object):
    """Why shape keys cannot be added up, or nothing."""
    keys = object.data.shape_keys
    if keys is None or keys.use_relative:
        return None
    return "The shape keys are absolute, each a shape in time, and are not added up: switch on Relative"


def set_shown_positions(object, values):
    """Writes what `shown_positions` reads. A changed basis takes the base shape along.
    Raises MeshProblem if the shape key is locked."""
    mesh, key = object.data, object.active_shape_key
    if key is not None:
        if key.lock_shape:
            raise MeshProblem(f'The shape key "{key.name}" is locked')
        move_key(mesh.shape_keys, key, values)
    if key is None or key == mesh.shape_keys.reference_key:
        mesh.vertices.foreach_set("co", np.ascontiguousarray(values, np.float32).ravel())
    mesh.update()


def move_key(keys, key, values):
    """Writes the positions of a shape key; keys that are relative to it move with it."""
    move = values - key_positions(key)
    for other in _relative_to(key, keys):
        set_key_positions(other, key_positions(other) + move)
    set_key_positions(key, values)


def _relative_to(key, keys):
    """The other keys that are relative to a key, or to one that is."""
    found = [key] if keys.use_relative else []
    for base in found:
        found += [other for other in keys.key_blocks if other.relative_key == base and other not in found]
    return found[1:]


#: data_type of an attribute: the name of its values, how many, and their kind.
LAYOUTS = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, bool),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
}


def read_attribute(attribute):
    """(elements,) or (elements, components) of an attribute of one of LAYOUTS."""
    name, components, kind = LAYOUTS[attribute.data_type]
    values = np.empty(components * len(attribute.data), kind)
    attribute.data.foreach_get(name, values)
    return values if components == 1 else values.reshape(-1, components)


def write_attribute(mesh, name, kind, values, domain="POINT"):
    """Stores values, one row for each element of the domain; replaces an attribute of another type or domain."""
    attribute = mesh.attributes.get(name)
    if attribute is not None and (attribute.data_type, attribute.domain) != (kind, domain):
        remove_attribute(mesh, name)
        attribute = None
    if attribute is None:
        with _active_kept(mesh):
            mesh.attributes.new(name, kind, domain)
    update_attribute(mesh.attributes[name], values)  # fetched again: creating one moves the others


def remove_attribute(mesh, name):
    with _active_kept(mesh):
        mesh.attributes.remove(mesh.attributes[name])


@contextmanager
def _active_kept(mesh):
    """The active attribute is the same before and after."""
    active = mesh.attributes.active
    name = None if active is None else active.name
    yield
    mesh.attributes.active = None if name is None else mesh.attributes.get(name)


def update_attribute(attribute, values):
    name, _, number = LAYOUTS[attribute.data_type]
    attribute.data.foreach_set(name, np.ascontiguousarray(values, number).ravel())


def selected_vertices(mesh):
    """(vertices,) bool."""
    flags = np.empty(len(mesh.vertices), bool)
    mesh.vertices.foreach_get("select", flags)
    return flags


def changeable(mesh, mode):
    """(vertices,) 0..1: how far Blender's own tools may change each vertex in a mode. Hidden ones not at all; in the
    sculpt and paint modes as far as the mask or the paint selection lets them."""
    if mode == "OBJECT":
        return np.ones(len(mesh.vertices))
    free = 1.0 - _of_points(mesh, ".hide_vert")
    if mode == "SCULPT":
        free *= 1 - _of_points(mesh, ".sculpt_mask")
    elif mode != "EDIT" and mesh.use_paint_mask:
        free *= of_selected_faces(mesh)
    elif mode != "EDIT" and mesh.use_paint_mask_vertex:
        free *= selected_vertices(mesh)
    return free


def open_elements(mesh, mode, domain):
    """(elements,) bool: edges, faces or face corners that Blender's own tools may change in a mode. Those of hidden faces
    are not, whatever their vertices are, nor in the paint modes those outside the paint selection of faces."""
    if domain == "CORNER":
        return np.repeat(open_elements(mesh, mode, "FACE"), np.diff(polygons(mesh)[0]))
    elements = {"POINT": mesh.vertices, "EDGE": mesh.edges, "FACE": mesh.polygons}[domain]
    hidden, selected = np.zeros((2, len(elements)), bool)
    if mode != "OBJECT":
        elements.foreach_get("hide", hidden)
    if domain != "FACE" or mode in ("OBJECT", "EDIT", "SCULPT") or not mesh.use_paint_mask:
        return ~hidden
    elements.foreach_get("select", selected)
    return ~hidden & selected


def _of_points(mesh, name):
    """(vertices,) values of an attribute, 0 where there is none."""
    attribute = mesh.attributes.get(name)
    return np.zeros(len(mesh.vertices)) if attribute is None else read_attribute(attribute).astype(float)


def of_selected_faces(mesh):
    """(vertices,) bool: the corners of selected faces."""
    chosen = np.empty(len(mesh.polygons), bool)
    mesh.polygons.foreach_get("select", chosen)
    offsets, corners = polygons(mesh)
    found = np.zeros(len(mesh.vertices), bool)
    found[corners[np.repeat(chosen, np.diff(offsets))]] = True
    return found
