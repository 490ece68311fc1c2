# SPDX-License-Identifier: GPL-3.0-or-later
"""Live mirror: what is changed on one side happens on the other, while it is changed.

After each update of the dependency graph the values that the object's mode edits are compared with the last ones, and
what follows from the difference is written. `live_carry` says what follows; `live_edit`, `live_paint` and
`live_texture` read and write. Nothing is stored on the mesh.
"""

from contextlib import contextmanager

import bmesh
import bpy
import intrinsym
import numpy as np

from . import live_edit, live_paint, live_select, live_texture, mesh_data, stored_map
from .live_carry import Carrier, Change, History

#: Objects with Live on, by their number in this session.
_sessions = {}
#: Why Live was switched off, for the panel; by the same number.
reasons = {}
#: Whether an undo is under way, and whether we are switching ourselves off.
_undoing = _switching = False
#: How long the status bar says why.
_SECONDS = 8.0
_TOPOLOGY = "Live Mirror is off: the mesh has other vertices, edges or faces now. Update Symmetry, then switch it on"


def problem_of(object):
    """Why nothing follows, in words, or nothing."""
    why = live_paint.why_not(object) if object.intrinsic_symmetry_live else None
    return f"Live does not follow: {why}" if why else reasons.get(object.session_uid)


class Track:
    """One array of values that the mode of an object edits, and what has happened to it."""

    def __init__(self, channel, carrier, kept, undone):
        """`carrier` is that of the vertices. `kept`: state and history when it was edited last, or nothing. After an undo
        the state is looked for in the history; else it is only gone on with if it is still there."""
        self.channel, values, carrier = channel, channel.values, channel.carrier(carrier)
        state, history = kept or (values, None)
        if state.shape != values.shape:
            state = None
        elif undone and history is not None:
            state = history.find(state, values)
        elif not np.array_equal(state, values):
            state = None
        if state is None or history is None:
            state, history = values, History(bpy.context.preferences.edit.undo_steps + 1)
        self.state, self.history = state.copy(), history
        differs = np.flatnonzero((self.state != values).any(axis=1))
        if len(differs):
            self.state[differs] = channel.write(differs, self.state[differs])
        if channel.turns and not (undone and carrier.is_fitted()):
            carrier.fit(self.state)
        self.change, self.operation, self.flags = Change(carrier, self.state, channel), None, None

    @property
    def kept(self):
        """What another track of the same values goes on with."""
        return self.state, self.history

    def update(self, lit):
        """Somebody may have changed something. `lit` are vertices that only Live Selection selected, or nothing."""
        operation = self.channel.operation()
        if operation is not None and operation != self.operation:
            self.settle()
        self.operation = operation
        vertices, values = self.channel.read()
        if not np.isfinite(values).all():
            raise mesh_data.MeshProblem("a value became infinite or no number. Undo that, then switch it on")
        if len(vertices):
            self.change.take(vertices, values)
            if self.flags is None:
                self.flags = self.channel.flags(lit)
            changed = self.change.follow(*self.flags)
            if len(changed):
                self.change.current[changed] = self.channel.write(changed, self.change.current[changed])
        if operation is None:
            self.settle()

    def settle(self):
        """The operation is over: its result is what the next one begins with."""
        self.flags = None
        step = self.change.settle()
        self.channel.rest()
        if step is not None:
            self.state[step.vertices] = step.after
            self.history.add(step)


class Session:
    """Live mirroring of one object: its map, and what happens in the mode that it is in."""

    def __init__(self, object):
        self.mark, self.carrier = mark_of(object.data), Carrier(_load(object.data))
        self.topology = live_edit.topology(object)
        self.tracks, self.lit, self.lit_with, self._kept, self._waits = [], None, None, {}, False

    def enter(self, object, undone=False):
        """Begins with the values that the mode edits, or goes on with them after an undo."""
        self._kept.update((track.channel.key, track.kept) for track in self.tracks)
        self.tracks = [
            Track(channel, self.carrier, self._kept.get(channel.key), undone) for channel in self._channels(object)
        ] + [
            live_texture.TextureTrack(object, self.carrier, key, self._kept.get(key), undone)
            for key in live_texture.keys_of(object)
        ]
        self.keys = _keys(object)

    def _channels(self, object):
        """What reads and writes the values that the mode of an object edits."""
        if object.mode == "EDIT":
            return [live_edit.EditChannel(object, self.topology[1])]
        return live_paint.channels_of(object)

    def is_entered(self, object):
        """Whether the values at hand are those that the mode edits now."""
        return self.keys == _keys(object) and all(track.channel.is_alive() for track in self.tracks)

    def update(self):
        """Somebody may have changed something."""
        for track in self.tracks:
            if not track.channel.is_busy():
                track.update(self.lit)
        if self._is_in_the_middle() and not self._waits and not bpy.app.background:
            self._waits = True
            bpy.app.timers.register(self._wait_for_the_end, first_interval=0.05)

    def _is_in_the_middle(self):
        channels = [track.channel for track in self.tracks]
        return any(channel.is_busy() or channel.operation() is not None for channel in channels)

    def _wait_for_the_end(self):
        """An operation that is confirmed where it is changes nothing more: no update tells of its end."""
        if self not in _sessions.values() or not all(track.channel.is_alive() for track in self.tracks):
            self._waits = False
        elif not self._is_in_the_middle():
            self._waits = False
            self.update()
        else:
            for track in self.tracks:
                track.channel.catch_up()
        return 0.05 if self._waits else None

    @property
    def edit(self):
        """The vertices in edit mode."""
        return self.tracks[0].channel


