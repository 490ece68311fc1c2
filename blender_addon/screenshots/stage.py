# SPDX-License-Identifier: GPL-3.0-or-later
"""Steps in a Blender window, with the extension and the human in it. Imported by the scripts that make.sh runs there.

The steps run from a timer, so that the window redraws in between.
"""

import subprocess
import traceback
from glob import glob
from math import radians
from pathlib import Path

import bpy
from mathutils import Euler

FOLDER = Path("/session")
PICTURES = FOLDER / "pictures"
#: What a step answers that has to be done again.
AGAIN = object()
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


def module(name):
    """A module of the extension."""
    import importlib

    return importlib.import_module(f"bl_ext.user_default.intrinsic_symmetry.{name}")


def click(x, y):
    """A click at a place of the window, in pixels from its lower left corner."""
    window = bpy.context.window
    window.event_simulate("MOUSEMOVE", "NOTHING", x=x, y=y)
    window.event_simulate("LEFTMOUSE", "PRESS", x=x, y=y)
    window.event_simulate("LEFTMOUSE", "RELEASE", x=x, y=y)


def start(steps):
    """Runs (step, seconds to wait after it), and quits."""

    def run():
        try:
            step, wait = steps.pop(0)
            if step() is AGAIN:
                steps.insert(0, (step, wait))
                return wait
        except Exception:
            traceback.print_exc()
            (PICTURES / "failed.txt").write_text(traceback.format_exc())
            steps.clear()
        if not steps:
            bpy.ops.wm.quit_blender()
            return None
        area().tag_redraw()
        return wait

    bpy.app.timers.register(run, first_interval=2.0)
