# SPDX-License-Identifier: GPL-3.0-or-later
"""Symmetrize positions, and mirror an edit."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import (
    attribute,
    edit_faces,
    enter,
    faces_around,
    module,
    new_object,
    positions,
    read_example,
    said,
    select,
    touching_shells,
    truth_of,
)
from mathutils import Matrix

ops = bpy.ops.intrinsic_symmetry


def _dent(object, side, depth=0.005, middle=None):
    """Pushes a patch of a side in along its normals, on the back or around a vertex; (vertices, 3) displacement."""
    mesh = object.data
    points, sides = positions(mesh), attribute(mesh, "sym_side")
    if middle is None:
        middle = np.argmax(np.where(sides == side, points[:, 1], -np.inf))
    distance = np.linalg.norm(points - points[middle], axis=1) / np.ptp(points[:, 2])
    normals = np.empty(points.size, np.float32)
    mesh.vertices.foreach_get("normal", normals)
    size = np.where(sides == side, np.maximum(0.03 - distance, 0) / 0.03, 0) * depth
    return -size[:, None] * normals.reshape(-1, 3)


def _move(object, displacement):
    module("mesh_data").set_shown_positions(object, positions(object.data) + displacement)


def test_symmetrize_removes_a_dent_of_the_losing_side(human, mode):
    """The result depends on the winning side alone: with and without a dent in the other it is the same."""
    whole, dent = positions(human.data), _dent(human, -1)
    ops.symmetrize(direction="LEFT_TO_RIGHT")
    wanted = positions(human.data)
    module("mesh_data").set_shown_positions(human, whole + dent)
    select(human, [])
    enter(mode)
    assert ops.symmetrize(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    enter("OBJECT")
    left_over = np.linalg.norm(positions(human.data) - wanted, axis=1)
    deep = np.linalg.norm(dent, axis=1) > 0.002
    assert left_over[deep].mean() < 0.25 * np.linalg.norm(dent[deep], axis=1).mean()
    winning = attribute(human.data, "sym_side") == 1
    assert np.abs(positions(human.data) - whole)[winning].max() < 1e-5


def test_symmetrize_of_a_selection_leaves_no_step_at_its_border(human):
    """A dent in a calf: the rest of the leg holds the border of what is made symmetric."""
    whole, middle = positions(human.data), 11367
    losing = attribute(human.data, "sym_side")[middle]
    dent = _dent(human, losing, middle=middle)
    _move(human, dent)
    dented, size = positions(human.data), np.linalg.norm(dent, axis=1)
    inside = np.linalg.norm(whole - whole[middle], axis=1) < 0.045 * np.ptp(whole[:, 2])
    select(human, inside)
    enter("EDIT")
    assert ops.symmetrize(direction="RIGHT_TO_LEFT" if losing == 1 else "LEFT_TO_RIGHT") == {"FINISHED"}
    enter("OBJECT")
    after = positions(human.data)
    assert np.array_equal(after[~inside], dented[~inside])
    ends = module("mesh_data").edges(human.data)
    border = ends[inside[ends[:, 0]] != inside[ends[:, 1]]]
    step = np.linalg.norm((after - dented)[border[:, 0]] - (after - dented)[border[:, 1]], axis=1)
    left_over = np.linalg.norm(after - whole, axis=1)[size > 0.002].mean() / size[size > 0.002].mean()
    assert step.mean() < 0.2 * size.max() and left_over < 0.3  # cut out of a whole symmetric body: 0.9 and 1.5


def test_symmetrize_works_on_the_active_shape_key(human):
    human.shape_key_add(name="Basis")
    key = human.shape_key_add(name="Dented")
    human.active_shape_key_index = 1
    base = positions(human.data)
    dented = base + _dent(human, -1)
    module("mesh_data").set_key_positions(key, dented)
    ops.symmetrize(direction="LEFT_TO_RIGHT")
    assert np.array_equal(positions(human.data), base)
    after = module("mesh_data").key_positions(human.data.shape_keys.key_blocks["Dented"])
    right = attribute(human.data, "sym_side") == -1
    assert np.abs(after - dented)[right].max() > 0.002 and np.abs(after - dented)[~right].max() < 1e-5


def test_an_edit_is_mirrored(human, truth, mode):
    before, dent = positions(human.data), _dent(human, 1)
    enter(mode)
    assert ops.remember() == {"FINISHED"}
    enter("OBJECT")
    _move(human, dent)
    enter(mode)
    assert ops.mirror_edit() == {"FINISHED"}
    enter("OBJECT")
    moved = positions(human.data) - before
    left = attribute(human.data, "sym_side") == 1
    assert np.abs(moved - dent)[left].max() < 1e-5
    sizes = np.linalg.norm(dent, axis=1)
    assert np.abs(np.linalg.norm(moved, axis=1)[truth] - sizes)[left].max() < 0.15 * sizes.max()
    # Remembered is now the new shape: mirroring again changes nothing.
    now = positions(human.data)
    ops.mirror_edit()
    assert np.abs(positions(human.data) - now).max() < 1e-6


def test_doubled_vertices_stay_together():
    """As an importer splits them at seams; the object's origin is elsewhere, and it is turned and scaled."""
    mesh = read_example("human")
    whole, data, random = positions(mesh), bmesh.new(), np.random.default_rng(1)
    data.from_mesh(mesh)
    bmesh.ops.split_edges(data, edges=[edge for edge in data.edges if random.random() < 0.15])
    data.to_mesh(mesh)
    data.free()
    object, points = new_object(mesh), positions(mesh)
    number = {tuple(point): number for number, point in enumerate(whole)}
    of = np.array([number[tuple(point)] for point in points])
    assert len(of) > len(whole) + 1000
    mesh.transform(Matrix.Translation((5, -7, 2)))
    object.matrix_world = Matrix.Translation((100, 20, 3)) @ Matrix.Rotation(1, 4, (1, 2, 3)) @ Matrix.Scale(3, 4)
    assert ops.detect() == {"FINISHED"}
    assert np.array_equal(of[attribute(mesh, "sym_vertex")], truth_of("human")[of])
    ops.remember()
    before = positions(mesh)
    near = np.maximum(1 - np.linalg.norm(points - whole[whole[:, 0].argmax()], axis=1) / 0.3, 0)
    module("mesh_data").set_shown_positions(object, before + 0.05 * near[:, None])
    for tool in (ops.mirror_edit, ops.symmetrize):
        assert tool() == {"FINISHED"}
        after = positions(mesh)
        assert (np.abs(after - before).max(axis=1) > 1e-3).sum() > 1000
        assert np.abs(after - after[np.unique(of, return_index=True)[1]][of]).max() < 1e-5


