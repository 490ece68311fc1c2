# SPDX-License-Identifier: GPL-3.0-or-later
"""Symmetrize exactly, at rest and in a pose."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, positions, said, select

ops = bpy.ops.intrinsic_symmetry
#: Turned and moved, so that no axis is the mirror plane.
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]


@pytest.fixture
def head():
    """A monkey's head at rest, turned, with its symmetry."""
    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    _set(object, positions(object.data) @ TURN.T + (1, 2, 3))
    assert ops.detect() == {"FINISHED"}
    return object


def _set(object, points):
    module("mesh_data").set_shown_positions(object, points)


def _spoil(object):
    """Draws one side away from the plane by up to a tenth of the size, as wide as the side."""
    before, side = positions(object.data), attribute(object.data, "sym_side")
    normal = TURN[:, 0] * np.sign((before[side == 1].mean(0) - before[side == -1].mean(0)) @ TURN[:, 0])
    away = np.where(side == -1, (before - before[side == 0].mean(0)) @ normal, 0)
    _set(object, before + 0.2 * away[:, None] * normal)
    return before


def _asymmetry(object, about="PLANE"):
    symmetry, points = module("stored_map").load(object.data), positions(object.data)
    return module("asymmetry").reference(about, symmetry, object.data, points).asymmetry(symmetry, points)


