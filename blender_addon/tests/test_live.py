# SPDX-License-Identifier: GPL-3.0-or-later
"""Live mirror: what is moved, sculpted or painted on one side happens on the other."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, positions, select, touching_shells
from intrinsym import Merge

ops = bpy.ops


def switch(object, on=True, name="intrinsic_symmetry_live"):
    setattr(object, name, on)
    assert getattr(object, name) is on


def side_of(mesh):
    return attribute(mesh, module("stored_map").SIDE)


def places(object):
    """(vertices, 3) float32, in any mode."""
    if object.data.is_editmode:
        return np.array([vertex.co[:] for vertex in bmesh.from_edit_mesh(object.data).verts], np.float32)
    return positions(object.data).astype(np.float32)


def a_hand(object, side, count=120):
    """The vertices of a side that are nearest to its point farthest outside."""
    mesh = object.data
    points, sides = positions(mesh), side_of(mesh)
    tip = np.argmax(np.where(sides == side, np.abs(points[:, 0]), -np.inf))
    distance = np.linalg.norm(points - points[tip], axis=1)
    return np.argsort(np.where(sides == side, distance, np.inf))[:count]


def carried(object, symmetry, before, after, side):
    """What the library makes of an edit of one side."""
    merge = Merge.POSITIVE_WINS if side == 1 else Merge.NEGATIVE_WINS
    displaced = symmetry.carry_displacement(before, after.astype(float) - before, merge)
    return (before + displaced).astype(np.float32)


@pytest.fixture(params=["human", "quadruped"])
def body(request):
    return request.getfixturevalue(request.param)


@pytest.fixture
def live(body):
    """In edit mode, with Live Mirror on and a hand selected."""
    select(body, a_hand(body, 1))
    enter("EDIT")
    switch(body)
    bpy.ops.ed.undo_push(message="before")
    return body


@pytest.fixture
def symmetry(body):
    return module("stored_map").load(body.data)


@pytest.mark.parametrize("call", [
    lambda: ops.transform.translate(value=(0.01, 0.02, 0.03)),
    lambda: ops.transform.resize(value=(1.2, 0.9, 1)),
    lambda: ops.transform.rotate(value=0.3),
    lambda: ops.transform.shrink_fatten(value=0.01),
    lambda: ops.mesh.vertices_smooth(factor=0.5),
    lambda: ops.transform.translate(
        value=(0, 0.02, 0.03), use_proportional_edit=True, proportional_size=0.1, use_proportional_connected=True
    ),
], ids=["move", "scale", "rotate", "shrink", "smooth", "proportional"])
def test_an_edit_is_carried_as_the_library_does(symmetry, live, call):
    before = places(live)
    assert call() == {"FINISHED"}
    after, sides = places(live), module("live")._sessions[live.session_uid].carrier.side
    wanted = carried(live, symmetry, before, after, 1)
    moved = np.any(after != before, axis=1)
    assert moved[sides == -1].sum() > 50
    assert np.array_equal(after[sides == -1], wanted[sides == -1])



def drag(object, vertices, places):
    """One step of an operation that the user is in the middle of."""
    mesh = bmesh.from_edit_mesh(object.data)
    mesh.verts.ensure_lookup_table()
    for vertex, place in zip(vertices.tolist(), places.tolist()):
        mesh.verts[vertex].co = place
    bmesh.update_edit_mesh(object.data, destructive=False)
    bpy.context.view_layer.update()


def test_an_operation_that_takes_more_and_fewer_vertices_and_is_cancelled(symmetry, live, monkeypatch):
    """As proportional editing does when its circle is made larger and smaller."""
    monkeypatch.setattr(module("live_edit").EditChannel, "operation", staticmethod(lambda: 1))
    before = places(live)
    sides = module("live")._sessions[live.session_uid].carrier.side
    around = a_hand_of(live)
    for count, by in ((40, 0.01), (120, 0.02), (120, 0.03), (60, 0.02)):
        wanted = before.copy()
        wanted[around[:count], 1] += np.float32(by)
        drag(live, around, wanted[around])
        assert np.array_equal(places(live)[sides == -1], carried(live, symmetry, before, wanted, 1)[sides == -1])
    drag(live, around, before[around])
    assert np.array_equal(places(live), before)


@pytest.mark.parametrize("when", ["between two updates", "at the end"])
def test_normals_of_many_vertices_lag_and_catch_up(human, monkeypatch, when):
    select(human, np.flatnonzero(side_of(human.data) == 1))
    enter("EDIT")
    switch(human)
    session, channel = module("live")._sessions[human.session_uid], module("live_edit").EditChannel
    monkeypatch.setattr(channel, "operation", staticmethod(lambda: 1))
    before, chosen = places(human), a_hand_of(human)
    drag(human, chosen, before[chosen] * (1, 1, 0.5))
    if when == "at the end":
        monkeypatch.setattr(channel, "operation", staticmethod(lambda: None))
        session.update()
    else:
        session.edit.catch_up()
    mesh = bmesh.from_edit_mesh(human.data)
    found = np.array([vertex.normal[:] for vertex in mesh.verts])
    mesh.normal_update()
    assert np.abs(found - [vertex.normal[:] for vertex in mesh.verts]).max() < 1e-6


def test_undo_and_redo_take_both_sides_in_one_step(live):
    """The undo step of an operator is kept before the other side follows; it is completed when it comes back."""
    states = [places(live)]
    for value in ((0, 0.02, 0), (0, 0, 0.03)):
        ops.transform.translate("EXEC_DEFAULT", True, value=value)
        states.append(places(live))
    assert np.any(states[0] != states[1], axis=1).sum() > 200
    for state in (states[1], states[0]):
        ops.ed.undo()
        assert np.array_equal(places(live), state)
    for state in states[1:]:
        ops.ed.redo()
        assert np.array_equal(places(live), state)
    ops.ed.undo()
    ops.transform.translate("EXEC_DEFAULT", True, value=(0.03, 0, 0))
    state = places(live)
    ops.mesh.select_all("EXEC_DEFAULT", True, action="DESELECT")
    ops.ed.undo()
    ops.ed.undo()
    assert np.array_equal(places(live), states[1])
    ops.ed.redo()
    assert np.array_equal(places(live), state)


def test_undo_after_the_object_was_in_object_mode(live):
    ops.transform.translate("EXEC_DEFAULT", True, value=(0, 0.02, 0))
    state = places(live)
    ops.object.mode_set("EXEC_DEFAULT", True, mode="OBJECT")
    ops.object.mode_set("EXEC_DEFAULT", True, mode="EDIT")
    ops.transform.translate("EXEC_DEFAULT", True, value=(0, 0.02, 0))
    for _ in range(3):
        ops.ed.undo()
    assert bpy.context.object.mode == "EDIT" and np.array_equal(places(bpy.context.object), state)


def test_what_is_selected_on_both_sides_stays_as_the_user_has_it(human, truth):
    left = a_hand(human, 1)
    select(human, np.r_[left, truth[left[:40]]])
    enter("EDIT")
    switch(human)
    before = places(human)
    ops.transform.translate(value=(0, 0.02, 0))
    moved = places(human) - before
    assert np.allclose(moved[truth[left[:40]]], (0, 0.02, 0), atol=1e-6)
    assert np.allclose(moved[left], (0, 0.02, 0), atol=1e-6)
    assert (np.abs(moved[truth[left[40:]]]).max(axis=1) > 0.01).all()


def test_hidden_vertices_do_not_move(live, truth):
    if live.name.startswith("quadruped"):
        pytest.skip("its connectivity has no counterparts")
    mesh, hidden = bmesh.from_edit_mesh(live.data), truth[a_hand_of(live)[:30]]
    vertices = list(mesh.verts)
    for vertex in hidden.tolist():
        vertices[vertex].hide_set(True)
    before = places(live)
    ops.transform.translate(value=(0, 0.02, 0))
    moved = np.abs(places(live) - before).max(axis=1)
    assert not moved[hidden].any() and moved[truth[a_hand_of(live)[30:]]].all()


def a_hand_of(object):
    """The selected vertices, in edit mode."""
    return np.flatnonzero([vertex.select for vertex in bmesh.from_edit_mesh(object.data).verts])


def test_the_line_stays_on_the_line(human, truth):
    """A vertex of the line does not move across it: the direction between its neighbours on both sides."""
    line = np.flatnonzero((side_of(human.data) == 0) & (attribute(human.data, module("stored_map").PARTNER) >= 0))
    top = line[np.argsort(-positions(human.data)[line, 2])[:10]]
    select(human, top)
    ends = module("mesh_data").edges(human.data)
    enter("EDIT")
    switch(human)
    before = places(human).astype(float)
    ops.transform.translate(value=(0.03, 0.03, 0.02))
    moved = places(human) - before
    for vertex in top:
        around = np.unique(ends[(ends == vertex).any(axis=1)])
        across = before[around] - before[truth[around]]
        across = max(across, key=np.linalg.norm)
        assert 0.01 < np.linalg.norm(moved[vertex]) < 0.046
        assert abs(moved[vertex] @ across) < 0.03 * np.linalg.norm(moved[vertex]) * np.linalg.norm(across)


@pytest.mark.parametrize("mode", ["EDIT", "SCULPT"])
@pytest.mark.parametrize("apart", [0, 3e-7])
def test_shells_that_touch_do_so_afterwards(truth, apart, mode):
    """Each has local frames of its own. Rounding may keep them apart. What is torn apart on one side is so on the other."""
    object, ((left, its), (right, other)) = touching_shells(truth, apart)
    assert ops.intrinsic_symmetry.detect() == {"FINISHED"}
    before, ball = places(object), np.arange(len(object.data.vertices)) >= its
    near = np.linalg.norm(before - before[left], axis=1) < 0.2
    for moved, together in ((near, True), (near & ball, False)):
        enter("OBJECT")
        select(object, np.flatnonzero(moved))
        enter(mode)
        switch(object)
        start = places(object)
        if mode == "EDIT":
            ops.transform.translate(value=(0.1, 0.05, 0))
        else:
            module("mesh_data").set_shown_positions(object, start + moved[:, None] * np.float32((0.1, 0.05, 0)))
            stroke()
        after = places(object)
        assert np.linalg.norm(after[other] - start[other]) > 0.05
        gap = np.linalg.norm(after[right] - after[other])
        assert gap < 1e-6 if together else gap > 0.05


def _of_two_halves(human):
    """The human with its left and right half not welded; with its symmetry. The line of each, (vertices,) bool."""
    side, data = side_of(human.data), bmesh.new()
    data.from_mesh(human.data)
    data.verts.ensure_lookup_table()
    data.edges.ensure_lookup_table()
    line = [edge for edge in data.edges if not any(side[vertex.index] for vertex in edge.verts)]
    bmesh.ops.split_edges(data, edges=line)
    data.to_mesh(human.data)
    data.free()
    assert ops.intrinsic_symmetry.detect() == {"FINISHED"}
    sides, ends = side_of(human.data), module("mesh_data").edges(human.data)
    near = [np.zeros(len(sides), bool) for _ in range(2)]
    for number, at in enumerate((1, -1)):
        near[number][ends[(sides[ends] == at).any(axis=1)]] = True
    return [each & (sides == 0) for each in near]


@pytest.mark.parametrize("mode", ["EDIT", "SCULPT"])
def test_halves_that_are_not_welded_stay_together(human, mode):
    left, right = _of_two_halves(human)
    partner, before = attribute(human.data, "sym_vertex"), places(human)
    rows = np.flatnonzero(left)
    assert len(rows) > 50 and right[partner[rows]].all() and np.array_equal(before[partner[rows]], before[rows])
    for chosen in (left, left | right, left | (side_of(human.data) == 1)):
        enter("OBJECT")
        select(human, np.flatnonzero(chosen))
        enter(mode)
        switch(human)
        before = places(human)
        if mode == "EDIT":
            ops.transform.translate(value=(0.05, 0.03, 0.02))
        else:
            module("mesh_data").set_shown_positions(human, before + chosen[:, None] * np.float32((0.05, 0.03, 0.02)))
            stroke()
        after = places(human)
        assert (np.linalg.norm(after[rows] - before[rows], axis=1) > 0.01).all()
        assert np.abs(after[partner[rows]] - after[rows]).max() < 1e-6


@pytest.mark.parametrize("call", [
    lambda: ops.transform.translate(value=(0.1, 0.2, 0.3)), lambda: ops.transform.rotate(value=1, orient_axis="Z")
], ids=["move", "rotate"])
def test_what_is_selected_as_a_whole_moves_as_a_whole(body, call):
    """The line, too."""
    select(body, np.arange(len(body.data.vertices)))
    ends = module("mesh_data").edges(body.data)
    enter("EDIT")
    switch(body)
    before = places(body)
    assert call() == {"FINISHED"}
    after = places(body)
    assert (np.linalg.norm(after - before, axis=1) > 0.001).all()
    lengths = [np.linalg.norm(each[ends[:, 0]] - each[ends[:, 1]], axis=1) for each in (before, after)]
    assert np.abs(lengths[1] - lengths[0]).max() < 1e-6


@pytest.mark.parametrize("call", [
    lambda: ops.mesh.subdivide(),
    lambda: ops.mesh.delete(type="VERT"),
    lambda: ops.mesh.flip_normals(),
    lambda: ops.mesh.sort_elements(type="REVERSE", elements={"VERT"}),
], ids=["subdivide", "delete", "flip", "sort"])
def test_a_topology_edit_switches_it_off_with_a_word(live, call):
    switch(live, name="intrinsic_symmetry_live_select")
    assert call() == {"FINISHED"}
    assert not live.intrinsic_symmetry_live and not live.intrinsic_symmetry_live_select
    assert "Update Symmetry" in module("live").problem_of(live)
    before = places(live)
    ops.transform.translate(value=(0, 0.02, 0))
    assert not np.any(places(live) != before, axis=1)[~np.isin(np.arange(len(before)), a_hand_of(live))].any()


def test_extruding_switches_it_off_before_the_new_vertices_move(live, monkeypatch):
    """As a user extrudes: a transformation is running when the graph is updated."""
    monkeypatch.setattr(module("live_edit").EditChannel, "operation", staticmethod(lambda: 1))
    before = places(live)
    ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0, 0.02, 0)})
    assert not live.intrinsic_symmetry_live
    after = places(live)
    elsewhere = set(map(tuple, after.tolist())) - set(map(tuple, before.tolist()))
    assert elsewhere == set(map(tuple, after[a_hand_of(live)].tolist()))


def test_without_a_map_it_does_not_go_on(human):
    ops.intrinsic_symmetry.clear()
    for name in ("intrinsic_symmetry_live", "intrinsic_symmetry_live_select"):
        setattr(human, name, True)
        assert not getattr(human, name)
    assert "Detect" in module("live").problem_of(human)


def test_what_happened_while_it_was_off_is_not_carried(live):
    switch(live, False)
    ops.transform.translate("EXEC_DEFAULT", True, value=(0, 0.02, 0))
    before = places(live)
    switch(live)
    assert np.array_equal(places(live), before)
    ops.transform.translate("EXEC_DEFAULT", True, value=(0, 0.01, 0))
    moved = np.any(places(live) != before, axis=1)
    assert moved.sum() > 200
    ops.ed.undo()
    assert np.array_equal(places(live), before)


def test_other_modes_do_not_confuse_it(live):
    """What an operator did in object mode is not carried, and Live goes on after it."""
    before = places(live)
    enter("OBJECT")
    points = positions(live.data)
    points[:5] += 0.01
    module("mesh_data").set_shown_positions(live, points)
    enter("EDIT")
    assert np.any(places(live) != before, axis=1).sum() == 5
    before = places(live)
    ops.transform.translate(value=(0, 0.02, 0))
    assert np.any(places(live) != before, axis=1).sum() > 200


def test_it_works_on_the_active_shape_key(human):
    human.shape_key_add(name="Basis")
    human.shape_key_add(name="Key")
    human.active_shape_key_index = 1
    select(human, a_hand(human, 1))
    enter("EDIT")
    switch(human)
    base = positions(human.data)
    ops.transform.translate(value=(0, 0.02, 0))
    enter("OBJECT")
    moved = np.any(module("mesh_data").key_positions(human.data.shape_keys.key_blocks["Key"]) != base, axis=1)
    assert moved.sum() > 200 and np.array_equal(positions(human.data), base)


def test_live_selection_lights_up_the_other_side(human, truth):
    left = a_hand(human, 1, 30)
    select(human, [])
    enter("EDIT")
    switch(human, name="intrinsic_symmetry_live_select")
    choose(human, left)
    assert set(a_hand_of(human)) == set(left) | set(truth[left])
    choose(human, left[:10], False)  # taken out on one side: so is its mirror image
    assert set(a_hand_of(human)) == set(left[10:]) | set(truth[left[10:]])
    ops.mesh.select_all(action="DESELECT")
    assert not len(a_hand_of(human))


@pytest.mark.parametrize("later", [False, True])
def test_what_lights_up_is_still_carried_to(human, truth, later):
    """Also where Live Mirror is switched on later."""
    left = a_hand(human, 1, 30)
    select(human, [])
    enter("EDIT")
    switch(human, name="intrinsic_symmetry_live_select")
    if not later:
        switch(human)
    choose(human, left)
    if later:
        switch(human)
    carrier = module("live")._sessions[human.session_uid].carrier
    before = places(human)
    ops.transform.translate(value=(0, 0.02, 0.01))
    after = places(human)
    moved = (after - before).astype(float)
    turned = (carrier.turn[truth[left]] @ moved[left][:, :, None])[:, :, 0]
    assert np.allclose(moved[left], (0, 0.02, 0.01), atol=1e-6)
    assert np.abs(moved[truth[left]] - turned).max() < 1e-6


def choose(object, vertices, on=True):
    mesh = bmesh.from_edit_mesh(object.data)
    chosen = list(mesh.verts)
    for vertex in np.asarray(vertices).tolist():
        chosen[vertex].select_set(on)
    mesh.select_flush_mode()
    bmesh.update_edit_mesh(object.data, loop_triangles=False, destructive=False)
    bpy.context.view_layer.update()


def paint(object, mode):
    """In a mode, with Live Mirror on. Without a window there are no strokes: their results are written."""
    enter(mode)
    switch(object)


def stroke():
    bpy.context.object.data.update()
    bpy.context.view_layer.update()


def test_a_sculpted_side_is_carried(symmetry, body):
    mesh, hand = body.data, a_hand(body, -1)
    before, sides = places(body), side_of(mesh)
    paint(body, "SCULPT")
    after = before.copy()
    after[hand] += np.float32((0.01, 0.02, 0))
    module("mesh_data").set_shown_positions(body, after)
    stroke()
    wanted = carried(body, symmetry, before, after, -1)
    assert np.array_equal(places(body)[sides == 1], wanted[sides == 1])
    assert np.array_equal(places(body)[sides == -1], after[sides == -1])


def test_what_is_masked_or_hidden_is_left_alone(human, truth):
    mesh, hand = human.data, a_hand(human, 1)
    before, mask = places(human), np.zeros(len(mesh.vertices), np.float32)
    mask[truth[hand[:40]]], mask[truth[hand[40:80]]] = 1, 0.5
    module("mesh_data").write_attribute(mesh, ".sculpt_mask", "FLOAT", mask)
    hidden = np.zeros(len(mesh.vertices), bool)
    hidden[truth[hand[80:100]]] = True
    mesh.vertices.foreach_set("hide", hidden)
    paint(human, "SCULPT")
    after = before.copy()
    after[hand] += np.float32((0, 0.02, 0))
    module("mesh_data").set_shown_positions(human, after)
    stroke()
    moved = np.linalg.norm(places(human) - before, axis=1)[truth[hand]]
    assert not moved[:40].any() and not moved[80:100].any()
    assert np.allclose(moved[40:80], 0.01, atol=1e-4) and np.allclose(moved[100:], 0.02, atol=1e-4)


def test_a_stroke_over_the_line_goes_by_its_larger_side(human, truth):
    before, sides = places(human), side_of(human.data)
    middle = np.argmin(np.abs(before[:, 0]) + 10 * (sides != 1))
    distance = np.linalg.norm(before - before[middle], axis=1)
    size = np.clip(0.1 - distance, 0, None)[:, None].astype(np.float32)
    paint(human, "SCULPT")
    module("mesh_data").set_shown_positions(human, before + size * np.float32((0, 1, 0)))
    stroke()
    far = np.linalg.norm(places(human) - before, axis=1)
    left = (sides == 1) & (size[:, 0] > 0)
    assert np.allclose(far[left], size[left, 0], atol=1e-4) and np.allclose(far[truth[left]], far[left], atol=1e-4)


@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
@pytest.mark.parametrize("kind", ["BYTE_COLOR", "FLOAT_COLOR"])
def test_painted_colours_are_carried(human, truth, kind, domain):
    mesh, hand = human.data, a_hand(human, 1)
    mesh.color_attributes.new("Paint", kind, domain)
    mesh.color_attributes.active_color = mesh.color_attributes["Paint"]
    paint(human, "VERTEX_PAINT")
    painted, (_, corners) = mesh.attributes["Paint"], module("mesh_data").polygons(mesh)
    rows = hand if domain == "POINT" else np.isin(corners, hand)
    values = module("mesh_data").read_attribute(painted)
    start = values.copy()
    values[rows] = (1, 0.5, 0.25, 1)
    module("mesh_data").update_attribute(painted, values)
    stroke()
    found = module("mesh_data").read_attribute(painted)
    image = truth[hand] if domain == "POINT" else np.isin(corners, truth[hand])
    assert np.abs(found[image] - (1, 0.5, 0.25, 1)).max() < 0.01
    rest = np.ones(len(found), bool)
    rest[rows] = rest[image] = False
    assert np.array_equal(found[rest], start[rest])


@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
def test_what_is_painted_on_one_side_is_the_colour_on_the_other(human, truth, domain):
    """Whatever that side had before."""
    mesh, hand = human.data, a_hand(human, 1)
    (_, corners), sides = module("mesh_data").polygons(mesh), side_of(mesh)
    mesh.color_attributes.new("Paint", "FLOAT_COLOR", domain)
    mesh.color_attributes.active_color = painted = mesh.color_attributes["Paint"]
    rows, image = (each if domain == "POINT" else np.isin(corners, each) for each in (hand, truth[hand]))
    values = np.zeros((len(painted.data), 4), np.float32)
    values[(sides if domain == "POINT" else sides[corners]) == -1] = (1, 1, 1, 1)
    module("mesh_data").update_attribute(painted, values)
    paint(human, "VERTEX_PAINT")
    values[rows] = (1, 0, 0, 1)
    module("mesh_data").update_attribute(mesh.attributes["Paint"], values)
    stroke()
    values[image] = (1, 0, 0, 1)
    assert np.array_equal(attribute(mesh, "Paint"), values)


def test_of_face_corners_those_of_the_mirrored_face_alone_follow(human, truth):
    mesh = human.data
    mesh.color_attributes.new("Paint", "BYTE_COLOR", "CORNER")
    mesh.color_attributes.active_color = mesh.color_attributes["Paint"]
    face = max(mesh.polygons, key=lambda face: face.center.x)
    numbers = {frozenset(other.vertices): other for other in mesh.polygons}
    image = numbers[frozenset(truth[list(face.vertices)].tolist())]
    own, there = list(face.loop_indices), list(image.loop_indices)
    module("mesh_data").update_attribute(mesh.attributes["Paint"], np.tile((0.0, 0, 0, 1), (len(mesh.loops), 1)))
    paint(human, "VERTEX_PAINT")
    values = attribute(mesh, "Paint")
    values[own] = (1, 0, 0, 1)
    module("mesh_data").update_attribute(mesh.attributes["Paint"], values)
    stroke()
    values[there] = (1, 0, 0, 1)
    assert np.array_equal(attribute(mesh, "Paint"), values)


def test_corners_of_other_faces_follow_where_the_map_has_them(quadruped):
    """Left and right share no faces: what is painted at the images of a face's corners is painted in it."""
    mesh, sides = quadruped.data, side_of(quadruped.data)
    mesh.color_attributes.new("Paint", "FLOAT_COLOR", "CORNER")
    mesh.color_attributes.active_color = mesh.color_attributes["Paint"]
    _, corners = module("mesh_data").polygons(mesh)
    points, images = positions(mesh), module("stored_map").load(mesh).surface_points.positions(positions(mesh))
    values = np.zeros((len(mesh.loops), 4), np.float32)
    module("mesh_data").update_attribute(mesh.attributes["Paint"], values + np.float32(0.5))
    paint(quadruped, "VERTEX_PAINT")
    values[:, :3], values[:, 3] = points[corners], 1
    values = np.where((sides == 1)[corners, None], values, np.float32(0.5))
    module("mesh_data").update_attribute(mesh.attributes["Paint"], values)
    stroke()
    found, right = attribute(mesh, "Paint"), (sides == -1)[corners]
    away = np.linalg.norm(found[right, :3] - images[corners[right]], axis=1)
    assert np.median(away) < 1e-6 and np.quantile(away, 0.9) < 1e-5
    assert np.array_equal(found[sides[corners] == 1], values[sides[corners] == 1])


