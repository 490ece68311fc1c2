# SPDX-License-Identifier: GPL-3.0-or-later
"""Live mirror: what is moved, sculpted or painted on one side happens on the other."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, positions, select
from intrinsym import Merge

ops = bpy.ops


def switch(object, on=True, name="intrinsic_symmetry_live"):
    setattr(object, name, on)
    assert getattr(object, name) is on


def places(object):
    """(vertices, 3) float32, in any mode."""
    if object.data.is_editmode:
        return np.array([vertex.co[:] for vertex in bmesh.from_edit_mesh(object.data).verts], np.float32)
    return positions(object.data).astype(np.float32)


def a_hand(object, side, count=120):
    """The vertices of a side that are nearest to its point farthest outside."""
    mesh = object.data
    points, sides = positions(mesh), attribute(mesh, "symmetry_side")
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
