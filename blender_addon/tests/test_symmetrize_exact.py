# SPDX-License-Identifier: GPL-3.0-or-later
"""Symmetrize exactly, at rest and in a pose."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, positions, select

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


def test_strength_is_a_share(head):
    _spoil(head)
    before = _asymmetry(head).mean()
    ops.symmetrize_exactly(direction="AVERAGE", strength=0.5)
    assert 0.3 * before < _asymmetry(head).mean() < 0.7 * before
    ops.symmetrize_exactly(direction="AVERAGE", strength=0.5, repeat=20)
    assert _asymmetry(head).mean() < 1e-5


def test_about_the_object_s_own_axis(head):
    _set(head, (positions(head.data) - (1, 2, 3)) @ TURN)
    _spoil_x = positions(head.data) * np.where(positions(head.data)[:, :1] > 0, (1.2, 1, 1), 1)
    _set(head, _spoil_x)
    ops.symmetrize_exactly(about="X", direction="AVERAGE")
    points, partner = positions(head.data), attribute(head.data, "sym_vertex")
    assert np.abs(points[partner] * (-1, 1, 1) - points).max() < 1e-6


def test_a_posed_body_keeps_its_pose(human):
    symmetry, before = module("stored_map").load(human.data), positions(human.data)
    assert module("asymmetry").reference("AUTO", symmetry, human.data, before).plane is None
    assert module("asymmetry").reference("PLANE", symmetry, human.data, before).plane is not None
    old = _asymmetry(human, "POSE").mean()
    assert ops.symmetrize_exactly(direction="AVERAGE", repeat=5) == {"FINISHED"}
    assert _asymmetry(human, "POSE").mean() < 0.6 * old
    assert np.linalg.norm(positions(human.data) - before, axis=1).max() < 0.03 * np.ptp(before[:, 2])


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