@pytest.mark.parametrize("apart", [0, 3e-7])
@pytest.mark.parametrize("tool", ["mirror_edit", "mirror_shape_keys"])
def test_shells_that_touch_do_so_afterwards(truth, tool, apart):
    """Each has local frames of its own. Rounding may keep them apart."""
    object, ((left, its), (right, other)) = touching_shells(truth, apart)
    before = positions(object.data)
    gap = np.abs(before[[left, right]] - before[[its, other]])
    assert (gap.max() > 0) == (apart > 0) and gap.max() < 1e-6 and ops.detect() == {"FINISHED"}
    assert attribute(object.data, "sym_vertex")[[left, its]].tolist() == [right, other]
    edit = np.maximum(1 - np.linalg.norm(before - before[left], axis=1) / 0.2, 0)[:, None] * (0.1, 0.05, 0)
    ops.remember()
    if tool == "mirror_shape_keys":
        object.shape_key_add(name="Basis")
        key = object.shape_key_add(name="Puff.L")
        object.active_shape_key_index = 1
        module("mesh_data").set_key_positions(key, before + edit)
        ops.mirror_shape_keys()
        after = module("mesh_data").key_positions(object.data.shape_keys.key_blocks["Puff.R"])
    else:
        module("mesh_data").set_shown_positions(object, before + edit)
        ops.mirror_edit()
        after = positions(object.data)
    assert np.linalg.norm(after[right] - before[right]) > 0.05 and np.abs(after[right] - after[other]).max() < 1e-6
    if tool == "mirror_edit":  # what is torn apart on one side is so on the other
        edit[its] = 0
        ops.remember()
        now = positions(object.data)
        module("mesh_data").set_shown_positions(object, now + edit)
        ops.mirror_edit()
        gap = positions(object.data)
        assert np.linalg.norm(gap[right] - gap[other]) > 0.05


def test_an_edit_of_uncertain_vertices_is_not_carried(quadruped):
    """Above every confidence there is nothing to change; softly, less arrives than wholly."""
    before, dent = positions(quadruped.data), _dent(quadruped, 1)
    right = attribute(quadruped.data, "sym_side") == -1
    arrived = []
    for settings in ({}, {"soft": True}, {"minimum_confidence": 1.0}):
        module("mesh_data").set_shown_positions(quadruped, before)
        ops.remember()
        _move(quadruped, dent)
        ops.mirror_edit(direction="LEFT_TO_RIGHT", **settings)
        arrived.append(np.abs(positions(quadruped.data) - before)[right].sum())
    assert arrived[0] > arrived[1] > arrived[2]


