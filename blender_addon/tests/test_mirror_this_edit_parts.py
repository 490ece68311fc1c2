# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror This Edit: parts that are duplicated from the skin, and what is moved with an edit in a pose."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import attribute, edit_faces, enter, faces_around, module, positions, said
from mathutils.bvhtree import BVHTree
from test_mirror_this_edit import MIRROR, _away, _edit, _middles, monkey  # noqa: F401

ops = bpy.ops.intrinsic_symmetry


def _shrink_fatten(depth):
    return lambda: bpy.ops.transform.shrink_fatten(value=depth)


def _subdivide():
    bpy.ops.mesh.subdivide()


def _across(mesh):
    """A band of faces across the line, as of a garment: its images are in it."""
    side, partner = attribute(mesh, "sym_side"), attribute(mesh, "sym_vertex")
    foot = positions(mesh)[np.flatnonzero(side == 0)[np.argmax(positions(mesh)[side == 0][:, 2])]]
    away = np.linalg.norm(positions(mesh) - foot, axis=1)
    inside = away <= np.sort(away)[len(away) // 5]
    inside |= inside[partner]
    faces = [face.index for face in mesh.polygons if inside[list(face.vertices)].all()]
    assert len(faces) > 40
    return faces


def _kept(mesh, edited, faces):
    """Nothing is gone, nor has moved."""
    assert len(mesh.polygons) == faces and len(mesh.vertices) == len(edited)
    assert _away(positions(mesh), edited).max() < 1e-5 * np.ptp(edited, axis=0).max()


@pytest.mark.parametrize("body, layers", [("monkey", 1), ("monkey", 2), ("human", 1)])
def test_issue_38_a_garment_across_the_line_stays(request, body, layers, capfd):
    object = request.getfixturevalue(body)
    mesh, depth = object.data, 0.005 * np.ptp(positions(object.data)[:, 2])
    edited = _edit(object, _across(mesh), *[bpy.ops.mesh.duplicate, _shrink_fatten(depth)] * layers)
    faces = len(mesh.polygons)
    words = said(capfd, ops.symmetrize_topology)
    assert "is replaced" not in words and "stay alone" not in words
    _kept(mesh, edited, faces)
    partner = attribute(mesh, "sym_vertex")
    assert partner.min() >= 0 and np.array_equal(partner[partner], np.arange(len(partner)))


def test_issue_38_the_whole_shell_doubled_stays(monkey, capfd):  # noqa: F811
    everything = range(len(monkey.data.polygons))
    edited = _edit(monkey, everything, bpy.ops.mesh.duplicate, _shrink_fatten(0.05))
    ops.symmetrize_topology()
    _kept(monkey.data, edited, 2 * len(everything))


def test_issue_38_what_is_made_on_one_side_of_a_garment_arrives_on_it(monkey):  # noqa: F811
    band = _across(monkey.data)
    _edit(monkey, band, bpy.ops.mesh.duplicate, _shrink_fatten(0.05))
    middles, faces = _middles(monkey.data), len(monkey.data.polygons)
    pocket = int(np.argmax(np.where(np.arange(faces) >= faces - len(band), middles[:, 0], -np.inf)))
    extrude = lambda: bpy.ops.mesh.extrude_region_shrink_fatten(TRANSFORM_OT_shrink_fatten={"value": 0.05})  # noqa: E731
    edited = _edit(monkey, [pocket], extrude)
    assert ops.symmetrize_topology() == {"FINISHED"}
    now = positions(monkey.data)
    assert len(monkey.data.polygons) == faces + 8 and _away(now, now * MIRROR).max() < 1e-5
    assert _away(now, edited[edited[:, 0] > 1e-4]).max() < 1e-6


def test_issue_38_a_patch_across_the_line_that_has_no_mirror_image_stays_alone(monkey, capfd):  # noqa: F811
    middles = _middles(monkey.data)
    patch = np.argsort(np.linalg.norm(middles - (0.25, 0, 0.9), axis=1))[:30]
    assert (middles[patch, 0] < 0).any()
    edited = _edit(monkey, patch, bpy.ops.mesh.duplicate, _shrink_fatten(0.05))
    faces = len(monkey.data.polygons)
    assert "stay alone" in said(capfd, ops.symmetrize_topology)
    _kept(monkey.data, edited, faces)


def test_issue_38_what_the_map_would_delete_on_both_sides_is_refused(monkey):  # noqa: F811
    """Here it says wrongly that a garment is the image of the skin."""
    mesh, skin = monkey.data, len(monkey.data.vertices)
    edited = _edit(monkey, _across(mesh), bpy.ops.mesh.duplicate, _shrink_fatten(0.05))
    faces = len(mesh.polygons)
    assert ops.carry() == {"FINISHED"}
    partner = attribute(mesh, "sym_vertex").copy()
    partner[skin:] = [int(np.argmin(np.linalg.norm(edited[:skin] - place * MIRROR, axis=1))) for place in edited[skin:]]
    core_mesh = module("detection").core_mesh_of(monkey, "BASE", None)
    module("stored_map").move_partners(mesh, core_mesh, partner)
    with pytest.raises(RuntimeError, match="deleted on both sides. Nothing is changed"):
        ops.symmetrize_topology()
    _kept(mesh, edited, faces)


def _patch(mesh, chosen):
    """Faces of the left side of the posed body, and their mirror images."""
    side, places = attribute(mesh, "sym_side"), positions(mesh)
    return faces_around(mesh, int(np.argmax(np.where(side == 1, places[:, 2] + places[:, 0], -np.inf))), chosen)


@pytest.mark.parametrize("steps", [
    [_shrink_fatten(0.01)], [lambda: bpy.ops.transform.translate(value=(0, 0.05, 0))], [_subdivide, _shrink_fatten(0.01)],
], ids=["raised", "moved", "subdivided"])
def test_issue_38_the_same_part_on_both_sides_stays_in_a_pose(human, steps, capfd):
    mesh = human.data
    left, right = _patch(mesh, slice(0, 30))
    edited = _edit(human, [*left, *right], bpy.ops.mesh.duplicate, *steps)
    faces = len(mesh.polygons)
    ops.symmetrize_topology()
    _kept(mesh, edited, faces)


def _heights(mesh, skin):
    return np.array([skin.find_nearest(place)[3] for place in positions(mesh).tolist()])


@pytest.mark.parametrize("at", [slice(0, 90), slice(30, 90)], ids=["a patch", "a ring"])
def test_issue_38_what_is_subdivided_and_raised_in_a_pose_is_as_high_on_the_other_side(human, at):
    mesh, count = human.data, len(human.data.vertices)
    skin = BVHTree.FromPolygons(positions(mesh).tolist(), [list(face.vertices) for face in mesh.polygons])
    _edit(human, _patch(mesh, at)[0], _subdivide, _shrink_fatten(0.01))
    assert ops.symmetrize_topology() == {"FINISHED"}
    high, side, partner = _heights(mesh, skin), attribute(mesh, "sym_side"), attribute(mesh, "sym_vertex")
    own = np.flatnonzero((high > 0.005) & (side == 1))
    assert len(own) > 60 and (own >= count).sum() > 30
    assert np.abs(high[partner[own]] - high[own]).max() < 0.2 * 0.01
    raised = [np.count_nonzero((high > 1e-5)[:count] & (side == at)[:count]) for at in (1, -1)]
    assert raised[0] == raised[1], "the others stay"


def test_issue_38_a_sleeve_follows_a_limb_in_another_pose(human):
    mesh, count = human.data, len(human.data.vertices)
    skin = BVHTree.FromPolygons(positions(mesh).tolist(), [list(face.vertices) for face in mesh.polygons])
    _edit(human, _patch(mesh, slice(900, 2400))[0], bpy.ops.mesh.duplicate, _shrink_fatten(0.01))
    assert ops.symmetrize_topology() == {"FINISHED"}
    high, side, partner = _heights(mesh, skin), attribute(mesh, "sym_side"), attribute(mesh, "sym_vertex")
    own = np.flatnonzero((np.arange(len(high)) >= count) & (side == 1))
    assert len(own) > 1000 and np.quantile(np.abs(high[partner[own]] - high[own]), 0.99) < 0.2 * 0.01


def test_issue_38_a_part_that_is_moved_and_subdivided_keeps_its_form_in_a_pose(human):
    mesh, count = human.data, len(human.data.vertices)
    edited = _edit(human, _patch(mesh, slice(0, 30))[0], bpy.ops.mesh.duplicate, _shrink_fatten(0.02), _subdivide)
    assert ops.symmetrize_topology() == {"FINISHED"}
    now, partner = positions(mesh), attribute(mesh, "sym_vertex")
    assert len(now) == 2 * len(edited) - count
    own = np.flatnonzero(_away(edited[count:], now) < 1e-6)
    between = [np.linalg.norm(now[each][:, None] - now[each], axis=2) for each in (own, partner[own])]
    assert np.abs(between[0] - between[1]).max() < 0.02 * between[0].max()


@pytest.mark.parametrize("active", [0, 1], ids=["on the basis", "on the key"])
@pytest.mark.parametrize("steps", [
    [lambda: bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0.1, 0, 0.1)})],
    [lambda: bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0.1, 0, 0.1)}),
     lambda: bpy.ops.mesh.inset(thickness=0.02)],
    [_subdivide, _shrink_fatten(0.1)],
], ids=["extruded", "inset", "subdivided"])
def test_issue_38_a_key_is_edited_on_both_sides_as_on_one(monkey, active, steps):  # noqa: F811
    mesh = monkey.data
    places = positions(mesh)
    normals = np.array([vertex.normal for vertex in mesh.vertices])
    for name in ("Basis", "fat"):
        monkey.shape_key_add(name=name)
    key = mesh.shape_keys.key_blocks["fat"]
    key.data.foreach_set("co", (places + 0.05 * normals).astype(np.float32).ravel())
    key.value, monkey.active_shape_key_index = 1, active
    ears = np.argsort(np.linalg.norm(_middles(mesh) - (0.5, -0.6, 0.4), axis=1))[:6]
    _edit(monkey, ears, *steps)
    assert ops.symmetrize_topology() == {"FINISHED"}
    fat, partner = module("mesh_data").key_positions(mesh.shape_keys.key_blocks["fat"]), attribute(mesh, "sym_vertex")
    assert np.linalg.norm(fat[partner] - fat * MIRROR, axis=1).max() < 0.01


