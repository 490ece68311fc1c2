# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror vertex groups, shape keys and attributes."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, positions, said, select
from intrinsym import Merge

ops = bpy.ops.intrinsic_symmetry


def _add_group(object, name, weights):
    group = object.vertex_groups.new(name=name)
    for vertex in np.flatnonzero(weights).tolist():
        group.add((vertex,), float(weights[vertex]), "REPLACE")


def _weights(object, name):
    column = object.vertex_groups[name].index
    return module("weights").read_weights(object)[:, column]


@pytest.fixture
def bump(human):
    """(vertices,) a smooth bump on the left side, 0..1."""
    points, side = positions(human.data), attribute(human.data, "sym_side")
    far = np.argmax(np.where(side == 1, points[:, 0], -np.inf))
    distance = np.linalg.norm(points - points[far], axis=1) / np.ptp(points[:, 0])
    return np.where(side == 1, np.maximum(1 - 3 * distance, 0), 0).astype(np.float32)


@pytest.mark.parametrize("merge", list(Merge))
@pytest.mark.parametrize("soft", [False, True])
def test_shares_are_the_library_s(quadruped, merge, soft):
    symmetry = module("stored_map").load(quadruped.data)
    values = np.random.default_rng(0).normal(size=(len(symmetry.partner), 2))
    how = {"minimum_confidence": 0.5, "weight_by_confidence": soft}
    share = module("mirroring").shares(symmetry, merge, **how)
    image = symmetry.mirror_values(values, Merge.SWAP)
    blended = module("mirroring").blend(values, image, share)
    assert np.allclose(blended, symmetry.mirror_values(values, merge, **how), atol=1e-6)


def test_weights_go_to_the_group_of_the_other_side(human, truth, bump, mode):
    _add_group(human, "Arm.L", bump)
    select(human, [])
    enter(mode)
    assert ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    enter("OBJECT")
    assert np.allclose(_weights(human, "Arm.R"), bump[truth], atol=1e-6)
    assert np.array_equal(_weights(human, "Arm.L"), bump)


def test_no_group_is_made_where_nothing_of_it_is_selected(human, truth, bump, capfd):
    side = attribute(human.data, "sym_side")
    for name, weights in (("Foot.L", (side == 1) & (bump == 0)), ("Arm.L", bump), ("Leg.L", (side == 1) & (bump == 0))):
        _add_group(human, name, np.float32(weights))
    chosen = np.flatnonzero(bump > 0.5)
    select(human, chosen)
    enter("EDIT")
    assert 'Made: "Arm.R"' in said(capfd, ops.mirror_vertex_groups)
    enter("OBJECT")
    assert human.vertex_groups.keys() == ["Foot.L", "Arm.L", "Leg.L", "Arm.R"]
    assert np.allclose(_weights(human, "Arm.R")[truth[chosen]], bump[chosen], atol=1e-6)


@pytest.mark.parametrize("twin", [None, "Leg.R"])
def test_issue_38_the_only_group_with_weights_keeps_them_on_the_line(human, twin):
    """The other one, empty or missing, gets the same."""
    side = attribute(human.data, "sym_side")
    _add_group(human, "Leg.L", np.where(side > 0, 0.8, np.where(side == 0, 0.5, 0)))
    if twin:
        human.vertex_groups.new(name=twin)
    assert ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    assert np.count_nonzero(side == 0) > 50
    for name, sign in (("Leg.L", 1), ("Leg.R", -1)):
        assert np.allclose(_weights(human, name), np.where(side == sign, 0.8, np.where(side == 0, 0.5, 0)), atol=1e-6)


def test_weights_in_weight_paint_mode(human, truth, bump):
    _add_group(human, "Arm.L", bump)
    enter("WEIGHT_PAINT")
    ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT")
    assert human.mode == "WEIGHT_PAINT"
    enter("OBJECT")
    assert np.allclose(_weights(human, "Arm.R"), bump[truth], atol=1e-6)


def test_a_centre_group_is_mirrored_in_place(human, truth, bump):
    _add_group(human, "Spine", bump)
    ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT")
    assert np.allclose(_weights(human, "Spine"), bump + bump[truth], atol=1e-6)
    assert len(human.vertex_groups) == 1


