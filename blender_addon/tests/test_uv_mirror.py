# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror UV islands, on top of each other or in place."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, positions, said, select

ops = bpy.ops.intrinsic_symmetry


def _corners(mesh):
    return np.array([loop.vertex_index for loop in mesh.loops])


def _set_uvs(mesh, uvs):
    """A UV map with one UV a vertex."""
    if not mesh.uv_layers:
        mesh.uv_layers.new(name="UVMap")
    module("mesh_data").update_attribute(mesh.attributes["UVMap"], uvs[_corners(mesh)])


def _uvs(mesh):
    """(vertices, 2), where all corners of a vertex agree."""
    corners, values = _corners(mesh), attribute(mesh, "UVMap").astype(float)
    found = np.zeros((len(mesh.vertices), 2))
    found[corners] = values
    assert np.abs(found[corners] - values).max() < 1e-5, "an island was torn"
    return found


@pytest.fixture
def head():
    """A monkey's head, seen from the front, its right side out of place. The skin is one island, each eye another."""
    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    ops.detect()
    points, side = positions(object.data), attribute(object.data, "sym_side")
    noise = 0.05 * np.random.default_rng(0).normal(size=(len(points), 2))
    _set_uvs(object.data, 0.5 + 0.3 * points[:, [0, 2]] + np.where(side[:, None] == -1, noise, 0))
    return object


def _eyes(object):
    """(vertices,) bool: the two small shells."""
    ends = np.array([edge.vertices[:] for edge in object.data.edges])
    shell = np.arange(len(object.data.vertices))
    while True:
        least = np.minimum(shell[ends[:, 0]], shell[ends[:, 1]])
        before = shell.copy()
        np.minimum.at(shell, ends[:, 0], least)
        np.minimum.at(shell, ends[:, 1], least)
        if np.array_equal(before, shell):
            break
    assert len(np.unique(shell)) == 3
    return shell != np.argmax(np.bincount(shell))