def test_wide_asymmetry_goes_wholly_and_the_winning_side_stays(head, mode):
    wanted = _spoil(head)
    assert _asymmetry(head).max() > 0.05
    select(head, [])
    enter(mode)
    assert ops.symmetrize_exactly(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    enter("OBJECT")
    assert _asymmetry(head).max() < 1e-6
    side = attribute(head.data, "sym_side")
    assert np.abs(positions(head.data) - wanted)[side == 1].max() < 1e-6
    line = np.linalg.norm(positions(head.data) - wanted, axis=1)[side == 0].max()
    assert line < 0.05, "the line goes onto the plane"


def test_an_exchange_at_rest_twice_gives_back(head):
    """Also vertices on the line that are off the plane."""
    _spoil(head)
    bent = positions(head.data) + 0.05 * np.sin(5 * positions(head.data) @ TURN)[:, 1:2] * TURN[:, 0]
    _set(head, bent)
    assert ops.symmetrize_exactly(about="PLANE", direction="SWAP") == {"FINISHED"}
    assert np.abs(positions(head.data) - bent).max() > 0.05
    ops.symmetrize_exactly(about="PLANE", direction="SWAP")
    assert np.abs(positions(head.data) - bent).max() < 1e-5


def test_issue_38_an_exchange_of_positions_at_rest_twice_gives_back(head):
    before = positions(head.data)
    ear = before[np.where(attribute(head.data, "sym_side") == 1, np.linalg.norm(before - before.mean(0), axis=1), 0).argmax()]
    near = np.exp(-(((before - ear) / 0.2) ** 2).sum(axis=1))
    bent = before + 0.2 * near[:, None] * TURN[:, 1]
    _set(head, bent)
    assert ops.symmetrize(direction="SWAP") == {"FINISHED"}
    assert np.abs(positions(head.data) - bent).max() > 0.1
    ops.symmetrize(direction="SWAP")
    assert np.abs(positions(head.data) - bent).max() < 1e-5


def test_strength_is_a_share(head):
    _spoil(head)
    before = _asymmetry(head).mean()
    ops.symmetrize_exactly(direction="AVERAGE", strength=0.5)
    assert 0.3 * before < _asymmetry(head).mean() < 0.7 * before
    ops.symmetrize_exactly(direction="AVERAGE", strength=0.5, repeat=20)
    assert _asymmetry(head).mean() < 1e-5


def test_about_the_object_s_own_axis(head, capfd):
    _set(head, (positions(head.data) - (1, 2, 3)) @ TURN)
    _spoil_x = positions(head.data) * np.where(positions(head.data)[:, :1] > 0, (1.2, 1, 1), 1)
    _set(head, _spoil_x)
    assert "about its own plane X = 0" in said(capfd, ops.symmetrize_exactly, about="X", direction="AVERAGE")
    points, partner = positions(head.data), attribute(head.data, "sym_vertex")
    assert np.abs(points[partner] * (-1, 1, 1) - points).max() < 1e-6


def test_the_object_s_own_axis_far_from_the_mirror_plane_is_refused(head):
    """Moved, or turned, half of the shape would land on the other side of X = 0."""
    straight = (positions(head.data) - (1, 2, 3)) @ TURN
    turned = np.stack([straight[:, 1], straight[:, 0], straight[:, 2]], axis=1)
    for points, words in ((straight + (10, 0, 0), "turned by 0°, and 366% of"), (turned, "turned by 90°, and")):
        _set(head, points)
        with pytest.raises(RuntimeError, match=f"not own X = 0: it is {words} .*Choose Automatic"):
            ops.symmetrize_exactly(about="X")
        assert np.abs(positions(head.data) - points).max() < 1e-6
    _set(head, straight + (0.02, 0, 0))
    assert ops.symmetrize_exactly(about="X") == {"FINISHED"}


def test_a_posed_body_keeps_its_pose(human):
    symmetry, before = module("stored_map").load(human.data), positions(human.data)
    assert module("asymmetry").reference("AUTO", symmetry, human.data, before).plane is None
    assert module("asymmetry").reference("PLANE", symmetry, human.data, before).plane is not None
    old = _asymmetry(human, "POSE").mean()
    assert ops.symmetrize_exactly(direction="AVERAGE") == {"FINISHED"}
    assert _asymmetry(human, "POSE").mean() < 0.6 * old
    assert np.linalg.norm(positions(human.data) - before, axis=1).max() < 0.03 * np.ptp(before[:, 2])


def test_a_longer_leg_in_a_pose_takes_the_length_of_the_other(human):
    """What is left over, against what the tool makes of the body without the change."""
    whole, side = positions(human.data), attribute(human.data, "sym_side")
    height = np.ptp(whole[:, 2])
    up = (whole[:, 2] - whole[:, 2].min()) / height
    change = np.zeros_like(whole)
    change[:, 2] = np.where((side == 1) & (up < 0.5), -0.05 * height * np.clip((0.45 - up) / 0.3, 0, 1), 0)
    made = []
    for given in (whole, whole + change):
        _set(human, given)
        assert ops.symmetrize_exactly(direction="RIGHT_TO_LEFT") == {"FINISHED"}
        made.append(positions(human.data))
    assert np.linalg.norm(made[1] - made[0]) < 0.4 * np.linalg.norm(change)
    assert np.linalg.norm(made[0] - whole, axis=1).mean() < 0.01 * height
    assert np.abs(made[1] - whole)[side == -1].max() < 1e-5, "the winning side stays"


def test_a_thicker_thigh_in_a_pose_changes_sides(human, capfd):
    """Against what the tool makes of the body without the change."""
    whole, side, partner = positions(human.data), *(attribute(human.data, f"sym_{name}") for name in ("side", "vertex"))
    height = np.ptp(whole[:, 2])
    up = (whole[:, 2] - whole[:, 2].min()) / height
    thick = np.where(side == 1, 0.01 * height * np.exp(-(((up - 0.38) / 0.05) ** 2)), 0)
    normals, made = np.array([vertex.normal for vertex in human.data.vertices]), []
    for given in (whole, whole + thick[:, None] * normals):
        _set(human, given)
        assert "Exchanged in its pose: vertices moved" in said(capfd, ops.symmetrize_exactly, direction="SWAP")
        made.append(positions(human.data))
    out = np.einsum("vx,vx->v", made[1] - made[0], normals)
    own, other = (out @ wanted / (thick @ thick) for wanted in (thick, thick[partner]))
    assert own < 0.3 and other > 0.7


def test_a_seam_of_doubled_vertices_does_not_open(head):
    depth = (positions(head.data) @ TURN)[:, 1]
    select(head, np.flatnonzero(depth > np.median(depth)))
    enter("EDIT")
    bpy.ops.mesh.split()
    enter("OBJECT")
    assert ops.detect() == {"FINISHED"}
    _spoil(head)
    before = positions(head.data)
    point = np.unique(before, axis=0, return_inverse=True)[1].ravel()
    assert point.max() + 1 < len(before) - 10
    assert ops.symmetrize_exactly(about="POSE", direction="AVERAGE") == {"FINISHED"}
    after, one = positions(head.data), np.zeros((point.max() + 1, 3))
    assert np.abs(after - before).max() > 0.01
    one[point] = after
    assert np.abs(one[point] - after).max() < 1e-6


def test_the_equation_is_solved_as_by_elimination():
    numbers = np.random.default_rng(0)
    points, edges = numbers.normal(size=(60, 3)), numbers.integers(60, size=(200, 2))
    edges = edges[edges[:, 0] != edges[:, 1]]
    weights, changes = numbers.uniform(0.1, 1, len(edges)), numbers.normal(size=(len(edges), 3))
    hold, free = numbers.uniform(0, 0.1, 60), numbers.uniform(size=60) > 0.2
    gradient = np.zeros((len(edges), 60))
    gradient[np.arange(len(edges)), edges[:, 1]] = 1
    gradient[np.arange(len(edges)), edges[:, 0]] = -1
    matrix = gradient.T @ (weights[:, None] * gradient) + np.diag(hold)
    right = gradient.T @ (weights[:, None] * changes)
    wanted = np.zeros((60, 3))
    wanted[free] = np.linalg.solve(matrix[free][:, free], right[free])
    found = module("multilevel").Graph(points, edges, weights, hold, free).moved(changes)
    assert np.abs(found - wanted).max() < 1e-3 * np.abs(wanted).max()


def test_only_the_selection_and_its_image_move(head):
    _spoil(head)
    before, side = positions(head.data), attribute(head.data, "sym_side")
    chosen = np.flatnonzero(side == -1)[:40]
    select(head, chosen)
    enter("EDIT")
    ops.symmetrize_exactly(direction="LEFT_TO_RIGHT")
    enter("OBJECT")
    moved = np.flatnonzero(np.abs(positions(head.data) - before).max(axis=1) > 1e-6)
    assert len(moved) and set(moved) <= set(chosen)


def test_a_half_turn_has_no_plane(head):
    head.data["intrinsic_symmetry"]["kind"] = 1
    with pytest.raises(RuntimeError, match="no mirror plane"):
        ops.symmetrize_exactly(about="PLANE", direction="AVERAGE")


@pytest.mark.parametrize("size", [1e-12, 1e-30])
def test_a_tiny_mesh(size, capfd):
    """Its areas, and the squares of its lengths, are no numbers of single precision."""
    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    ops.detect()
    places = positions(object.data)
    places[attribute(object.data, "sym_side") == -1] *= 1.1
    object.data.vertices.foreach_set("co", (size * places).astype(np.float32).ravel())
    assert "nan" not in said(capfd, ops.symmetrize)
    assert "now 0.000%" in said(capfd, ops.symmetrize_exactly, about="PLANE")


@pytest.fixture
def split_head():
    """A monkey's head whose sharp edges are split, as files for games have it. In its map some images are a little beside
    the vertices, and those of the copies at one place not alike, as they may be where left and right share no faces."""
    import intrinsym

    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    modifier = object.modifiers.new("Split", "EDGE_SPLIT")
    modifier.split_angle = 0.4
    bpy.ops.object.modifier_apply(modifier=modifier.name)
    assert ops.detect() == {"FINISHED"}
    mesh, stored = object.data, module("stored_map")
    found, core_mesh = stored.load(mesh), intrinsym.Mesh(positions(mesh).astype(np.float32), module("mesh_data").polygons(mesh))
    beside = np.random.default_rng(0).uniform(-0.1, 0.05, len(mesh.vertices))
    beside = np.where(found.side == 0, 0, np.maximum(beside, 0))[:, None]
    weights = (1 - beside) * found.surface_points.barycentrics + beside / 3
    points = intrinsym.SurfacePoints(found.surface_points.faces, found.surface_points.corners, weights)
    near = core_mesh.restore(found.kind, found.partner, found.confidence, found.side, points)
    stored.store(mesh, core_mesh, near, left=(1, mesh[stored.RECORD]["left_from"]), exact_share=0.0)
    return object


def _copies(points):
    """(vertices,) number of the place, and how many places have copies."""
    place = np.unique(points, axis=0, return_inverse=True)[1].ravel()
    return place, np.count_nonzero(np.bincount(place) > 1)


@pytest.mark.parametrize("tool", ["symmetrize", "symmetrize_exactly"])
@pytest.mark.parametrize("direction", ["LEFT_TO_RIGHT", "AVERAGE", "SWAP"])
def test_what_is_mirrored_already_stays_though_the_map_is_beside_it(split_head, tool, direction):
    before = positions(split_head.data)
    assert getattr(ops, tool)(direction=direction) == {"FINISHED"}
    assert np.abs(positions(split_head.data) - before).max() < 1e-6


@pytest.mark.parametrize("about", [None, "PLANE", "POSE"])
@pytest.mark.parametrize("direction", ["LEFT_TO_RIGHT", "AVERAGE"])
def test_copies_at_one_place_move_together(split_head, about, direction):
    """Also those on the line, off the plane."""
    before = positions(split_head.data)
    dent = np.exp(-(((before - (-0.3, -0.6, 0.3)) / 0.4) ** 2).sum(axis=1))
    dented = before + 0.1 * dent[:, None] * (1, 0.5, 0)
    _set(split_head, dented)
    place, count = _copies(positions(split_head.data))
    tool = ops.symmetrize if about is None else ops.symmetrize_exactly
    assert tool(direction=direction, **({"about": about} if about else {})) == {"FINISHED"}
    after = positions(split_head.data)
    assert count > 100 and all(len(np.unique(after[place == one], axis=0)) == 1 for one in np.unique(place))
    assert np.abs(after - dented).max() > 0.01
    if about == "PLANE":
        line = after[attribute(split_head.data, "sym_side") == 0]
        assert np.linalg.svd(line - line.mean(axis=0))[1][-1] < 1e-3, "the line goes onto the plane"