def test_a_whole_edit_mode_session(human, truth):
    """Remember, move selected vertices with Blender's own operator, mirror: all without leaving edit mode."""
    side = attribute(human.data, "sym_side")
    left = np.flatnonzero(side == 1)[:30]
    select(human, left)
    enter("EDIT")
    ops.remember()
    bpy.ops.transform.translate(value=(0, 0, 0.01))
    assert ops.mirror_edit(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    enter("OBJECT")
    before = attribute(human.data, "sym_remembered")
    assert np.allclose(before, positions(human.data), atol=1e-5)


def test_nothing_remembered(human, mode):
    enter(mode)
    with pytest.raises(RuntimeError, match="Remember Shape first"):
        ops.mirror_edit()


def test_an_edit_since_edit_mode_was_entered(human):
    """Nothing was remembered: the shape with which edit mode was entered is. Then the mirrored one is."""
    side, before = attribute(human.data, "sym_side"), positions(human.data)
    left = np.flatnonzero(side == 1)[:30]
    select(human, left)
    enter("EDIT")
    for moved in (1, 2):
        bpy.ops.transform.translate(value=(0, 0, 0.01))
        assert ops.mirror_edit() == {"FINISHED"}
        enter("OBJECT")
        far = np.linalg.norm(positions(human.data) - before, axis=1)
        assert np.abs(far[left] - 0.01 * moved).max() < 1e-5
        assert far[side == -1].sum() > 0.9 * far[left].sum()
        enter("EDIT")


def test_a_half_turn_has_no_sides(human):
    human.data["intrinsic_symmetry"]["kind"] = 1
    with pytest.raises(RuntimeError, match="(?i)half turn"):
        ops.symmetrize(direction="LEFT_TO_RIGHT")


def test_what_edit_mode_began_with_outlives_our_operators_and_a_save(human, tmp_path):
    """All that was moved since edit mode was entered is mirrored, until the user leaves it."""
    side, before = attribute(human.data, "sym_side"), positions(human.data)
    left = np.flatnonzero(side == 1)[:30]
    select(human, left)
    enter("EDIT")
    for moved, between in enumerate((lambda: bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"), copy=True),
                                     lambda: ops.select(extend=True))):
        bpy.ops.transform.translate(value=(0, 0, 0.01))
        between()
    assert ops.mirror_edit(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    enter("OBJECT")
    far = np.linalg.norm(positions(human.data) - before, axis=1)
    assert np.abs(far[left] - 0.02).max() < 1e-5 and far[side == -1].sum() > 0.9 * far[left].sum()
    enter("EDIT")
    with pytest.raises(RuntimeError, match="Nothing is remembered or edited"):
        ops.mirror_edit()


def test_an_undone_mirror_edit_can_be_done_again(human):
    side, before = attribute(human.data, "sym_side"), positions(human.data)
    select(human, np.flatnonzero(side == 1)[:30])
    enter("EDIT")
    bpy.ops.ed.undo_push(message="entered")
    bpy.ops.transform.translate(value=(0, 0, 0.01))
    bpy.ops.ed.undo_push(message="moved")
    ops.mirror_edit()
    bpy.ops.ed.undo_push(message="mirrored")
    bpy.ops.ed.undo()
    human = bpy.context.object
    ops.mirror_edit()
    enter("OBJECT")
    far = np.linalg.norm(positions(human.data) - before, axis=1)
    assert far[side == 1].sum() > 0.29 and far[side == -1].sum() > 0.9 * far[side == 1].sum()


def test_edits_of_both_sides_are_said(human, truth, capfd):
    """Where both sides were edited the farther edit wins; the message says on how many vertices, and which."""
    left, before = np.flatnonzero(attribute(human.data, "sym_side") == 1)[:30], positions(human.data)
    ops.remember()
    edit = np.zeros_like(before)
    edit[left, 2] = 0.01
    edit[truth[left[:10]], 2] = -0.02
    _move(human, edit)
    assert "the left one on 0 vertices, the right one on 10" in said(capfd, ops.mirror_edit)
    assert "Both sides" not in said(capfd, ops.mirror_edit)


@pytest.mark.parametrize("tool", ["symmetrize", "symmetrize_exactly", "remember"])
def test_detail_of_multires_is_said_to_stay(human, tool, capfd):
    modifier = human.modifiers.new("Detail", "MULTIRES")
    assert "Multires" not in said(capfd, getattr(ops, tool))
    bpy.ops.object.multires_subdivide(modifier="Detail")
    assert modifier.total_levels == 1 and 'Multires detail of "human"' in said(capfd, getattr(ops, tool))


@pytest.mark.parametrize("edit", [bpy.ops.mesh.extrude_region_move, bpy.ops.mesh.subdivide])
def test_an_edit_that_adds_vertices_is_said_to_be_another_tool_s(human, edit):
    near, _ = faces_around(human.data, int(positions(human.data)[:, 0].argmax()), slice(0, 8))
    edit_faces(human, near)
    bpy.ops.transform.translate(value=(0, 0, 0.03))
    edit()
    with pytest.raises(RuntimeError, match="Vertices were added or removed in edit mode: Mirror This Edit"):
        ops.mirror_edit()
    bpy.ops.transform.translate(value=(0, 0, 0.01))
    assert ops.mirror_edit() == {"FINISHED"}, "what is moved after that is mirrored"


@pytest.mark.parametrize("tool", ["symmetrize_exactly", "select_asymmetric"])
def test_a_key_with_nan_is_refused_with_the_vertex(human, tool):
    human.shape_key_add(name="Basis")
    human.shape_key_add(name="bad").data[5].co.x = float("nan")
    human.active_shape_key_index = 1
    with pytest.raises(RuntimeError, match="Vertex 5 has NaN or infinity"):
        getattr(bpy.ops.intrinsic_symmetry, tool)()
