# SPDX-License-Identifier: GPL-3.0-or-later
"""The map is carried through edits of vertices and faces."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import (
    attribute, edit_faces, enter, faces_around, module, new_object, positions, read_example, ring, said, select,
)

ops = bpy.ops.intrinsic_symmetry
EDITS = {
    "extrude": lambda: bpy.ops.mesh.extrude_region_shrink_fatten(TRANSFORM_OT_shrink_fatten={"value": -0.03}),
    "inset": lambda: bpy.ops.mesh.inset(thickness=0.005),
    "subdivide": lambda: bpy.ops.mesh.subdivide(number_cuts=2),
    "poke": lambda: bpy.ops.mesh.poke(),
    "delete": lambda: bpy.ops.mesh.delete(type="FACE"),
    "delete vertices": lambda: bpy.ops.mesh.delete(type="VERT"),
    "dissolve": lambda: bpy.ops.mesh.dissolve_faces(),
    "merge": lambda: bpy.ops.mesh.merge(type="COLLAPSE"),
    "triangulate": lambda: bpy.ops.mesh.quads_convert_to_tris(),
}


def _patch(mesh):
    """Faces of the raised hand's arm, left, and their mirror images."""
    outward = np.where(attribute(mesh, "sym_side") == 1, np.abs(positions(mesh)[:, 0]), 0)
    return faces_around(mesh, outward.argmax(), slice(100, 106))


def _box(cuts):
    """A box with its map, each side cut so often."""
    bpy.ops.mesh.primitive_cube_add(scale=(4, 2, 1))
    enter("EDIT")
    bpy.ops.mesh.subdivide(number_cuts=cuts)
    enter("OBJECT")
    assert ops.detect() == {"FINISHED"}
    return bpy.context.object


def _edit(object, faces, name):
    edit_faces(object, faces)
    EDITS[name]()


def _assert_valid(object, lost=()):
    """The map fits, and exchanges the sides; returns it, and the vertices that have faces and images. By some edits,
    `lost`, the right side loses images."""
    enter("OBJECT")
    symmetry = module("stored_map").load(object.data)
    used = np.unique([vertex for face in object.data.polygons for vertex in face.vertices])
    has = symmetry.partner[used] >= 0
    assert has.all() != bool(lost) and (symmetry.side[used[~has]] == -1).all() and np.count_nonzero(~has) < 20
    used = used[has]
    assert not (symmetry.side[symmetry.partner] * symmetry.side > 0)[used].any()
    return symmetry, used


@pytest.mark.parametrize("name", EDITS)
def test_an_edit_of_one_side(human, name):
    before, old = attribute(human.data, "sym_vertex"), positions(human.data)
    _edit(human, _patch(human.data)[0], name)
    assert ops.carry() == {"FINISHED"}
    (symmetry, used), places = _assert_valid(human, name == "delete vertices"), positions(human.data)
    images = symmetry.surface_points.positions(places)
    number = {tuple(np.round(place, 5)): vertex for vertex, place in enumerate(old)}
    kept = [(new, number.get(tuple(np.round(places[new], 5)))) for new in used]
    kept = [(new, vertex) for new, vertex in kept if vertex is not None]
    far = [np.linalg.norm(images[new] - old[before[vertex]]) for new, vertex in kept]
    assert len(kept) > 13300 and np.quantile(far, 0.995) < 1e-6 and max(far) < 0.05
    lowered = "extrude", "inset", "poke", "subdivide", "delete vertices", "merge"
    assert (symmetry.confidence.min() < 0.6) == (name in lowered)
    assert (symmetry.confidence > 0.9).mean() > 0.99


@pytest.mark.parametrize("name", EDITS)
def test_the_same_edit_of_both_sides_pairs_new_vertices(human, name):
    near, far = _patch(human.data)
    _edit(human, near + far, name)
    assert ops.carry() == {"FINISHED"}
    symmetry, used = _assert_valid(human)
    assert np.array_equal(symmetry.partner[symmetry.partner[used]], used)
    assert symmetry.surface_points.barycentrics.max(axis=1)[used].min() > 0.99
    assert symmetry.confidence[used].min() > 0.99