def test_names_can_stay(human, truth, bump):
    _add_group(human, "Arm.L", bump)
    ops.mirror_vertex_groups(direction="SWAP", exchange_names=False)
    assert np.allclose(_weights(human, "Arm.L"), bump[truth], atol=1e-6)
    assert "Arm.R" not in human.vertex_groups


def test_average_of_a_pair(human, truth, bump):
    _add_group(human, "Arm.L", bump)
    _add_group(human, "Arm.R", 0.5 * bump[truth])
    ops.mirror_vertex_groups(direction="AVERAGE")
    assert np.allclose(_weights(human, "Arm.L"), 0.75 * bump, atol=1e-6)
    assert np.allclose(_weights(human, "Arm.R"), 0.75 * bump[truth], atol=1e-6)


def test_only_the_active_group_and_locked_ones(human, truth, bump):
    _add_group(human, "Leg.L", bump)
    _add_group(human, "Arm.L", bump)
    human.vertex_groups.active = human.vertex_groups["Arm.L"]
    ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT", all_groups=False)
    assert "Leg.R" not in human.vertex_groups
    assert np.allclose(_weights(human, "Arm.R"), bump[truth], atol=1e-6)
    human.vertex_groups["Arm.R"].lock_weight = True
    ops.mirror_vertex_groups(direction="SWAP")
    assert np.allclose(_weights(human, "Arm.R"), bump[truth], atol=1e-6)


def test_only_the_selection_and_its_image_change(human, truth, bump):
    _add_group(human, "Arm.L", bump)
    strong = np.flatnonzero(bump > 0.5)
    select(human, strong)
    enter("EDIT")
    ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT")
    enter("OBJECT")
    found = _weights(human, "Arm.R")
    assert np.allclose(found[truth[strong]], bump[strong], atol=1e-6)
    rest = np.setdiff1d(np.arange(len(bump)), truth[strong])
    assert (found[rest] == 0).all()


def test_groups_are_needed(human):
    with pytest.raises(RuntimeError, match="no vertex groups"):
        ops.mirror_vertex_groups()


def _key(object, name, displacement):
    if object.data.shape_keys is None:
        object.shape_key_add(name="Basis")
    key = object.shape_key_add(name=name)
    module("mesh_data").set_key_positions(key, positions(object.data) + displacement)
    object.active_shape_key_index = object.data.shape_keys.key_blocks.find(name)


def _displacement(object, name):
    key = object.data.shape_keys.key_blocks[name]
    base = module("mesh_data").key_positions(key.relative_key)
    return module("mesh_data").key_positions(key).astype(float) - base


def _normals(object):
    normals = np.empty(3 * len(object.data.vertices), np.float32)
    object.data.vertices.foreach_get("normal", normals)
    return normals.reshape(-1, 3)


def test_a_shape_key_is_carried_in_any_pose(human, truth, bump, mode):
    """A swelling along the normals of the raised arm is one along the normals of the hanging arm."""
    swelling = 0.01 * bump[:, None] * _normals(human)
    _key(human, "Swell.L", swelling)
    select(human, [])
    enter(mode)
    assert ops.mirror_shape_keys() == {"FINISHED"}
    enter("OBJECT")
    assert human.active_shape_key.name == "Swell.L"
    carried = _displacement(human, "Swell.R")
    wanted = 0.01 * bump[truth][:, None] * _normals(human)
    assert np.abs(carried - wanted).max() < 0.0015
    assert np.abs(_displacement(human, "Swell.L") - swelling).max() < 1e-6


def test_a_shape_key_in_place(human, truth, bump):
    swelling = 0.01 * bump[:, None] * _normals(human)
    _key(human, "Swell", swelling)
    ops.mirror_shape_keys(direction="LEFT_TO_RIGHT")
    found = _displacement(human, "Swell")
    both = 0.01 * (bump + bump[truth])[:, None] * _normals(human)
    assert np.abs(found - both).max() < 0.0015
    assert len(human.data.shape_keys.key_blocks) == 2


def test_all_shape_keys_of_one_side(human, bump):
    swelling = 0.01 * bump[:, None] * _normals(human)
    _key(human, "Smile.L", swelling)
    _key(human, "Smile.R", 0 * swelling)
    _key(human, "Frown.R", 0 * swelling)
    ops.mirror_shape_keys(all_keys=True, direction="LEFT_TO_RIGHT")
    assert np.abs(_displacement(human, "Smile.R")).max() > 0.005
    assert np.abs(_displacement(human, "Smile.L")).max() > 0.005
    assert "Frown.L" in human.data.shape_keys.key_blocks


