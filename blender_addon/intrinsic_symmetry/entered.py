# SPDX-License-Identifier: GPL-3.0-or-later
"""The shape with which edit mode was entered, of each object that is in it: what Mirror Edit starts from.

It is kept until the user leaves edit mode, edits another shape key or changes the topology. Saving writes the edit into
the mesh, and our own operators go through object mode and back; neither ends what is kept.
"""

import zlib
from dataclasses import dataclass, replace

import bpy
import numpy as np

from . import mesh_data, undo


@dataclass(frozen=True)
class _Entered:
    key: str
    topology: tuple
    positions: np.ndarray  # (vertices, 3) float32
    before: tuple | None = None  # the edited shape that was mirrored, and what it started from; undo leads back there


#: Shapes with which edit mode was entered first since a map was stored, (vertices, 3): number of the mesh, of its record.
_began = {}
#: Shapes with which it was left last: number of the mesh.
_left = {}
#: As many of a mesh are kept.
_MOST_BEGAN = 8
#: By the object's number in this session; nothing for one whose topology was edited, until edit mode is back.
_entered = {}


def shape_of(object, key=None):
    """(vertices, 3) float32, or nothing; nothing either where another shape key than that is edited; in object mode."""
    found = _entered.get(object.session_uid)
    if found is None or key is not None and key.name != found.key:
        return None
    undone = found.before and np.array_equal(found.before[0], mesh_data.shown_positions(object))
    return found.before[1] if undone else found.positions


def is_lost(object):
    """Whether vertices or faces were edited since; in object mode."""
    return _entered.get(object.session_uid, object) is None


def began(mesh, record):
    """(vertices, 3) float32 the base shape with which edit mode was entered first since the record of this number was
    stored, or nothing; its vertices are those of the record."""
    return _began.get(mesh.session_uid, {}).get(record)


def _note_beginning(mesh):
    """Keeps the shape with which edit mode is entered; what was moved outside of edit mode since it was left belongs to it."""
    record = mesh.get(undo.RECORD)
    if record is None or record["vertices"] != len(mesh.vertices):
        return
    shapes, now = _began.setdefault(mesh.session_uid, {}), mesh_data.positions(mesh)
    shape, left = shapes.get(undo.number_of(record), now), _left.get(mesh.session_uid, now)
    outside = now - left if len(left) == len(now) else np.zeros_like(now)
    outside[now == shape] = 0  # an undo brought it back
    shapes[undo.number_of(record)] = shape + outside
    while len(shapes) > _MOST_BEGAN:
        del shapes[next(iter(shapes))]


def note(object):
    """Keeps the shape of an object in edit mode, if that of the shape key is not kept yet. The mesh has it, as edits
    are in the edit mesh."""
    found, key = _entered.get(object.session_uid), mesh_data.key_name(object)
    if object.session_uid not in _entered:
        _note_beginning(object.data)
    if found is None or found.key != key:
        _entered[object.session_uid] = _Entered(key, _topology(object.data), mesh_data.shown_positions(object))


def restart(object, edited):
    """The shape of now is what is kept; it came of mirroring the edited one. The mesh has it."""
    found = _entered.get(object.session_uid)
    if found is not None:
        undone = found.before and np.array_equal(found.before[0], edited)
        before, shape = (edited, found.before[1] if undone else found.positions), mesh_data.shown_positions(object)
        changed = not np.array_equal(edited, shape)
        _entered[object.session_uid] = replace(found, positions=shape, before=before if changed else None)


def _topology(mesh):
    return len(mesh.vertices), zlib.crc32(mesh_data.edges(mesh).tobytes())


def _update(object):
    found = _entered.get(object.session_uid)
    if object.mode == "EDIT":
        note(object)
    elif not mesh_data.passing:
        if object.session_uid in _entered:
            _left[object.data.session_uid] = mesh_data.positions(object.data)
        _entered.pop(object.session_uid, None)
    elif found is not None and found.topology != _topology(object.data):
        _entered[object.session_uid] = None


@bpy.app.handlers.persistent
def _on_update(_scene, depsgraph):
    for update in depsgraph.updates:
        object = update.id.original
        if isinstance(object, bpy.types.Object) and object.type == "MESH":
            _update(object)


@bpy.app.handlers.persistent
def _on_load(*_):
    _entered.clear()
    _began.clear()
    _left.clear()


def register():
    bpy.app.handlers.depsgraph_update_post.append(_on_update)
    bpy.app.handlers.load_post.append(_on_load)


def unregister():
    bpy.app.handlers.depsgraph_update_post.remove(_on_update)
    bpy.app.handlers.load_post.remove(_on_load)
    _entered.clear()