def test_issue_38_what_is_hidden_stays_hidden(monkey):  # noqa: F811
    mesh = monkey.data
    side = attribute(mesh, "sym_side")
    for face in mesh.polygons:
        face.hide = bool((side[list(face.vertices)] < 0).any())
    mesh.vertices.foreach_set("hide", side < 0)
    enter("EDIT")
    data = bmesh.from_edit_mesh(mesh)
    for face in data.faces:
        face.select = False
    ear = sorted((face for face in data.faces if not face.hide), key=lambda face: -face.calc_center_median().x)
    for face in ear[:4]:
        face.select = True
    bmesh.update_edit_mesh(mesh)
    bpy.ops.mesh.extrude_region_shrink_fatten(TRANSFORM_OT_shrink_fatten={"value": 0.1})
    assert ops.symmetrize_topology() == {"FINISHED"}
    enter("OBJECT")
    assert len(mesh.vertices) > len(side)
    assert np.array_equal([vertex.hide for vertex in mesh.vertices], attribute(mesh, "sym_side") < 0)
    assert sum(face.hide for face in mesh.polygons) == len(mesh.polygons) // 2


def test_issue_38_no_edge_gets_four_faces_where_an_extrusion_leaves_the_line(monkey):  # noqa: F811
    """Its lower end is moved off the line, its upper end is on it."""
    mesh = monkey.data
    at_line = np.flatnonzero((np.abs(positions(mesh)[:, 0]) < 1e-5) & (positions(mesh)[:, 1] < -0.2))
    middles = _middles(mesh)
    faces = np.flatnonzero((middles[:, 0] > 0) & (middles[:, 0] < 0.3) & (middles[:, 1] < -0.2) & (middles[:, 2] > 0.2) & (middles[:, 2] < 0.6))
    edit_faces(monkey, faces)
    bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0, -0.1, 0)})
    data = bmesh.from_edit_mesh(mesh)
    made = [vertex for vertex in data.verts if vertex.select and abs(vertex.co.x) < 1e-5]
    for vertex in sorted(made, key=lambda vertex: vertex.co.z)[:-1]:
        vertex.co.x += 0.03
    bmesh.update_edit_mesh(mesh)
    enter("OBJECT")
    assert len(made) > 2 and len(at_line) > 2
    assert ops.symmetrize_topology() == {"FINISHED"}
    data = bmesh.new()
    data.from_mesh(mesh)
    assert max(len(edge.link_faces) for edge in data.edges) == 2
    data.free()