def test_shape_keys_are_needed(human):
    with pytest.raises(RuntimeError, match="no shape key"):
        ops.mirror_shape_keys()
    human.shape_key_add(name="Basis")
    human.shape_key_add(name="Other")
    human.active_shape_key_index = 0
    with pytest.raises(RuntimeError, match="basis is active"):
        ops.mirror_shape_keys()


def _new_attribute(mesh, kind, domain, values):
    mesh.attributes.new("mine", kind, domain)
    module("mesh_data").update_attribute(mesh.attributes["mine"], values)


@pytest.mark.parametrize("kind, columns", [("FLOAT", 1), ("FLOAT_COLOR", 4), ("INT", 1), ("BOOLEAN", 1), ("FLOAT2", 2)])
def test_point_attributes(human, truth, mode, kind, columns):
    random = np.random.default_rng(0).uniform(0, 9, (len(truth), columns))
    random = random > 4 if kind == "BOOLEAN" else random
    _new_attribute(human.data, kind, "POINT", random)
    before = attribute(human.data, "mine")
    select(human, [])
    enter(mode)
    assert ops.mirror_attribute(name="mine", direction="LEFT_TO_RIGHT") == {"FINISHED"}
    enter("OBJECT")
    right = attribute(human.data, "sym_side") == -1
    after = attribute(human.data, "mine")
    assert np.allclose(after[right], before[truth][right], atol=1e-5)
    assert np.array_equal(after[~right], before[~right])


def test_crease_of_edges(human, truth):
    mesh = human.data
    crease = np.random.default_rng(0).random(len(mesh.edges)).astype(np.float32)
    mesh.attributes.new("crease_edge", "FLOAT", "EDGE")
    module("mesh_data").update_attribute(mesh.attributes["crease_edge"], crease)
    ops.mirror_attribute(name="crease_edge", direction="SWAP")
    after = attribute(mesh, "crease_edge")
    number = {frozenset(edge.vertices): edge.index for edge in mesh.edges}
    images = [number[frozenset(truth[list(edge.vertices)])] for edge in mesh.edges]
    assert np.array_equal(after, crease[images])


def test_face_sets_and_corner_colours(human, truth):
    mesh = human.data
    centres = np.array([np.mean([mesh.vertices[v].co.z for v in face.vertices]) for face in mesh.polygons])
    _new_attribute(mesh, "INT", "FACE", (centres * 10).astype(int))
    before = attribute(mesh, "mine")
    ops.mirror_attribute(name="mine", direction="SWAP")
    number = {frozenset(face.vertices): face.index for face in mesh.polygons}
    images = [number[frozenset(truth[list(face.vertices)])] for face in mesh.polygons]
    assert np.array_equal(attribute(mesh, "mine"), before[images])
    corners = np.array([loop.vertex_index for loop in mesh.loops])
    colours = np.random.default_rng(0).random((len(mesh.vertices), 4))
    mesh.attributes.new("paint", "BYTE_COLOR", "CORNER")
    module("mesh_data").update_attribute(mesh.attributes["paint"], colours[corners])
    stored = attribute(mesh, "paint")
    ops.mirror_attribute(name="paint", direction="SWAP")
    by_vertex = np.zeros_like(colours)
    by_vertex[corners] = stored
    assert np.abs(attribute(mesh, "paint") - by_vertex[truth][corners]).max() < 0.01