def test_a_painted_weight_is_that_of_the_other_group(human, truth):
    hand, groups = a_hand(human, 1).tolist(), [human.vertex_groups.new(name=name) for name in ("Arm.L", "Arm.R")]
    groups[0].add(hand, 0.125, "REPLACE")
    groups[1].add(hand, 0.25, "REPLACE")
    groups[1].add(truth[hand].tolist(), 0.5, "REPLACE")
    groups[0].add(truth[hand].tolist(), 0.75, "REPLACE")
    human.vertex_groups.active = human.vertex_groups["Arm.L"]
    paint(human, "WEIGHT_PAINT")
    human.vertex_groups["Arm.L"].add(hand, 0.375, "REPLACE")
    stroke()
    weights = module("weights").read_weights(human)
    assert (weights[hand] == (0.375, 0.25)).all() and (weights[truth[hand]] == (0.75, 0.375)).all()


@pytest.mark.parametrize("names", [("Arm.L", "Arm.R"), ("Spine", "Spine")])
def test_painted_weights_go_to_the_other_group(human, truth, names):
    hand = a_hand(human, 1)
    for name in dict.fromkeys(names):
        human.vertex_groups.new(name=name)
    human.vertex_groups.active = human.vertex_groups[names[0]]
    paint(human, "WEIGHT_PAINT")
    human.vertex_groups[names[0]].add(hand.tolist(), 0.75, "REPLACE")
    stroke()
    there = human.vertex_groups[names[1]].index
    found = {(v.index, g.group): g.weight for v in human.data.vertices for g in v.groups if g.weight}
    assert len(found) == 2 * len(hand)
    assert all(found[vertex, there] == pytest.approx(0.75) for vertex in truth[hand].tolist())


