# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside a Blender window: Live Mirror under the hands of a user, by simulated events. Called by `make.sh live`.

Checks grab, Esc, undo, redo, proportional editing, sculpt and texture paint strokes; writes the time of an update by
size; and photographs what the picture in the docs shows, frame by frame. The steps run as those of window.py do.
"""

import sys
import time

import bpy
import numpy as np

sys.path.insert(0, "/session")
import window  # noqa: E402
from hands import (  # noqa: E402
    aim, event, human, kept, middle, module, move, on_screen, places, press, redo, rest, sides, stroke, undo,
)
from paint import PAINT  # noqa: E402
from window import PICTURES, area, import_human, in_view, install, look, photograph, region, show_tab  # noqa: E402

#: Vertices of the meshes whose updates are timed.
SIZES = (5_000, 25_000, 100_000)
ops = bpy.ops.intrinsic_symmetry
#: Times of updates.
times = {}


def select_hand(count):
    """The left hand's vertices, in edit mode."""
    mesh = human().data
    with bpy.context.temp_override(window=bpy.context.window, area=area(), region=region()):
        bpy.ops.object.mode_set(mode="OBJECT")
        points, side = places(), module("mesh_data").read_attribute(mesh.attributes[module("stored_map").SIDE])
        tip = np.argmax(np.where(side == 1, np.abs(points[:, 0]), -np.inf))
        near = np.argsort(np.where(side == 1, np.linalg.norm(points - points[tip], axis=1), np.inf))
        flags = np.zeros(len(points), bool)
        flags[near[:count]] = True
        module("ops_select").write_selection(bpy.context, mesh, flags)
        bpy.ops.object.mode_set(mode="EDIT")


def keep(name):
    kept[name] = places()


def is_as(name):
    far = np.abs(places() - kept[name]).max(axis=1)
    on = [int((far[sides() == side] > 0).sum()) for side in (1, 0, -1)]
    running = [operator.bl_idname for operator in bpy.context.window.modal_operators]
    assert not far.any(), f"not as {name}: {on} vertices of left, line and right, by {far.max()}; {running}"


def moved_on_both_sides(since, least):
    moved = np.any(places() != kept[since], axis=1)
    on = [int((moved & (sides() == side)).sum()) for side in (1, -1)]
    assert min(on) > least, f"moved on the two sides: {on}"


def live_on():
    human().intrinsic_symmetry_live = True
    assert human().intrinsic_symmetry_live, module("live").problem_of(human())


def proportional(on):
    bpy.context.scene.tool_settings.use_proportional_edit = on
    bpy.context.scene.tool_settings.proportional_size = 0.3


def grab(steps, end, wait=0.08):
    """G, mouse moves, and the event that ends it."""
    found = [(lambda: move(0, 0), wait), (lambda: press("G"), wait)]
    found += [(lambda x=x, y=y: move(x, y), wait) for x, y in steps]
    return [*found, (lambda: press(end), 1.0), (rest, 0.1)]


WAY = [(8 * step, 5 * step) for step in range(1, 8)]
EDIT = [
    (lambda: keep("start"), 0.1),
    *grab(WAY, "ESC"),
    (lambda: is_as("start"), 0.1),
    *grab(WAY, "RET"),
    (lambda: (moved_on_both_sides("start", 100), keep("grabbed")), 0.1),
    *grab(WAY[::-1], "LEFTMOUSE"),
    (lambda: keep("twice"), 0.1),
    (undo, 0.5),
    (lambda: is_as("grabbed"), 0.1),
    (undo, 0.5),
    (lambda: is_as("start"), 0.1),
    (redo, 0.5),
    (lambda: is_as("grabbed"), 0.1),
    (redo, 0.5),
    (lambda: is_as("twice"), 0.1),
    (undo, 0.5),
    (undo, 0.5),
    (lambda: proportional(True), 0.1),
    *grab(WAY, "ESC"),
    (lambda: is_as("start"), 0.1),
    *grab(WAY, "RET"),
    (lambda: (moved_on_both_sides("start", 500), keep("falloff")), 0.1),
    (undo, 0.5),
    (lambda: is_as("start"), 0.1),
    (redo, 0.5),
    (lambda: is_as("falloff"), 0.1),
    (undo, 0.5),
    (lambda: (proportional(False), is_as("start")), 0.1),
]


def sculpt_mode():
    in_view(bpy.ops.object.mode_set, mode="OBJECT")
    in_view(bpy.ops.object.mode_set, mode="SCULPT")
    bpy.context.scene.tool_settings.sculpt.use_symmetry_x = False
    human().data.use_mirror_x = False
    if bpy.context.scene.tool_settings.sculpt.brush is None:  # Debian's Blender has no brushes
        bpy.data.brushes.new("Draw", mode="SCULPT").asset_mark()
        in_view(
            bpy.ops.brush.asset_activate, asset_library_type="LOCAL", relative_asset_identifier="Brush/Draw"
        )
    in_view(bpy.ops.ed.undo_push, message="Sculpt mode")


SCULPT = [
    (sculpt_mode, 1.0),
    (lambda: (aim(), keep("start")), 0.1),
    *stroke(),
    (lambda: (moved_on_both_sides("start", 20), keep("stroke"), photograph("sculpted")), 0.1),
    *stroke(),
    (lambda: keep("strokes"), 0.1),
    (undo, 1.5),
    (lambda: is_as("stroke"), 0.1),
    (undo, 1.5),
    (lambda: is_as("start"), 0.1),
    (redo, 1.5),
    (lambda: is_as("stroke"), 0.1),
    (redo, 1.5),
    (lambda: is_as("strokes"), 0.1),
    (undo, 1.5),
    (undo, 1.5),
    (lambda: in_view(bpy.ops.object.mode_set, mode="OBJECT"), 0.5),
]


