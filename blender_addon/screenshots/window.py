# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside a Blender window: does what a user does, and photographs it. Called by make.sh.

The steps run from a timer, so that the window redraws in between; the modal run and Esc are simulated events.
"""

import subprocess
import traceback
from glob import glob
from math import radians
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler

FOLDER = Path("/session")
PICTURES = FOLDER / "pictures"
#: What a step answers that has to wait for the worker.
AGAIN = object()
ops = bpy.ops.intrinsic_symmetry
bpy.context.preferences.view.show_splash = False


def area():
    return next(area for area in bpy.context.window.screen.areas if area.type == "VIEW_3D")


def region():
    return next(region for region in area().regions if region.type == "WINDOW")


def in_view(call, *arguments, **keywords):
    """Calls an operator as if the mouse were over the 3D viewport."""
    with bpy.context.temp_override(window=bpy.context.window, area=area(), region=region()):
        return call(*arguments, **keywords)


def photograph(name):
    subprocess.run(["import", "-window", "root", PICTURES / f"{name}.png"], check=True)


def look(around=20):
    view = area().spaces.active.region_3d
    view.view_rotation = Euler((radians(84), 0, radians(around))).to_quaternion()
    view.view_perspective = "PERSP"
    in_view(bpy.ops.view3d.view_selected)


def install():
    bpy.ops.extensions.package_install_files(
        repo="user_default", filepath=glob(str(FOLDER / "*.zip"))[0], enable_on_install=True
    )


def import_human():
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    bpy.ops.wm.ply_import(filepath=str(FOLDER / "human.ply"))
    in_view(bpy.ops.object.shade_smooth)
    area().spaces.active.shading.color_type = "OBJECT"
    area().spaces.active.overlay.show_floor = False
    area().spaces.active.show_region_ui = True


def show_tab():
    side = next(region for region in area().regions if region.type == "UI")
    side.active_panel_category = "Symmetry"


def settings():
    return bpy.context.window_manager.intrinsic_symmetry_show


def select_hand():
    mesh = bpy.context.object.data
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    chosen = np.argsort(-points.reshape(-1, 3)[:, 0])[:700]  # the raised hand
    flags = np.zeros(len(mesh.vertices), bool)
    flags[chosen] = True
    mesh.vertices.foreach_set("select", flags)
    mesh.edges.foreach_set("select", np.zeros(len(mesh.edges), bool))
    mesh.polygons.foreach_set("select", np.zeros(len(mesh.polygons), bool))
    bpy.ops.object.mode_set(mode="EDIT")
    ops.select(extend=True)


def start_and_press_escape():
    """Two symmetries are sought, which takes a second: one is told by the mirrored connectivity at once. The key is
    pressed before the window may stall."""
    in_view(ops.detect, "INVOKE_DEFAULT", symmetries=2)
    assert running(), "no modal run was started"
    escape()


def running():
    import importlib

    return importlib.import_module("bl_ext.user_default.intrinsic_symmetry.ops_detect").running


def escape():
    bpy.context.window.event_simulate("ESC", "PRESS")


def was_cancelled():
    if running():
        return AGAIN
    assert "sym_vertex" not in bpy.context.object.data.attributes, "Esc did not cancel"
    (PICTURES / "esc.txt").write_text("Esc cancelled the modal run\n")


def detected():
    if running():
        return AGAIN
    assert "sym_vertex" in bpy.context.object.data.attributes, "the modal run kept nothing"


def click(x, y):
    """A click at a place of the window, in pixels from its lower left corner."""
    window = bpy.context.window
    window.event_simulate("MOUSEMOVE", "NOTHING", x=x, y=y)
    window.event_simulate("LEFTMOUSE", "PRESS", x=x, y=y)
    window.event_simulate("LEFTMOUSE", "RELEASE", x=x, y=y)


def open_label_panel():
    """Its header, closed at first, as the window lies; then that of Select, so that there is room."""
    click(860, 126)
    click(860, 651)


def show(**values):
    for name, value in values.items():
        setattr(settings(), name, value)


def undo_and_redo():
    """The modal run left one undo step."""
    in_view(bpy.ops.ed.undo)
    assert "sym_vertex" not in bpy.context.object.data.attributes, "the modal run cannot be undone"
    in_view(bpy.ops.ed.redo)
    assert "sym_vertex" in bpy.context.object.data.attributes, "the modal run cannot be redone"


#: What is done, and the seconds to wait after it.
STEPS = [
    (install, 1.0),
    (import_human, 0.5),
    (show_tab, 0.5),
    (lambda: look(15), 1.0),
    (start_and_press_escape, 1.5),
    (was_cancelled, 0.1),
    (lambda: in_view(ops.detect, "INVOKE_DEFAULT", symmetries=2), 0.4),
    (lambda: photograph("progress"), 0.5),
    (detected, 0.1),
    (undo_and_redo, 0.5),
    (lambda: show(line=True, colours="CONFIDENCE"), 1.5),
    (lambda: photograph("confidence"), 0.1),
    (lambda: show(colours="SIDE"), 1.5),
    (lambda: photograph("sides"), 0.1),
    (lambda: show(colours="NONE", pairs=True), 0.5),
    (select_hand, 2.0),
    (lambda: photograph("pairs"), 0.1),
    (lambda: in_view(bpy.ops.wm.call_menu, name="VIEW3D_MT_select_edit_mesh"), 1.0),
    (lambda: photograph("menu"), 0.1),
    (escape, 0.5),
    (lambda: (bpy.ops.object.mode_set(mode="OBJECT"), show(pairs=False)), 0.5),
    (lambda: ops.study(), 1.0),
    (open_label_panel, 1.0),
    (lambda: ops.step(by=1), 1.5),
    (lambda: photograph("eigenfunction"), 0.1),
    (lambda: show(line=False, colours="NONE"), 1.0),
]


def run():
    try:
        step, wait = STEPS.pop(0)
        if step() is AGAIN:
            STEPS.insert(0, (step, wait))
            return 0.5
    except Exception:
        traceback.print_exc()
        (PICTURES / "failed.txt").write_text(traceback.format_exc())
        bpy.ops.wm.quit_blender()
        return None
    if not STEPS:
        bpy.ops.wm.quit_blender()
        return None
    area().tag_redraw()
    return wait


bpy.app.timers.register(run, first_interval=2.0)