def test_edges_that_are_split_on_both_sides_keep_their_images_in_place():
    box = _box(3)
    old, partner = positions(box.data), attribute(box.data, "sym_vertex")
    edit_faces(box, np.flatnonzero([abs(face.center.x) > 0.3 for face in box.data.polygons]))
    bpy.ops.mesh.edge_split()
    assert ops.carry() == {"FINISHED"}
    enter("OBJECT")
    places = positions(box.data)
    assert len(places) > 2 * len(old)
    vertex = np.array([np.linalg.norm(old - place, axis=1).argmin() for place in places])
    np.testing.assert_allclose(places[attribute(box.data, "sym_vertex")], old[partner[vertex]], atol=1e-5)


def test_a_bevel_of_both_ends_in_a_pose_pairs_new_vertices(tmp_path):
    """All of both ends is new, and they are bent apart: nothing near says where images are."""
    box = _box(7)
    places, pairs = positions(box.data), str(tmp_path / "pairs.csv")
    assert ops.export_pairs(filepath=pairs) == {"FINISHED"}
    bent = np.where(places[:, 0] > 0, 0.8, -0.3) * np.maximum(np.abs(places[:, 0]) - 0.4, 0)
    box.data.vertices.foreach_set("co", (places + bent[:, None] * [0, 0, 1]).ravel())
    assert ops.import_pairs(filepath=pairs) == {"FINISHED"}
    edit_faces(box, np.flatnonzero([abs(face.center.x) > 3.9 for face in box.data.polygons]))
    bpy.ops.mesh.bevel(offset=0.02, segments=1)
    assert ops.carry() == {"FINISHED"}
    symmetry, used = _assert_valid(box)
    assert np.array_equal(symmetry.partner[symmetry.partner[used]], used)
    assert symmetry.confidence[used].min() > 0.99


def test_weights_that_blender_has_mixed_sum_to_one(human):
    """A bevel mixes vertices of an extrusion with themselves, and rounds."""
    edit_faces(human, _patch(human.data)[0])
    bpy.ops.mesh.extrude_faces_move(TRANSFORM_OT_shrink_fatten={"value": 0.01})
    bpy.ops.mesh.bevel(offset=0.001, affect="EDGES")
    enter("OBJECT")
    assert ops.carry() == {"FINISHED"}
    weights = attribute(human.data, "sym_bary").astype(float)
    assert weights.min() >= 0 and np.abs(weights.sum(axis=1) - 1).max() < 1e-6


def test_a_loop_cut_through_the_line(human):
    """Round the trunk: the new ring is paired with itself."""
    mesh, side = human.data, attribute(human.data, "sym_side")
    symmetry = module("stored_map").load(mesh)
    assert symmetry.side.tolist() == side.tolist()
    enter("EDIT")
    data = bmesh.from_edit_mesh(mesh)
    edge = next(edge for edge in data.edges if all(side[vertex.index] == 0 for vertex in edge.verts))
    bmesh.ops.subdivide_edges(data, edges=ring(edge), cuts=1, use_grid_fill=True)
    bmesh.update_edit_mesh(mesh)
    assert ops.select_line() == {"FINISHED"}
    symmetry, _ = _assert_valid(human)
    assert len(symmetry.partner) > 13380 + 4
    assert np.array_equal(symmetry.partner[symmetry.partner], np.arange(len(symmetry.partner)))