@pytest.mark.parametrize("domain", ["EDGE", "FACE", "CORNER"])
@pytest.mark.parametrize("kind", ["FLOAT", "INT"])
def test_elements_at_the_line_belong_to_their_side(human, truth, domain, kind):
    """The losing side's become images, the winning side's stay, and so do those on the line alone."""
    mesh, side = human.data, attribute(human.data, "sym_side")
    corners = [(loop, face) for face in mesh.polygons for loop in face.loop_indices]
    members = {
        "EDGE": [frozenset(edge.vertices) for edge in mesh.edges],
        "FACE": [frozenset(face.vertices) for face in mesh.polygons],
        "CORNER": [(mesh.loops[loop].vertex_index, frozenset(face.vertices)) for loop, face in corners],
    }[domain]
    number = {one: index for index, one in enumerate(members)}
    image_of = lambda vertices: frozenset(truth[list(vertices)])  # noqa: E731
    images = [number[(truth[one[0]], image_of(one[1])) if domain == "CORNER" else image_of(one)] for one in members]
    sides = [side[list(one[1] if domain == "CORNER" else one)] for one in members]
    loses = np.array([(each < 0).any() for each in sides])
    at_line = np.array([(each < 0).any() and (each == 0).any() for each in sides])
    _new_attribute(mesh, kind, domain, np.random.default_rng(0).uniform(0, 1000, len(members)))
    before = attribute(mesh, "mine")
    ops.mirror_attribute(name="mine", direction="LEFT_TO_RIGHT")
    assert at_line.sum() > 20 and not any((each < 0).any() and (each > 0).any() for each in sides)
    assert np.allclose(attribute(mesh, "mine"), np.where(loses, before[images], before))


@pytest.mark.parametrize("one_side_loses", [True, False])
def test_elements_across_the_line_do_not_exchange(one_side_loses):
    """Two triangles of a square, each the other's image, with vertices on both sides."""
    taken, trust = np.array([0.0, 1, 1, 0]), np.full(4, 0.5)
    merge = Merge.POSITIVE_WINS if one_side_loses else Merge.SWAP
    how_far = module("ops_attributes")._HowFar(taken, trust, merge)
    shares = how_far.shares(np.array([0, 1, 3, 1, 2, 3]), np.array([0, 3]), np.array([1, 0]))
    assert np.array_equal(shares, [0, 0] if one_side_loses else [0.5, 0.5])


@pytest.mark.parametrize("domain", ["POINT", "EDGE", "FACE", "CORNER"])
@pytest.mark.parametrize("kind", ["INT", "INT8"])
def test_the_mean_of_whole_numbers_is_rounded(human, domain, kind):
    """It is the same on both sides, and its own mean."""
    mesh, side = human.data, attribute(human.data, "sym_side")
    members = {
        "POINT": [[vertex] for vertex in range(len(side))],
        "EDGE": [edge.vertices[:] for edge in mesh.edges],
        "FACE": [face.vertices[:] for face in mesh.polygons],
        "CORNER": [[loop.vertex_index] for loop in mesh.loops],
    }[domain]
    sides = np.array([np.sign(side[list(each)].sum(dtype=int)) for each in members])
    _new_attribute(mesh, kind, domain, np.where(sides > 0, 10, 3))
    for _ in range(2):
        assert ops.mirror_attribute(name="mine", direction="AVERAGE") == {"FINISHED"}
        assert set(attribute(mesh, "mine")[sides != 0].tolist()) == {6}


@pytest.mark.parametrize("name, kind, domain", [
    (".sculpt_face_set", "INT", "FACE"), ("material_index", "INT", "FACE"), ("sharp_edge", "BOOLEAN", "EDGE"),
    ("mine", "BOOLEAN", "POINT"),
])
def test_what_has_no_mean_is_refused(human, name, kind, domain):
    mesh = human.data
    mesh.attributes.new(name, kind, domain)
    values = np.random.default_rng(0).integers(0, 2, len(mesh.attributes[name].data))
    module("mesh_data").update_attribute(mesh.attributes[name], values)
    with pytest.raises(RuntimeError, match="no mean"):
        ops.mirror_attribute(name=name, direction="AVERAGE")
    assert np.array_equal(attribute(mesh, name), values)
    assert ops.mirror_attribute(name=name, direction="SWAP") == {"FINISHED"}


def test_attributes_of_an_irregular_mesh(quadruped):
    """Exact images are points inside faces: a smooth function that is symmetric stays what it is."""
    mesh = quadruped.data
    side = attribute(mesh, "sym_side")
    height = positions(mesh)[:, 2]
    for domain, values in (("POINT", height), ("CORNER", height[[loop.vertex_index for loop in mesh.loops]])):
        mesh.attributes.new(domain, "FLOAT", domain)
        module("mesh_data").update_attribute(mesh.attributes[domain], values)
        assert ops.mirror_attribute(name=domain, direction="LEFT_TO_RIGHT") == {"FINISHED"}
        assert np.isfinite(attribute(mesh, domain)).all()
    assert np.array_equal(attribute(mesh, "POINT")[side >= 0], height[side >= 0].astype(np.float32))


