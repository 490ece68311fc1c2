# SPDX-License-Identifier: GPL-3.0-or-later
"""Select and count what has no mirror image, and what is asymmetric."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, new_object, positions, selected

ops = bpy.ops.intrinsic_symmetry


def _said(monkeypatch, name, **settings):
    """What an operator tells the user."""
    said = []
    operator = getattr(bpy.types, f"INTRINSIC_SYMMETRY_OT_{name}")
    run = operator.run_with

    def heard(self, *arguments):
        said.append(run(self, *arguments))
        return said[-1]

    monkeypatch.setattr(operator, "run_with", heard)
    assert getattr(ops, name)(**settings) == {"FINISHED"}
    return said[0]


@pytest.fixture
def with_a_sword(human):
    """The human, and a triangle that nothing mirrors: its vertices are the last three."""
    mesh = human.data
    count = len(mesh.vertices)
    mesh.vertices.add(3)
    mesh.vertices.foreach_set("co", np.vstack([positions(mesh)[:count], np.eye(3) + 2]).astype(np.float32).ravel())
    mesh.loops.add(3)
    corners = [loop.vertex_index for loop in mesh.loops][:-3]
    mesh.loops.foreach_set("vertex_index", [*corners, count, count + 1, count + 2])
    mesh.polygons.add(1)
    mesh.polygons[-1].loop_start = len(mesh.loops) - 3
    mesh.update(calc_edges=True)
    mesh.validate()
    object = new_object(mesh.copy(), "with a sword")
    assert ops.detect() == {"FINISHED"}
    return object


def test_what_has_no_mirror_image(with_a_sword, mode, monkeypatch):
    partner = attribute(with_a_sword.data, "sym_vertex")
    count = len(partner)
    assert (partner < 0).sum() == 3
    enter(mode)
    said = _said(monkeypatch, "select_unmatched")
    assert said.startswith(f"3 of {count:,} vertices have no mirror image:")
    assert np.array_equal(selected(with_a_sword), [count - 3, count - 2, count - 1])


def test_what_is_uncertain(quadruped, monkeypatch):
    confidence = attribute(quadruped.data, "sym_confidence")
    least = float(np.median(confidence))
    said = _said(monkeypatch, "select_unmatched", least=least)
    assert set(selected(quadruped)) == set(np.flatnonzero(confidence < np.float32(least)))
    assert f"{(confidence < np.float32(least)).sum():,} an uncertain one" in said


def _push(object, chosen, far):
    points = positions(object.data)
    normals = np.array([vertex.normal for vertex in object.data.vertices])
    points[chosen] += far * normals[chosen]
    module("mesh_data").set_shown_positions(object, points)


def test_positions_at_rest(mode, monkeypatch):
    bpy.ops.mesh.primitive_monkey_add()
    head = bpy.context.object
    ops.detect()
    side = attribute(head.data, "sym_side")
    chosen = np.flatnonzero(side == 1)[:5]
    _push(head, chosen, 0.1)
    bpy.context.tool_settings.mesh_select_mode = (False, False, True)
    assert "10 of 507 vertices" in (words := _said(monkeypatch, "select_asymmetric", threshold=0.01))
    assert f"; {len(selected(head))} of these are selected" in words, "those of whole faces"
    bpy.context.tool_settings.mesh_select_mode = (True, False, False)
    enter(mode)
    assert "of these" not in _said(monkeypatch, "select_asymmetric", threshold=0.01)
    enter("OBJECT")
    partner = attribute(head.data, "sym_vertex")
    assert set(selected(head)) == set(chosen) | set(partner[chosen])


def test_positions_in_a_pose(human, truth):
    """A pose is no asymmetry; a bump is."""
    ops.symmetrize_exactly(about="POSE", direction="AVERAGE", repeat=20)
    ops.select_asymmetric(what="POSITIONS", threshold=0.003)
    before = set(selected(human))
    side, points = attribute(human.data, "sym_side"), positions(human.data)
    back = np.argmax(np.where(side == 1, points[:, 1], -np.inf))
    chosen = np.flatnonzero(np.linalg.norm(points - points[back], axis=1) < 0.02 * np.ptp(points[:, 2]))
    _push(human, chosen, 0.02 * np.ptp(points[:, 2]))
    ops.select_asymmetric(what="POSITIONS", threshold=0.003)
    after = set(selected(human)) - before
    assert len(before) < 0.3 * len(points)
    assert len(after & (set(chosen) | set(truth[chosen]))) > 0.5 * len(chosen)


def _group(object, name, weights):
    group = object.vertex_groups.new(name=name)
    for vertex in np.flatnonzero(weights).tolist():
        group.add((vertex,), float(weights[vertex]), "REPLACE")


def test_weights_are_compared_with_the_group_of_the_other_side(human, truth, monkeypatch):
    weights = np.random.default_rng(0).random(len(truth))
    spoilt = weights[truth].copy()
    spoilt[:100] += 0.3
    _group(human, "Arm.L", weights)
    _group(human, "Arm.R", np.minimum(spoilt, 1))
    _group(human, "Spine", weights + weights[truth])
    said = _said(monkeypatch, "select_asymmetric", what="WEIGHTS", threshold=0.2)
    wrong = np.flatnonzero(np.abs(np.minimum(spoilt, 1) - weights[truth]) > 0.2)
    assert set(selected(human)) == set(wrong) | set(truth[wrong])
    assert f"Arm.L: {len(wrong)}" in said and f"Arm.R: {len(wrong)}" in said and "Spine" not in said


def test_a_group_without_counterpart_differs_wholly(human, truth):
    chosen = np.arange(len(truth)) < 50
    _group(human, "Arm.L", chosen.astype(float))
    ops.select_asymmetric(what="WEIGHTS", threshold=0.5)
    assert set(selected(human)) == set(np.flatnonzero(chosen))


def test_a_shape_key_and_that_of_the_other_side(human, truth, monkeypatch):
    points, side = positions(human.data), attribute(human.data, "sym_side")
    human.shape_key_add(name="Basis")
    normals = np.array([vertex.normal for vertex in human.data.vertices])
    bump = np.where(side == 1, 0.01 * (points[:, 2] > np.median(points[:, 2])), 0)
    key = human.shape_key_add(name="Puff.L")
    module("mesh_data").set_key_positions(key, points + bump[:, None] * normals)
    human.active_shape_key_index = 1
    words = _said(monkeypatch, "select_asymmetric", what="KEY", threshold=0.002)
    assert "are moved otherwise by Puff.L than their mirror images" in words
    assert len(selected(human)) > 1.8 * (bump > 0).sum(), "with no other key both sides differ"
    ops.mirror_shape_keys()
    assert "by Puff.L than by Puff.R" in _said(monkeypatch, "select_asymmetric", what="KEY", threshold=0.002)
    assert len(selected(human)) < 0.02 * (bump > 0).sum()


@pytest.mark.parametrize("bad", ["Basis", "Puff.L", "Puff.R"])
def test_a_shape_key_with_nan_is_refused_with_the_vertex(human, bad):
    for name in ("Basis", "Puff.L", "Puff.R"):
        human.shape_key_add(name=name)
    human.data.shape_keys.key_blocks[bad].data[4].co.x = float("nan")
    human.active_shape_key_index = 1
    with pytest.raises(RuntimeError, match="Vertex 4 has NaN or infinity"):
        ops.select_asymmetric(what="KEY")


def test_what_is_needed(human):
    with pytest.raises(RuntimeError, match="no vertex groups"):
        ops.select_asymmetric(what="WEIGHTS")
    with pytest.raises(RuntimeError, match="not the basis"):
        ops.select_asymmetric(what="KEY")
