# SPDX-License-Identifier: GPL-3.0-or-later
"""Show: pair lines, the line between left and right, and colours, drawn over the viewport and never stored.

Switching everything off removes the draw handler; nothing of the mesh, its materials or the shading is changed.
"""

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from . import overlay_data, stored_map

COLOURS = (
    ("NONE", "None", "No colours"),
    ("CONFIDENCE", "Confidence", "Blue: trustworthy. Red: not"),
    ("SIDE", "Side", "Orange: left. Blue: right"),
    ("EIGENFUNCTION", "Eigenfunction", "The one that is active under Correct and Label"),
)

_handle = None
#: Batches of the last drawing, and what they are of.
_cache = {"key": None, "batches": []}


def settings(context):
    return context.window_manager.intrinsic_symmetry_show


def show_doubt():
    """Shows where a map can be trusted, unless other colours are shown."""
    show = settings(bpy.context)
    if show.colours == "NONE":
        show.colours = "CONFIDENCE"


def redraw(_self=None, context=None):
    """Property update: adds or removes the draw handler as needed, and draws again."""
    context = context or bpy.context
    show = settings(context)
    _switch(show.pairs or show.line or show.colours != "NONE")
    invalidate()
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def _switch(wanted):
    global _handle
    if wanted and _handle is None:
        _handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW")
        bpy.app.handlers.depsgraph_update_post.append(_on_change)
    elif not wanted and _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        bpy.app.handlers.depsgraph_update_post.remove(_on_change)
        _handle = None


def is_on():
    return _handle is not None


def invalidate():
    _cache.update(key=None, batches=[])


@bpy.app.handlers.persistent
def _on_change(_scene, depsgraph):
    if any(isinstance(update.id, (bpy.types.Object, bpy.types.Mesh)) for update in depsgraph.updates):
        invalidate()


def _draw():
    context = bpy.context
    object = context.active_object
    if object is None or object.type != "MESH" or not object.visible_get():
        return
    show = settings(context)
    key = (object.name, object.mode, show.pairs, show.line, show.colours)
    if _cache["key"] != key:
        _cache.update(key=key, batches=_batches(object, show, context.evaluated_depsgraph_get()))
    gpu.state.blend_set("ALPHA")
    with gpu.matrix.push_pop():
        gpu.matrix.multiply_matrix(object.matrix_world)
        for shader, batch, width, depth in _cache["batches"]:
            gpu.state.depth_test_set(depth)
            shader.bind()
            if width:
                shader.uniform_float("lineWidth", width)
                shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
            batch.draw(shader)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


def _batches(object, show, depsgraph):
    """(shader, batch, line width or 0, depth test) of each thing to draw."""
    shape, found = overlay_data.shape_of(object, depsgraph), []
    if show.colours != "NONE":
        colours = overlay_data.surface_colours(shape, object, show.colours)
        if colours is not None:
            found.append(_surface(shape, colours))
    if not overlay_data.fits(shape, object.data):
        return found
    if show.line:
        ends = overlay_data.line_segments(shape, stored_map.fixed_lines(object.data))
        found.append(_lines(ends, np.tile(np.float32((1, 1, 0.2, 1)), (len(ends), 1)), 3.0, "LESS_EQUAL"))
    alone = "members" not in object.data[stored_map.RECORD]  # else the images lie in other objects too
    if show.pairs and alone and shape.selected.any():
        found.append(_lines(*overlay_data.pair_lines(shape), 1.0, "NONE"))
    return [entry for entry in found if entry is not None]


def _surface(shape, colours):
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    content = {"pos": shape.lifted().astype(np.float32), "color": colours}
    return shader, batch_for_shader(shader, "TRIS", content, indices=shape.triangles), 0, "LESS_EQUAL"


def _lines(ends, colours, width, depth):
    if not len(ends):
        return None  # Blender makes no batch of nothing
    shader = gpu.shader.from_builtin("POLYLINE_SMOOTH_COLOR")
    content = {"pos": ends.astype(np.float32), "color": colours}
    return shader, batch_for_shader(shader, "LINES", content), width, depth


class IntrinsicSymmetryShow(bpy.types.PropertyGroup):
    pairs: bpy.props.BoolProperty(
        name="Pairs of the Selection",
        description="Lines from selected vertices to their mirror images",
        default=False, update=redraw,
    )
    line: bpy.props.BoolProperty(
        name="Symmetry Line", description="The line between left and right", default=False, update=redraw
    )
    colours: bpy.props.EnumProperty(
        name="Colors", description="Colors over the surface; they are not stored", items=COLOURS, update=redraw
    )


def register():
    bpy.utils.register_class(IntrinsicSymmetryShow)
    bpy.types.WindowManager.intrinsic_symmetry_show = bpy.props.PointerProperty(type=IntrinsicSymmetryShow)


def unregister():
    _switch(False)
    invalidate()
    del bpy.types.WindowManager.intrinsic_symmetry_show
    bpy.utils.unregister_class(IntrinsicSymmetryShow)