def pose_for_film():
    """Nothing but the figure; both hands in sight."""
    space = area().spaces.active
    space.show_region_ui = space.show_region_toolbar = space.show_gizmo = False
    space.overlay.show_axis_x = space.overlay.show_axis_y = space.overlay.show_cursor = False
    bpy.context.tool_settings.mesh_select_mode = (False, False, True)
    select_hand(900)
    selected = module("live")._sessions[human().session_uid].edit.flags_of("select")
    in_view(bpy.ops.view3d.zoom, delta=-1)
    area().spaces.active.region_3d.update()
    kept["aim"] = on_screen(int(np.flatnonzero(selected)[0]))


def film():
    """A hand and its forearm are scaled, photographed at every move."""
    number = iter(range(100))
    way = [60 + 7 * step for step in (*range(0, 13), *range(12, -1, -1))]
    found = [
        (lambda: (proportional(True), pose_for_film()), 1.0),
        (lambda: move(kept["aim"][0] - 60, kept["aim"][1]), 0.2),
        (lambda: press("S"), 0.3),
    ]
    for x in way:
        found.append((lambda x=x: move(kept["aim"][0] - x, kept["aim"][1]), 0.3))
        found.append((lambda: photograph(f"frame_{next(number):02}"), 0.05))
    return [*found, (lambda: press("ESC"), 0.3), (lambda: proportional(False), 0.1)]


def make_size(count):
    """The human with about so many vertices, and no mirrored connectivity; with its symmetry, and Live on."""
    in_view(bpy.ops.object.mode_set, mode="OBJECT")
    bpy.context.tool_settings.mesh_select_mode = (True, False, False)
    for old in list(bpy.data.objects):
        bpy.data.objects.remove(old)
    in_view(bpy.ops.wm.ply_import, filepath="/session/human.ply")
    levels = int(np.ceil(np.log(count / 13_380) / np.log(4))) if count > 13_380 else 0
    if levels:
        modifier = human().modifiers.new("finer", "SUBSURF")
        modifier.subdivision_type, modifier.levels = "SIMPLE", levels
        in_view(bpy.ops.object.modifier_apply, modifier="finer")
    modifier = human().modifiers.new("coarser", "DECIMATE")
    modifier.ratio = count / len(human().data.vertices)
    in_view(bpy.ops.object.modifier_apply, modifier="coarser")
    assert in_view(ops.detect, "EXEC_DEFAULT") == {"FINISHED"}
    in_view(bpy.ops.object.mode_set, mode="EDIT")
    begun = time.thread_time(), time.perf_counter()
    live_on()
    times["on", count] = time.thread_time() - begun[0], time.perf_counter() - begun[1]


def clock(name):
    """Times every update of Live that writes, from now on: what the thread takes, and what passes on the clock."""
    handlers, live = bpy.app.handlers.depsgraph_update_post, module("live")
    vertices = module("live_edit").EditVertices
    handlers[:] = [each for each in handlers if each is not live._on_update and each.__name__ != "timed"]
    entries = times.setdefault(name, [])

    def timed(scene, depsgraph):
        begun = time.thread_time(), time.perf_counter()
        write, written = vertices.write, []
        vertices.write = lambda *given: (written.append(True), write(*given))[1]
        live._on_update(scene, depsgraph)
        vertices.write = write
        if written:
            entries.append((time.thread_time() - begun[0], time.perf_counter() - begun[1]))

    handlers.append(timed)


def measured(count):
    def stop():
        clock("nothing")

    way = [(3 * step, 2 * step) for step in range(1, 11)]
    found = [(lambda: make_size(count), 1.0)]
    for name, share, wide in (("hand", 0.04, False), ("all of one side", 0.5, False), ("proportional", 0.04, True)):
        found += [
            (lambda share=share, wide=wide: (select_hand(int(share * count)), proportional(wide)), 1.0),
            (lambda name=name: clock((name, count)), 0.1),
            *grab(way, "ESC", wait=0.15),
            (stop, 0.1),
        ]
    return [*found, (lambda: proportional(False), 0.1)]


def report():
    lines = ["| vertices | switched on | hand | all of one side | proportional |", "|---|---|---|---|---|"]
    for count in SIZES:
        row = ["{:.0f} ms ({:.0f})".format(*(1e3 * took for took in times["on", count]))]
        for name in ("hand", "all of one side", "proportional"):
            updates = times[name, count][2:-1]  # the first ones begin it, the last one ends it
            row.append("{:.1f} ms ({:.1f})".format(*1e3 * np.median(updates, axis=0)))
        lines.append(f"| {count} | " + " | ".join(row) + " |")
    bpy.app.handlers.depsgraph_update_post.append(module("live")._on_update)  # `clock` took it out
    (PICTURES / "times.txt").write_text("\n".join(lines) + "\n")


def detect():
    assert in_view(ops.detect, "EXEC_DEFAULT") == {"FINISHED"}


def begin():
    select_hand(150)
    live_on()
    in_view(bpy.ops.ed.undo_push, message="Start")


#: What runs, by the argument of the script; all without one.
PARTS = {
    "edit": EDIT,
    "sculpt": SCULPT,
    "paint": PAINT,
    "film": film(),
    "times": [*(step for count in SIZES for step in measured(count)), (report, 0.1)],
}
CHOSEN = sys.argv[sys.argv.index("--") + 1 :] or PARTS

window.STEPS[:] = [
    (install, 1.0),
    (import_human, 0.5),
    (show_tab, 0.5),
    (lambda: look(15), 1.0),
    (detect, 0.5),
    (begin, 1.0),
    (lambda: photograph("live"), 0.1),
    *[step for name in CHOSEN for step in PARTS[name]],
]