def test_a_painted_mask_is_carried(human, truth):
    hand, mask = a_hand(human, 1), np.zeros(len(human.data.vertices), np.float32)
    paint(human, "SCULPT")
    mask[hand] = 0.5
    module("mesh_data").write_attribute(human.data, ".sculpt_mask", "FLOAT", mask)
    stroke()
    found = attribute(human.data, ".sculpt_mask")
    assert np.allclose(found[truth[hand]], 0.5) and np.count_nonzero(found) == 2 * len(hand)


def half_step(message):
    """An undo step as a stroke leaves it: kept before the other side follows."""
    live = module("live")
    live._undoing = True
    ops.ed.undo_push(message=message)
    live._undoing = False
    stroke()


def test_undo_of_painted_weights_takes_both_sides(human):
    hand = a_hand(human, 1)
    human.vertex_groups.new(name="Spine")
    paint(human, "WEIGHT_PAINT")
    ops.ed.undo_push(message="Start")
    for part in (hand[:50], hand[50:]):
        bpy.context.object.vertex_groups["Spine"].add(part.tolist(), 0.75, "REPLACE")
        half_step("Stroke")
    painted = [weighed()]
    for _ in range(2):
        ops.ed.undo()
        painted.append(weighed())
    assert painted == [2 * len(hand), 100, 0]
    ops.ed.redo()
    assert weighed() == 100


def weighed():
    return sum(group.weight > 0 for vertex in bpy.context.object.data.vertices for group in vertex.groups)
