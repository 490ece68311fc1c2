# SPDX-License-Identifier: GPL-3.0-or-later
"""Undo in edit mode: Blender brings back the attributes of a mesh, but not its custom properties, nor its list of shape
keys.

So the attribute `sym_record`, one number all over the mesh, says which record belongs to the map that is there,
and after each undo and redo that record is put back. Records are kept for this session, the last ones. Shape keys that
a tool has made, and that the edit mesh does not have after an undo, are removed.
"""

import bmesh
import bpy

RECORD = "intrinsic_symmetry"
NUMBER = "sym_record"
_MOST_RECORDS = 64
#: The largest number of a record.
MOST = 0x7FFFFFFF

#: Number of a record: the record.
_records = {}
#: Shape keys that tools have made in this session: number of the mesh, name.
_made = set()


def number_of(record):
    """The value of NUMBER for a record; int32, never 0, which new vertices may get."""
    return int(record["checksum"], 16) & MOST or 1


def remember(mesh):
    """Keeps the mesh's record, for the time when an undo brings its map back."""
    record = mesh.get(RECORD)
    if record is None:
        return
    number = number_of(record)
    _records.pop(number, None)
    _records[number] = record.to_dict()
    while len(_records) > _MOST_RECORDS:
        del _records[next(iter(_records))]


def _number_in_edit_mode(mesh):
    """The number that the first vertex has; 0 if it is a new one, nothing without a map."""
    vertices = bmesh.from_edit_mesh(mesh).verts
    layer, first = vertices.layers.int.get(NUMBER), next(iter(vertices), None)
    return None if layer is None or first is None else first[layer]


def _put_back(mesh):
    number, record = _number_in_edit_mode(mesh), mesh.get(RECORD)
    if number is None and record is not None:
        remember(mesh)
        del mesh[RECORD]
    elif number in _records and (record is None or number_of(record) != number):
        remember(mesh)
        mesh[RECORD] = _records[number]


def note_made(object, key):
    """Keeps in mind that a tool has made a shape key."""
    _made.add((object.data.session_uid, key.name))


def _take_back_made_keys(object):
    """Removes those that the edit mesh does not know: they were made after what an undo has brought back."""
    mesh, active = object.data, object.active_shape_key_index
    known = bmesh.from_edit_mesh(mesh).verts.layers.shape.keys()
    unknown = [key for key in mesh.shape_keys.key_blocks
               if key.name not in known and (mesh.session_uid, key.name) in _made]
    for key in reversed(unknown):
        key.driver_remove("value")
        object.shape_key_remove(key)
    if unknown and object.active_shape_key_index != active:
        object.active_shape_key_index = active


@bpy.app.handlers.persistent
def _after_undo(*_):
    for mesh in bpy.data.meshes:
        if mesh.is_editmode:
            _put_back(mesh)
    for object in bpy.context.view_layer.objects:
        if object.type == "MESH" and object.mode == "EDIT" and object.data.shape_keys:
            _take_back_made_keys(object)


def register():
    bpy.app.handlers.undo_post.append(_after_undo)
    bpy.app.handlers.redo_post.append(_after_undo)


def unregister():
    bpy.app.handlers.undo_post.remove(_after_undo)
    bpy.app.handlers.redo_post.remove(_after_undo)
    _records.clear()
    _made.clear()
