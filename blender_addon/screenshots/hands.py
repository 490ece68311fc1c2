# SPDX-License-Identifier: GPL-3.0-or-later
"""The hands of a user in a Blender window, by simulated events; and what they have to know of the human there."""

import importlib

import bmesh
import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from window import AGAIN, area, region

#: What is kept from some moment, by name: positions, images, places of the mouse.
kept = {}


def module(name):
    """A module of the extension."""
    return importlib.import_module(f"bl_ext.user_default.intrinsic_symmetry.{name}")


def human():
    return bpy.context.object


def places():
    mesh = human().data
    if mesh.is_editmode:
        return np.array([vertex.co[:] for vertex in bmesh.from_edit_mesh(mesh).verts], np.float32)
    return module("mesh_data").positions(mesh)


def sides():
    return module("live")._sessions[human().session_uid].carrier.side


def event(kind, value="PRESS", at=None, **keywords):
    x, y = at or kept["mouse"]
    kept["mouse"] = x, y
    bpy.context.window.event_simulate(kind, value, x=x, y=y, **keywords)


def press(kind, **keywords):
    event(kind, "PRESS", **keywords)
    event(kind, "RELEASE", **keywords)


def move(x, y):
    """By pixels from the middle of the viewport."""
    event("MOUSEMOVE", "NOTHING", at=(middle()[0] + x, middle()[1] + y))


def middle():
    view = region()
    return view.x + view.width // 2, view.y + view.height // 2


def undo():
    press("Z", ctrl=True)


def redo():
    press("Z", ctrl=True, shift=True)


def rest():
    """Waits until no operator runs, and Live has seen the end of the last one: after a stall of the window the timer of a
    step may come before that of Live."""
    sessions = module("live")._sessions.values()
    if bpy.context.window.modal_operators or any(session._waits for session in sessions):
        return AGAIN


def on_screen(vertex):
    """Of a vertex, in pixels from the middle of the viewport."""
    view = area().spaces.active.region_3d
    place = location_3d_to_region_2d(region(), view, human().matrix_world @ human().data.vertices[vertex].co)
    return int(place[0]) - region().width // 2, int(place[1]) - region().height // 2


def aim():
    """At the left thigh."""
    points = places()
    wanted = np.array((0.35 * points[:, 0].max(), points[:, 1].min(), np.quantile(points[:, 2], 0.3)))
    front = np.where(sides() == 1, np.linalg.norm(points - wanted, axis=1), np.inf)
    kept["aim"] = on_screen(int(np.argmin(front)))


def stroke():
    """The button goes down, the mouse moves, the button goes up."""
    found = [(lambda: move(*kept["aim"]), 0.3), (lambda: event("LEFTMOUSE", "PRESS"), 0.2)]
    for x in range(0, 24, 4):
        found.append((lambda x=x: move(kept["aim"][0], kept["aim"][1] + x), 0.2))
    return [*found, (lambda: event("LEFTMOUSE", "RELEASE"), 1.5), (rest, 0.1)]
