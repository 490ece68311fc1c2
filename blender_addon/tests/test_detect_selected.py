# SPDX-License-Identifier: GPL-3.0-or-later
"""Detect on all selected objects."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, new_object, positions, read_example, said

ops = bpy.ops.intrinsic_symmetry


def _select_all(active):
    for object in bpy.context.view_layer.objects:
        object.select_set(True)
    bpy.context.view_layer.objects.active = active


def _lumps():
    mesh = bpy.data.meshes.new("loose triangles")
    rng = np.random.default_rng(1)
    points = (rng.random((200, 1, 3)) + 0.05 * rng.random((200, 3, 3))).reshape(-1, 3)
    mesh.from_pydata(points.tolist(), [], np.arange(600).reshape(-1, 3).tolist())
    return new_object(mesh, "lumps")


@pytest.mark.parametrize("has_lumps", [True, False])
def test_an_object_without_a_symmetry_is_a_warning(quadruped, has_lumps, capfd):
    if has_lumps:
        _lumps()
    _select_all(quadruped)
    words = said(capfd, ops.detect_selected)
    assert ("1 without (lumps)" in words) == ("Warning: Symmetries: 1 kept" in words) == has_lumps


def test_objects_of_one_connectivity_share_one_map(mode, monkeypatch):
    first = new_object(read_example("quadruped"), "first")
    twin = new_object(first.data.copy(), "twin")  # squeezed until it has no symmetry of its own
    points = positions(twin.data)
    module("mesh_data").set_shown_positions(twin, points * np.where(points[:, :1] > 0, (1, 1, 3), (1, 3, 1)))
    lumps = _lumps()
    bpy.ops.mesh.primitive_monkey_add()
    head = bpy.context.object
    _select_all(first)
    enter(mode)
    job = module("detection").Job
    started = []
    monkeypatch.setattr(module("detection"), "Job", lambda *given: started.append(0) or job(*given))
    assert ops.detect_selected() == {"FINISHED"}
    enter("OBJECT")
    assert len(started) == 3
    assert np.array_equal(attribute(first.data, "sym_vertex"), attribute(twin.data, "sym_vertex"))
    assert "sym_vertex" in head.data.attributes and "sym_vertex" not in lumps.data.attributes
    assert module("stored_map").fixed_lines(twin.data)
    bpy.context.view_layer.objects.active = twin
    assert ops.select_line() == {"FINISHED"}, "the tools accept the map"


def test_a_map_that_is_there_is_used(quadruped, monkeypatch):
    """The twin takes the stored map of the selected object, line and all, and nothing is detected."""
    twin = new_object(read_example("quadruped"), "twin")
    side = attribute(quadruped.data, "sym_side")
    _select_all(twin)
    monkeypatch.setattr(module("detection"), "Job", None)
    assert ops.detect_selected() == {"FINISHED"}
    assert np.array_equal(attribute(twin.data, "sym_side"), side)
    lines = [module("stored_map").fixed_lines(object.data) for object in (quadruped, twin)]
    assert np.array_equal(lines[0][0].edges, lines[1][0].edges)


@pytest.mark.parametrize("type", ["FONT", None])
def test_what_is_active_need_not_be_a_mesh(quadruped, type):
    twin = new_object(read_example("quadruped"), "twin")
    text = bpy.data.objects.new("text", bpy.data.curves.new("text", type)) if type else None
    if text:
        bpy.context.scene.collection.objects.link(text)
    _select_all(text)
    assert ops.detect_selected() == {"FINISHED"}
    assert "sym_vertex" in twin.data.attributes and bpy.context.view_layer.objects.active == text
    for object in (quadruped, twin):
        object.select_set(False)
    with pytest.raises(RuntimeError, match="Needs an active mesh object"):
        ops.detect_selected()


def test_each_by_itself(quadruped, monkeypatch):
    new_object(quadruped.data.copy(), "twin")
    _select_all(quadruped)
    job, started = module("detection").Job, []
    monkeypatch.setattr(module("detection"), "Job", lambda *given: started.append(0) or job(*given))
    assert ops.detect_selected(again=True, share=False) == {"FINISHED"}
    assert len(started) == 2
