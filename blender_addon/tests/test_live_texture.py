# SPDX-License-Identifier: GPL-3.0-or-later
"""Live mirror in texture paint: strokes on the active image arrive at their mirror images."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module

SIZE = 512
RED = (1, 0, 0, 1)


def pixels(image):
    values = np.empty(4 * SIZE * SIZE, np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(SIZE, SIZE, 4)


def put(image, values):
    """As Blender's strokes do, with an update of the object at their end."""
    image.pixels.foreach_set(np.ascontiguousarray(values, np.float32).ravel())
    image.update()
    bpy.context.object.update_tag()
    bpy.context.view_layer.update()


def uv_of_vertices(mesh):
    """(vertices, 2) in texels: of one corner of each; and which vertices have one place alone, (vertices,) bool."""
    uvs, corners = np.empty(2 * len(mesh.loops), np.float32), np.empty(len(mesh.loops), np.int32)
    mesh.uv_layers.active.data.foreach_get("uv", uvs)
    mesh.loops.foreach_get("vertex_index", corners)
    places = np.zeros((len(mesh.vertices), 2))
    uvs = uvs.reshape(-1, 2) * SIZE - 0.5
    places[corners] = uvs
    alone = np.ones(len(places), bool)
    alone[corners[np.abs(uvs - places[corners]).max(axis=1) > 0.1]] = False
    return places, alone


def at(values, places):
    x, y = np.clip(np.round(places).astype(int), 0, SIZE - 1).T
    return values[y, x]


@pytest.fixture(params=["human", "quadruped"])
def painted(request):
    """In texture paint, with Live Mirror and an empty image."""
    object = request.getfixturevalue(request.param)
    enter("EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(island_margin=0.01)
    enter("OBJECT")
    image, material = bpy.data.images.new("paint", SIZE, SIZE, alpha=True), bpy.data.materials.new("paint")
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.nodes.active = node
    object.data.materials.append(material)
    enter("TEXTURE_PAINT")
    object.intrinsic_symmetry_live = True
    assert object.intrinsic_symmetry_live
    return object, image


def stroke(object, image, side, colour=RED):
    """Paints a disc about the UV of a vertex of a side. Returns the places in the image that were painted."""
    (places, alone), sides = uv_of_vertices(object.data), attribute(object.data, "sym_side")
    inside = (sides == side) & alone & (np.abs(places - SIZE / 2).max(axis=1) < SIZE / 2 - 30)
    middle = places[np.flatnonzero(inside)[inside.sum() // 2]]
    y, x = np.mgrid[:SIZE, :SIZE]
    disc = np.hypot(x - middle[0], y - middle[1]) < 20
    values = pixels(image)
    values[disc] = colour
    put(image, values)
    return disc


def follows(object, disc, before, after):
    """Checks the right side's vertices: where the UV of the mirror image was painted, that of the vertex is too."""
    (places, alone), partner = uv_of_vertices(object.data), attribute(object.data, "sym_vertex")
    sides, own, new = attribute(object.data, "sym_side"), at(disc, places), np.abs(after - before).max(axis=2) > 0.5
    counted = alone & alone[partner] & (partner >= 0) & (sides == -1) & ~own
    follows = counted & (sides[partner] == 1) & own[partner]
    assert follows.sum() > 5 and at(new, places)[follows].mean() > 0.9
    assert at(new, places)[counted & ~follows].mean() < 0.005


def test_a_stroke_arrives_on_the_other_side(painted):
    object, image = painted
    before = pixels(image)
    disc = stroke(object, image, 1)
    after = pixels(image)
    assert (after[disc] == RED).all(), "what you paint yourself stays"
    follows(object, disc, before, after)
    put(image, after)
    assert np.array_equal(pixels(image), after), "our own change is no stroke"


def test_what_is_painted_is_the_colour_on_the_other_side(painted):
    """Whatever was there before."""
    object, image = painted
    (places, alone), partner = uv_of_vertices(object.data), attribute(object.data, "sym_vertex")
    sides = attribute(object.data, "sym_side")
    object.intrinsic_symmetry_live = False
    disc, grey = stroke(object, image, 1, (0, 0, 0, 1)), pixels(image)
    grey[~disc] = (0.5, 0.5, 1, 1)
    put(image, grey)
    object.intrinsic_symmetry_live = True
    values = grey.copy()
    values[disc] = RED
    put(image, values)
    own = at(disc, places)
    follows = alone & alone[partner] & (partner >= 0) & (sides == -1) & ~own & (sides[partner] == 1) & own[partner]
    found = np.abs(at(pixels(image), places)[follows] - RED).max(axis=1)
    assert follows.sum() > 5 and (found < 0.01).mean() > 0.8


def test_undo_and_redo_take_both_sides(painted):
    """Blender brings back its own strokes alone."""
    object, image = painted
    live, states, discs = module("live"), [pixels(image)], []
    for side, colour in ((1, RED), (-1, (0, 1, 0, 1))):
        discs.append(stroke(object, image, side, colour))
        states.append(pixels(image))
    for number, disc in ((1, discs[1]), (0, discs[0]), (1, discs[0]), (2, discs[1])):
        live._before_undo()
        values = pixels(image)
        values[disc] = states[number][disc]
        image.pixels.foreach_set(values.ravel())
        live._after_undo()
        assert np.array_equal(pixels(image), states[number])


def test_sides_that_share_texels_are_painted_once(painted):
    object, image = painted
    points, corners = module("mesh_data").positions(object.data), np.empty(len(object.data.loops), np.int32)
    object.data.loops.foreach_get("vertex_index", corners)
    flat = (points[:, 1:] - points[:, 1:].min(axis=0)) / np.ptp(points, axis=0).max()
    object.data.uv_layers.active.data.foreach_set("uv", (0.1 + 0.8 * flat)[corners].astype(np.float32).ravel())
    disc = stroke(object, image, 1, (0.4, 0.4, 0.4, 1))
    assert np.abs(pixels(image)[disc][:, :3] - 0.4).max() < 0.01


def test_hidden_faces_stay(painted):
    object, image = painted
    before = pixels(image)
    object.data.polygons.foreach_set("hide", np.ones(len(object.data.polygons), bool))
    disc = stroke(object, image, 1)
    changed = (pixels(image) != before).any(axis=2)
    assert np.array_equal(changed, disc)