def test_issue_38_a_half_that_is_rebuilt_is_a_warning(quadruped, capfd):
    side = attribute(quadruped.data, "sym_side")
    left = [face.index for face in quadruped.data.polygons if (side[list(face.vertices)] == 1).all()]
    _edit(quadruped, left[len(left) // 2 :][:1], lambda: bpy.ops.mesh.poke())
    assert "Warning: Left to right" in (words := said(capfd, ops.symmetrize_topology))
    assert "the whole half is replaced" in words


def _states(object, names):
    """(vertices, 3 + 3 keys) places, and how far keys move them."""
    places = positions(object.data)
    keys = object.data.shape_keys.key_blocks
    return np.hstack([places, *(module("mesh_data").key_positions(keys[name]) - places for name in names)])


def _farthest(states, wanted):
    return max(np.linalg.norm(states - each, axis=1).min() for each in wanted)


@pytest.mark.parametrize("active", ["Basis", "Puff.L", "Big"])
@pytest.mark.parametrize("steps", [
    [lambda: bpy.ops.mesh.extrude_region_shrink_fatten(TRANSFORM_OT_shrink_fatten={"value": 0.05})],
    [lambda: bpy.ops.mesh.inset(thickness=0.01)],
    [bpy.ops.mesh.duplicate, _shrink_fatten(0.05)],
], ids=["extruded", "inset", "duplicated"])
def test_issue_38_an_edit_on_a_key_is_mirrored_in_every_key_and_its_twin(active, steps):
    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    enter("EDIT")
    bpy.ops.mesh.subdivide()
    enter("OBJECT")
    mesh = object.data
    places = positions(mesh)
    assert ops.detect() == {"FINISHED"}
    puff = np.exp(-30 * ((places - (0.5, -0.6, 0.4)) ** 2).sum(axis=1))[:, None] * (0.05, -0.1, 0.02)
    image = np.array([np.argmin(np.linalg.norm(places - place * MIRROR, axis=1)) for place in places])
    object.shape_key_add(name="Basis")
    for name, moved in (("Puff.L", puff), ("Puff.R", puff[image] * MIRROR), ("Big", 0.1 * places)):
        module("mesh_data").set_key_positions(object.shape_key_add(name=name), places + moved)
    object.active_shape_key_index = mesh.shape_keys.key_blocks.find(active)
    near = np.argsort(np.linalg.norm(_middles(mesh) - (0.5, -0.6, 0.4), axis=1))[:40]
    assert _middles(mesh)[near, 0].min() > 0
    _edit(object, near, *steps)
    edited = _states(object, ("Puff.L", "Puff.R", "Big"))
    assert ops.symmetrize_topology() == {"FINISHED"}
    now, mirrored = (_states(object, names) for names in (("Puff.L", "Puff.R", "Big"), ("Puff.R", "Puff.L", "Big")))
    assert len(now) > len(edited) > len(places)
    assert _farthest(now, edited[edited[:, 0] > 1e-4]) < 1e-5, "the side that wins"
    assert _farthest(now, mirrored * np.tile(MIRROR, 4)) < 1e-4


def test_issue_38_a_part_of_the_middle_that_is_duplicated_to_one_side_is_copied(monkey):  # noqa: F811
    """A button: both sides of the original are in it, but the duplicate lies on one."""
    bpy.ops.mesh.primitive_cube_add(size=0.2, location=(0, -1.2, 0.2))
    monkey.select_set(True)
    bpy.context.view_layer.objects.active = monkey
    bpy.ops.object.join()
    assert ops.detect() == {"FINISHED"}
    count = len(monkey.data.polygons)
    edited = _edit(monkey, range(count - 6, count), bpy.ops.mesh.duplicate, lambda: bpy.ops.transform.translate(value=(0.4, 0.1, 0)))
    assert ops.symmetrize_topology() == {"FINISHED"}
    now = positions(monkey.data)
    assert len(now) == len(edited) + 8 and len(monkey.data.polygons) == count + 12
    assert _away(now, now * MIRROR).max() < 1e-3 and _away(now, edited).max() < 1e-6