def test_vectors_turn_with_the_surface(human, truth):
    _new_attribute(human.data, "FLOAT_VECTOR", "POINT", _normals(human))
    ops.mirror_attribute(name="mine", direction="SWAP", as_vector=True)
    assert (np.einsum("vx,vx->v", attribute(human.data, "mine"), _normals(human)) > 0.99).mean() > 0.94


@pytest.mark.parametrize("name, near, far", [("human", 0.01, 0.15), ("quadruped", 0.1, 0.5)])
def test_custom_normals_turn_with_the_surface(request, name, near, far):
    body = request.getfixturevalue(name)
    mesh, symmetry = body.data, module("stored_map").load(body.data)
    automatic, side = _normals(body), attribute(mesh, "sym_side")
    tilted = automatic + np.where(side == 1, 0.5, 0)[:, None] * np.random.default_rng(0).normal(size=3)
    tilted /= np.linalg.norm(tilted, axis=1, keepdims=True)
    mesh.normals_split_custom_set_from_vertices(tilted.tolist())
    wanted = symmetry.carry_displacement(positions(mesh), tilted, Merge.SWAP)
    assert ops.mirror_attribute(name="custom_normal", direction="LEFT_TO_RIGHT") == {"FINISHED"}
    found, corners = np.empty((len(mesh.loops), 3), np.float32), module("mesh_data").polygons(mesh).corners
    mesh.corner_normals.foreach_get("vector", found.reshape(-1))
    right, left = side[corners] == -1, side[corners] == 1
    off = np.linalg.norm(found - wanted[corners], axis=1)[right]
    assert np.median(off) < near and (off < far).mean() > 0.9
    assert np.abs(found - tilted[corners])[left].max() < 0.02
    assert np.median(np.linalg.norm(wanted - automatic, axis=1)[side == -1]) > 0.2


def test_attributes_that_cannot_be_mirrored(human):
    human.data.attributes.active = human.data.attributes["sym_bary"]
    with pytest.raises(RuntimeError, match="No attribute is active"):
        ops.mirror_attribute()
    for name in ("position", "sym_vertex", "sym_place", "sym_index", "nowhere"):
        with pytest.raises(RuntimeError, match=name):
            ops.mirror_attribute(name=name)


def test_an_attribute_of_the_user_s_that_begins_as_ours_is_mirrored(human, truth, bump):
    for name in ("sym_wear", "sym_remembered_pose", "sym_vertex_2b"):
        human.data.attributes.new(name, "FLOAT", "POINT")
        human.data.attributes.active = human.data.attributes[name]
        module("mesh_data").update_attribute(human.data.attributes[name], bump)
        assert ops.mirror_attribute(direction="LEFT_TO_RIGHT") == {"FINISHED"}
        assert np.allclose(attribute(human.data, name), np.maximum(bump, bump[truth]), atol=1e-6)


LONG = 59 * "x" + "Left"


def test_a_group_whose_twin_has_too_long_a_name_is_left_alone(human, bump, capfd):
    _add_group(human, LONG, bump)
    _add_group(human, "Arm.L", bump)
    message = said(capfd, ops.mirror_vertex_groups)
    assert f'Left alone: "{LONG}" (the name of the other side is too long for Blender: shorten it)' in message
    assert sorted(human.vertex_groups.keys()) == ["Arm.L", "Arm.R", LONG]


def test_a_key_whose_twin_has_too_long_a_name_is_left_alone(human, bump, capfd):
    _key(human, LONG, 0.01 * bump[:, None] * _normals(human))
    message = said(capfd, ops.mirror_shape_keys)
    assert f'Left alone: "{LONG}" (the name of the other side is too long for Blender: shorten it)' in message
    assert human.data.shape_keys.key_blocks.keys() == ["Basis", LONG]


def test_no_group_is_active(human, bump):
    _add_group(human, "Arm.L", bump)
    human.vertex_groups.active_index = -1
    with pytest.raises(RuntimeError, match="No vertex group is active: choose one"):
        ops.mirror_vertex_groups(all_groups=False)
