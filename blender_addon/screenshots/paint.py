# SPDX-License-Identifier: GPL-3.0-or-later
"""Live Mirror in texture paint, part of live.py: strokes, undo and redo."""

import bpy
import numpy as np
from hands import aim, human, kept, module, redo, stroke, undo
from window import area, in_view, photograph


def paint_mode():
    """Texture paint, with an empty image on a UV map of its own."""
    tools, mesh = bpy.context.scene.tool_settings, human().data
    in_view(bpy.ops.object.mode_set, mode="EDIT")
    in_view(bpy.ops.mesh.select_all, action="SELECT")
    in_view(bpy.ops.uv.smart_project, island_margin=0.005)
    in_view(bpy.ops.object.mode_set, mode="OBJECT")
    image, material = bpy.data.images.new("paint", 1024, 1024), bpy.data.materials.new("paint")
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.nodes.active = node
    mesh.materials.clear()
    mesh.materials.append(material)
    in_view(bpy.ops.object.mode_set, mode="TEXTURE_PAINT")
    if tools.image_paint.brush is None:
        bpy.data.brushes.new("Paint", mode="TEXTURE_PAINT").asset_mark()
        identifier = "Brush/Paint"
        in_view(bpy.ops.brush.asset_activate, asset_library_type="LOCAL", relative_asset_identifier=identifier)
    tools.unified_paint_settings.color = (1, 0.2, 0)
    area().spaces.active.shading.color_type = "TEXTURE"
    in_view(bpy.ops.ed.undo_push, message="Texture paint")


def pixels():
    image = bpy.data.images["paint"]
    values = np.empty(4 * image.size[0] * image.size[1], np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(-1, 4)


def keep_image(name):
    kept[name] = pixels()


def image_is_as(name):
    differs = int((pixels() != kept[name]).any(axis=1).sum())
    assert not differs, f"{differs} texels are not as {name}"


def painted_on_both_sides(since):
    """The last stroke changed about as many texels of both sides."""
    track = module("live")._sessions[human().session_uid].tracks[0]
    ours = int(track.history[-1].ours.sum())
    changed = int((pixels() != kept[since]).any(axis=1).sum())
    assert changed > 100 and 0.3 < ours / changed < 0.7, f"{changed} texels changed, {ours} of them by Live"


PAINT = [
    (paint_mode, 1.5),
    (lambda: (aim(), keep_image("blank")), 0.1),
    *stroke(),
    (lambda: (painted_on_both_sides("blank"), keep_image("one"), photograph("painted")), 0.1),
    *stroke(),
    (lambda: keep_image("two"), 0.1),
    (undo, 1.5),
    (lambda: image_is_as("one"), 0.1),
    (undo, 1.5),
    (lambda: image_is_as("blank"), 0.1),
    (redo, 1.5),
    (lambda: image_is_as("one"), 0.1),
    (redo, 1.5),
    (lambda: image_is_as("two"), 0.1),
    (lambda: in_view(bpy.ops.object.mode_set, mode="OBJECT"), 0.5),
]