def _keys(object):
    """Changes when the mode edits other values."""
    return object.mode, mesh_data.key_name(object), live_paint.keys_of(object) + live_texture.keys_of(object)


def mark_of(mesh):
    """What changes with the stored map; nothing without one."""
    record = mesh.get(stored_map.RECORD)
    return None if record is None else record["checksum"]


def _load(mesh):
    """The stored map, in any mode."""
    if not mesh.is_editmode:
        return stored_map.load(mesh)
    copy = bpy.data.meshes.new("live")
    try:
        bmesh.from_edit_mesh(mesh).to_mesh(copy)
        if stored_map.RECORD in mesh:
            copy[stored_map.RECORD] = mesh[stored_map.RECORD].to_dict()
        return stored_map.load(copy)
    finally:
        bpy.data.meshes.remove(copy)


def switch_on(object):
    """Raises mesh_data.MeshProblem if there is no map to follow, or the mesh cannot be written."""
    if problem := mesh_data.why_fixed(object, is_left=object.mode == "EDIT"):
        raise mesh_data.MeshProblem(f"the mesh {problem}")
    session = Session(object)
    session.enter(object)
    _sessions[object.session_uid] = session


def _switch_off(object, reason):
    """The reason is told to the user, in the status bar and in the panel."""
    global _switching
    _sessions.pop(object.session_uid, None)
    _switching = True
    object.intrinsic_symmetry_live = object.intrinsic_symmetry_live_select = False
    _switching = False
    reasons[object.session_uid] = reason
    if not bpy.app.background:
        _say(reason)
        bpy.app.timers.register(_say, first_interval=_SECONDS)


def _say(text=None):
    """In the status bar of every window; nothing takes it away."""
    for window in bpy.context.window_manager.windows:
        window.workspace.status_text_set(text)


def wanted(object):
    return object.type == "MESH" and (object.intrinsic_symmetry_live or object.intrinsic_symmetry_live_select)


def _session(object):
    """That of an object with Live on, made if there is none that fits its map. Raises if there cannot be one."""
    session = _sessions.get(object.session_uid)
    if session is None or session.mark != mark_of(object.data):
        switch_on(object)
    return _sessions.get(object.session_uid)


def _fits(session, object):
    """Whether the mesh is still the one that the map is of. In the middle of a transformation its counts say enough."""
    in_the_middle = object.mode == "EDIT" and session.is_entered(object) and session.edit.operation() is not None
    return live_edit.has(object, session.topology, in_the_middle)


@contextmanager
def _off_if_it_fails(object):
    """Switches Live off where the other side cannot follow; in a handler nobody would hear of it. What is no fault of
    the mesh is raised again, for the console."""
    try:
        yield
    except Exception as problem:
        expected = isinstance(problem, (mesh_data.MeshProblem, intrinsym.IntrinsymError))
        _switch_off(object, f"Live Mirror is off: {problem if expected else repr(problem)}")
        if not expected:
            raise


def _follow(object, moved, undone=False):
    with _off_if_it_fails(object):
        _follow_session(_session(object), object, moved, undone)


def _follow_session(session, object, moved, undone):
    entered = session.is_entered(object)
    if (moved or not entered) and not _fits(session, object):
        _switch_off(object, _TOPOLOGY)
        return
    if undone or not entered:
        session.enter(object, undone)
    elif moved and object.intrinsic_symmetry_live:
        session.update()
    if object.intrinsic_symmetry_live_select and object.mode == "EDIT" and session.edit.operation() is None:
        live_select.follow(session, object, undone)


@bpy.app.handlers.persistent
def _on_update(_scene, depsgraph):
    if _undoing or depsgraph.mode != "VIEWPORT":
        return
    for update in depsgraph.updates:
        if isinstance(update.id, bpy.types.Object):
            object = update.id.original
            if wanted(object):
                _follow(object, update.is_updated_geometry or object.mode not in ("EDIT", "OBJECT"))


@bpy.app.handlers.persistent
def _before_undo(*_):
    global _undoing
    _undoing = True


@bpy.app.handlers.persistent
def _after_undo(*_):
    global _undoing
    _undoing = False
    for object in bpy.context.view_layer.objects:
        if wanted(object):
            _follow(object, True, undone=True)


@bpy.app.handlers.persistent
def _on_load(*_):
    _sessions.clear()
    reasons.clear()


def _toggled(object, _context):
    if _switching:
        return
    reasons.pop(object.session_uid, None)
    before = _sessions.pop(object.session_uid, None)
    if wanted(object):
        with _off_if_it_fails(object):
            session = _session(object)
            if before and before.mark == session.mark and object.intrinsic_symmetry_live_select:
                session.lit, session.lit_with = before.lit, before.lit_with


#: Handlers and the lists they are in.
_HANDLERS = (
    ("depsgraph_update_post", _on_update),
    ("undo_pre", _before_undo),
    ("redo_pre", _before_undo),
    ("undo_post", _after_undo),
    ("redo_post", _after_undo),
    ("load_post", _on_load),
)


def register():
    bpy.types.Object.intrinsic_symmetry_live = bpy.props.BoolProperty(
        name="Live Mirror",
        description="What you move, sculpt or paint on one side happens on the other, in any pose",
        update=_toggled,
    )
    bpy.types.Object.intrinsic_symmetry_live_select = bpy.props.BoolProperty(
        name="Live Selection", description="In edit mode, what you select lights up on the other side", update=_toggled
    )
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    _sessions.clear()
    del bpy.types.Object.intrinsic_symmetry_live_select
    del bpy.types.Object.intrinsic_symmetry_live