def test_the_whole_mesh_subdivided(quadruped):
    enter("EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    assert ops.carry() == {"FINISHED"}
    enter("OBJECT")
    symmetry = module("stored_map").load(quadruped.data)
    assert len(symmetry.partner) == 3398 + 10188 and symmetry.partner.min() >= 0
    fresh = new_object(quadruped.data.copy())
    ops.clear()
    ops.detect()
    found, places = module("stored_map").load(fresh.data), positions(fresh.data)
    off = np.linalg.norm(symmetry.surface_points.positions(places) - found.surface_points.positions(places), axis=1)
    assert np.quantile(off, 0.9) < 0.05 * np.ptp(places, axis=0).max()


def test_a_mirrored_mesh_subdivided_stays_mirrored():
    bpy.ops.mesh.primitive_monkey_add()
    assert ops.detect() == {"FINISHED"}
    enter("EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    assert ops.carry() == {"FINISHED"}
    symmetry, used = _assert_valid(bpy.context.object)
    assert np.array_equal(symmetry.partner[symmetry.partner], used) and len(used) > 1900
    places = positions(bpy.context.object.data)
    assert np.abs(places[symmetry.partner] * (-1, 1, 1) - places).max() < 1e-5


def test_every_tool_carries_it_and_says_so(human, capfd):
    _edit(human, _patch(human.data)[0], "subdivide")
    words = said(capfd, ops.select)
    assert "carried through an edit: " in words and "vertices are new" in words
    assert "carried" not in said(capfd, ops.select)


def test_tools_are_offered_after_an_edit(human):
    _edit(human, _patch(human.data)[0], "subdivide")
    enter("OBJECT")
    assert ops.symmetrize.poll() and ops.carry.poll()
    human.data.attributes.remove(human.data.attributes["sym_mixed"])
    assert not ops.symmetrize.poll()


def test_vertices_that_a_modifier_welds_are_new(human):
    """The Weld modifier gives a vertex the mean of the numbers of those that it was made of, which may be another vertex' number."""
    stored_map, before = module("stored_map"), positions(human.data)
    modifier = human.modifiers.new("Weld", "WELD")
    modifier.merge_threshold = 0.01 * float(np.ptp(before[:, 2]))
    bpy.ops.object.modifier_apply(modifier=modifier.name)
    mesh = human.data
    own, mixed = (attribute(mesh, name) for name in stored_map.NUMBERS)
    old = np.abs(mixed - stored_map.scattered(own)) <= 1e-5
    away = np.linalg.norm(positions(mesh)[old] - before[own[old] - 1], axis=1)
    assert not old.all() and away.max() < 1e-6


def test_too_much_changed(human, mode):
    side = attribute(human.data, "sym_side")
    select(human, np.flatnonzero(side >= 0))
    enter("EDIT")
    bpy.ops.mesh.delete(type="VERT")
    enter(mode)
    with pytest.raises(RuntimeError, match="Detect again"):
        ops.select_line()


def test_vertices_of_another_mesh_get_no_image(human):
    """Not even those that have numbers of vertices that are gone."""
    before = attribute(human.data, "sym_vertex")
    select(human, np.arange(100))
    enter("EDIT")
    bpy.ops.mesh.delete(type="VERT")
    enter("OBJECT")
    used = np.zeros(13380, bool)
    used[100 + np.unique([vertex for face in human.data.polygons for vertex in face.vertices])] = True
    new_object(read_example("quadruped"))
    assert ops.detect() == {"FINISHED"}
    human.select_set(True)
    bpy.context.view_layer.objects.active = human
    bpy.ops.object.join()
    assert ops.carry() == {"FINISHED"}
    partner = attribute(human.data, "sym_vertex")
    assert (partner[-3398:] < 0).all() and (partner[:-3398] >= 0)[(used & used[before])[100:]].all()


def _hand(mesh):
    """(vertices,) bool: the raised hand, left."""
    places, outward = positions(mesh), np.where(attribute(mesh, "sym_side") == 1, np.abs(positions(mesh)[:, 0]), 0)
    return np.linalg.norm(places - places[outward.argmax()], axis=1) < 0.25 * np.ptp(places[:, 2]) * (outward > 0)


def _without_hand(object):
    """Deletes it, after the body was bent; returns, of the vertices that are left, those whose images were there."""
    hand, partner, places = _hand(object.data), attribute(object.data, "sym_vertex"), positions(object.data)
    module("mesh_data").set_shown_positions(object, 2 * places + np.sin(3 * places[:, [1, 2, 0]]))
    select(object, np.flatnonzero(hand))
    enter("EDIT")
    bpy.ops.mesh.delete(type="VERT")
    enter("OBJECT")
    return hand[partner][~hand]


TOOLS = {
    "exactly": lambda: ops.symmetrize_exactly(direction="LEFT_TO_RIGHT"),
    "average": lambda: ops.symmetrize_exactly(direction="AVERAGE"),
    "positions": lambda: ops.symmetrize(direction="LEFT_TO_RIGHT"),
    "weights": lambda: ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT"),
    "exchange": lambda: ops.mirror_vertex_groups(direction="SWAP"),
}


@pytest.mark.parametrize("tool", TOOLS)
def test_what_is_deleted_has_no_mirror_image_and_tools_spare_it(human, tool, capfd):
    for name, side in (("A.L", 1), ("A.R", -1)):
        there = np.flatnonzero(attribute(human.data, "sym_side") == side)
        human.vertex_groups.new(name=name).add(there[::2].tolist(), 0.5, "ADD")
    lost = _without_hand(human)
    places, weights = positions(human.data), module("weights").read_weights(human)
    words = said(capfd, TOOLS[tool])
    gone = attribute(human.data, "sym_vertex") < 0
    count = np.count_nonzero(gone)
    assert f"{count:,} have lost their mirror image" in words
    assert not (gone & ~lost).any() and count > 1800 and np.count_nonzero(lost & ~gone) < 5, "those near the border"
    lost &= gone
    assert (attribute(human.data, "sym_side")[lost] == -1).all()
    assert np.array_equal(positions(human.data)[lost], places[lost])
    assert np.array_equal(module("weights").read_weights(human)[lost], weights[lost])
    assert f"{count:,} of 11,481 vertices have no mirror image" in said(capfd, ops.select_unmatched)


def test_vertices_that_no_face_uses_any_more_are_counted(capfd):
    box = _box(7)
    edit_faces(box, np.flatnonzero([abs(face.center.x) > 3.9 for face in box.data.polygons]))
    bpy.ops.mesh.delete(type="ONLY_FACE")
    words = said(capfd, ops.carry)
    enter("OBJECT")
    count = np.count_nonzero(attribute(box.data, "sym_vertex") < 0)
    assert count == 98 and f"{count} have lost their mirror image" in words


def test_another_edit_gives_no_image_back(human):
    lost = _without_hand(human)
    ops.carry()
    lost &= attribute(human.data, "sym_vertex") < 0
    tip = np.where(lost, positions(human.data)[:, 0], np.inf).argmin()
    chosen = [face.index for face in human.data.polygons if tip in face.vertices]
    edit_faces(human, chosen)
    bpy.ops.mesh.subdivide()
    ops.carry()
    enter("OBJECT")
    partner, side = attribute(human.data, "sym_vertex"), attribute(human.data, "sym_side")
    new = len(partner) - len(lost)
    assert new > 0 and np.count_nonzero(partner < 0) == np.count_nonzero(lost) + new
    assert (side[partner < 0] == -1).all()


def test_what_is_dissolved_keeps_its_images():
    """However many faces become one: the surface is still there."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20)
    grid = bpy.context.object
    assert ops.detect() == {"FINISHED"}
    before, partner, side = positions(grid.data), attribute(grid.data, "sym_vertex"), attribute(grid.data, "sym_side")
    images = {tuple(np.round(place, 5)): before[other] for place, other in zip(before, partner)}
    inner = (side == 1) & (np.abs(before - before[side == 1].mean(axis=0)).max(axis=1) < 0.35)
    edit_faces(grid, [face.index for face in grid.data.polygons if inner[list(face.vertices)].all()])
    bpy.ops.mesh.dissolve_faces()
    ops.carry()
    enter("OBJECT")
    symmetry, places = module("stored_map").load(grid.data), positions(grid.data)
    found = symmetry.surface_points.positions(places)
    off = [np.linalg.norm(there - images[tuple(np.round(place, 5))]) for place, there in zip(places, found)]
    assert len(before) - len(places) > 15 and (symmetry.partner >= 0).all() and max(off) < 1e-4


def test_after_saving_and_undo(human, tmp_path):
    name = human.name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "saved.blend"))
    object = bpy.data.objects[name]
    bpy.context.view_layer.objects.active = object
    _edit(object, _patch(object.data)[0], "subdivide")
    bpy.ops.ed.undo_push(message="edited")
    ops.carry("EXEC_DEFAULT", True)
    bpy.ops.ed.undo()
    bpy.context.tool_settings.mesh_select_mode = (True, False, False)
    assert ops.select_line() == {"FINISHED"}
    assert len(_assert_valid(bpy.context.object)[1]) > 13380