def test_in_place(head, mode):
    """The skin becomes its own mirror image about the line; an eye the mirror image of the other, where it was."""
    mesh, partner, side = head.data, attribute(head.data, "sym_vertex"), attribute(head.data, "sym_side")
    eye, before = _eyes(head), _uvs(mesh)
    select(head, [])
    enter(mode)
    assert ops.mirror_uvs(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    enter("OBJECT")
    after, right = _uvs(mesh), side == -1
    assert np.array_equal(after[~right], before[~right])
    skin = right & ~eye
    assert np.abs(after[skin] - (before[partner] * (-1, 1) + (1, 0))[skin]).max() < 1e-5
    mine = right & eye
    assert np.abs(np.ptp(after[mine], axis=0) - np.ptp(before[partner[mine]], axis=0)).max() < 1e-5
    centre = [0.5 * (uvs[mine].min(axis=0) + uvs[mine].max(axis=0)) for uvs in (before, after)]
    assert np.abs(centre[0] - centre[1]).max() < 1e-5


def test_islands_that_do_not_fit_are_said(head, capfd):
    """The right eye's island lies in a corner of the tile, or on the left one's, and takes the size of that."""
    mesh, side, eye = head.data, attribute(head.data, "sym_side"), _eyes(head)
    points, right = positions(mesh), eye & (side == -1)
    uvs = 0.5 + 0.3 * points[:, [0, 2]]
    middle = uvs[right].mean(axis=0)
    uvs[right] = middle + 0.1 * (uvs[right] - middle)
    cases = {
        "": (0.9, 0.9),
        "UVs have left their tile": (1, 1) - np.ptp(uvs[right], axis=0) / 2,
        "lie over others": (0.8, 0.1),
    }
    uvs[eye & (side == 1)] += (0.8, 0.1) - uvs[eye & (side == 1)].mean(axis=0) + (0.1, 0)
    for words, place in cases.items():
        _set_uvs(mesh, uvs + np.where(right[:, None], place - middle, 0))
        found = said(capfd, ops.mirror_uvs)
        assert words in found and ("pack the islands" in found) == bool(words)


def test_overlap(head):
    mesh, partner, side = head.data, attribute(head.data, "sym_vertex"), attribute(head.data, "sym_side")
    before = _uvs(mesh)
    ops.mirror_uvs(direction="RIGHT_TO_LEFT", placement="OVERLAP")
    after = _uvs(mesh)
    assert np.abs(after[side == 1] - before[partner][side == 1]).max() < 1e-6
    assert np.array_equal(after[side != 1], before[side != 1])


@pytest.mark.parametrize("placement", ["BESIDE", "OVERLAP"])
def test_a_second_time_changes_nothing_and_says_so(head, placement, capfd):
    assert " 0 UVs" not in said(capfd, ops.mirror_uvs, placement=placement)
    assert " 0 UVs in 0 islands" in said(capfd, ops.mirror_uvs, placement=placement)


def test_seams_stay_seams(human, truth):
    """Each face of the right side takes the UVs of its own mirror image, though a vertex has many."""
    mesh = human.data
    mesh.uv_layers.new(name="UVMap")
    uvs = np.random.default_rng(0).random((len(mesh.loops), 2)).astype(np.float32)
    module("mesh_data").update_attribute(mesh.attributes["UVMap"], uvs)
    ops.mirror_uvs(placement="OVERLAP")
    after, side = attribute(mesh, "UVMap"), attribute(mesh, "sym_side")
    number = {frozenset(face.vertices): face for face in mesh.polygons}
    for face in list(mesh.polygons)[::7]:
        image = number[frozenset(truth[list(face.vertices)].tolist())]
        there = {mesh.loops[loop].vertex_index: uvs[loop] for loop in image.loop_indices}
        losing = (side[list(face.vertices)] == -1).any()
        for loop in face.loop_indices:
            wanted = there[truth[mesh.loops[loop].vertex_index]] if losing else uvs[loop]
            assert np.allclose(after[loop], wanted)


def test_an_irregular_mesh(quadruped):
    """What is smooth is carried to where it should be, and the island stays whole."""
    mesh, side = quadruped.data, attribute(quadruped.data, "sym_side")
    points = positions(mesh)
    before = (points - points.min(axis=0))[:, [1, 2]] / np.ptp(points, axis=0).max()
    _set_uvs(mesh, before)
    ops.mirror_uvs(placement="OVERLAP")
    corners, after = _corners(mesh), attribute(mesh, "UVMap")
    wanted = module("stored_map").load(mesh).mirror_values(before)[corners]
    right = side[corners] == -1
    assert np.abs(after - wanted)[right].max() < 0.02 and np.median(np.abs(after - wanted)[right]) < 1e-3


def test_only_the_selection(head):
    mesh, side = head.data, attribute(head.data, "sym_side")
    before = attribute(mesh, "UVMap")
    chosen = np.flatnonzero(side == -1)[:30]
    select(head, chosen)
    enter("EDIT")
    ops.mirror_uvs(placement="OVERLAP")
    enter("OBJECT")
    changed = _corners(mesh)[np.abs(attribute(mesh, "UVMap") - before).max(axis=1) > 1e-7]
    assert len(changed) and set(changed) <= set(chosen) | set(np.flatnonzero(side == 0))


@pytest.mark.parametrize("placement", ["BESIDE", "OVERLAP"])
def test_pinned_uvs_stay(head, placement, capfd):
    mesh, right = head.data, attribute(head.data, "sym_side") == -1
    pinned = (_eyes(head) & right)[_corners(mesh)]
    before = attribute(mesh, "UVMap")
    ops.mirror_uvs(placement=placement)
    free = attribute(mesh, "UVMap")
    module("mesh_data").update_attribute(mesh.attributes["UVMap"], before)
    module("mesh_data").write_attribute(mesh, ".pn.UVMap", "BOOLEAN", pinned, "CORNER")
    assert mesh.uv_layers.active.pin[int(pinned.argmax())].value
    assert f"{pinned.sum()} pinned UVs stay" in said(capfd, ops.mirror_uvs, placement=placement)
    assert np.array_equal(attribute(mesh, "UVMap"), np.where(pinned[:, None], before, free))
    assert not np.allclose(free[pinned], before[pinned])


def test_a_uv_map_is_needed(human):
    with pytest.raises(RuntimeError, match="no UV map"):
        ops.mirror_uvs()
