# SPDX-License-Identifier: GPL-3.0-or-later
"""Select symmetric, the symmetry line, and growing up to it."""

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, select, selected

ops = bpy.ops.intrinsic_symmetry


def _patch(object, count=200):
    """Vertices of the left side, a connected patch around the outermost one."""
    side = attribute(object.data, "sym_side")
    points = module("mesh_data").positions(object.data)
    far = int(np.argmax(np.where(side == 1, points[:, 0], -np.inf)))
    return np.argsort(np.linalg.norm(points - points[far], axis=1))[:count]


def test_vertices(human, truth, mode):
    patch = _patch(human)
    select(human, patch)
    enter(mode)
    assert ops.select() == {"FINISHED"}
    assert np.array_equal(selected(human), np.sort(truth[patch]))


def test_extend_and_both_ways(human, truth, mode):
    patch = _patch(human)
    select(human, patch)
    enter(mode)
    ops.select(extend=True)
    assert set(selected(human)) == set(patch) | set(truth[patch])
    ops.select()
    assert set(selected(human)) == set(patch) | set(truth[patch])


@pytest.mark.parametrize("element", ["edges", "polygons"])
def test_edges_and_faces(human, truth, element):
    """One edge or face of each ten, which share vertices with others that are not selected."""
    mesh = human.data
    enter("EDIT")
    bpy.ops.mesh.select_mode(type="EDGE" if element == "edges" else "FACE")
    bpy.ops.mesh.select_all(action="DESELECT")
    enter("OBJECT")
    chosen = list(range(0, len(getattr(mesh, element)), 10))
    for number in chosen:
        getattr(mesh, element)[number].select = True
    wanted = {frozenset(truth[list(getattr(mesh, element)[number].vertices)]) for number in chosen}
    enter("EDIT")
    assert ops.select() == {"FINISHED"}
    enter("OBJECT")
    found = {frozenset(e.vertices) for e in getattr(mesh, element) if e.select}
    assert found == wanted


@pytest.fixture
def unwrapped(human):
    """The human with a UV map, and without UV Sync Selection."""
    human.data.uv_layers.new(name="UVMap")
    bpy.context.tool_settings.use_uv_select_sync = False
    return human


def _select_uvs(mesh, faces):
    """Selects all UVs of some faces, as Blender stores that."""
    flags = np.zeros(len(mesh.loops), bool)
    for face in faces:
        flags[list(mesh.polygons[face].loop_indices)] = True
    corner_name, edge_name, face_name = module("ops_uv").names(mesh)
    for name in (corner_name, edge_name):
        module("mesh_data").write_attribute(mesh, name, "BOOLEAN", flags, "CORNER")
    if face_name is not None:
        chosen = np.isin(np.arange(len(mesh.polygons)), faces)
        module("mesh_data").write_attribute(mesh, face_name, "BOOLEAN", chosen, "FACE")
    return flags


def test_uvs(unwrapped, truth, mode):
    mesh = unwrapped.data
    chosen = list(range(0, len(mesh.polygons), 10))
    before = _select_uvs(mesh, chosen)
    enter(mode)
    assert ops.select_uv() == {"FINISHED"}
    enter("OBJECT")
    after = attribute(mesh, module("ops_uv").names(mesh)[0])
    wanted = {frozenset(truth[list(mesh.polygons[face].vertices)]) for face in chosen}
    found = {frozenset(face.vertices) for face in mesh.polygons if after[list(face.loop_indices)].all()}
    assert found == wanted and after.sum() == before.sum()
    assert np.array_equal(attribute(mesh, module("ops_uv").names(mesh)[1]), after)
    assert ops.select_uv(extend=True) == {"FINISHED"}
    both = attribute(mesh, module("ops_uv").names(mesh)[0])
    assert np.array_equal(both, after | before)


def test_uvs_of_an_irregular_mesh(quadruped):
    mesh = quadruped.data
    mesh.uv_layers.new(name="UVMap")
    bpy.context.tool_settings.use_uv_select_sync = False
    side = attribute(mesh, "sym_side")
    left = [face.index for face in mesh.polygons if (side[list(face.vertices)] == 1).all()]
    _select_uvs(mesh, left)
    ops.select_uv()
    found = attribute(mesh, module("ops_uv").names(mesh)[0])
    right = (side == -1)[[loop.vertex_index for loop in mesh.loops]]
    assert found[right].mean() > 0.8 and found[~right].mean() < 0.1


def test_uvs_need_a_map_and_a_selection(human):
    bpy.context.tool_settings.use_uv_select_sync = False
    with pytest.raises(RuntimeError, match="no UV map"):
        ops.select_uv()
    human.data.uv_layers.new(name="UVMap")
    with pytest.raises(RuntimeError, match="No UVs are selected"):
        ops.select_uv()
    bpy.context.tool_settings.use_uv_select_sync = True
    with pytest.raises(RuntimeError, match="UV Sync Selection is on"):
        ops.select_uv()


def test_confidence(human):
    select(human, _patch(human))
    ops.select(minimum_confidence=1.0)
    confidence = attribute(human.data, "sym_confidence")
    assert (confidence[selected(human)] >= 1.0).all()


def test_nothing_selected(human, mode):
    select(human, [])
    enter(mode)
    with pytest.raises(RuntimeError, match="Nothing is selected"):
        ops.select()
    with pytest.raises(RuntimeError, match="Nothing is selected"):
        ops.select_to_line()


def test_the_line_is_an_edge_loop_where_there_is_one(human, truth, mode):
    enter(mode)
    assert ops.select_line() == {"FINISHED"}
    enter("OBJECT")
    fixed = np.flatnonzero(truth == np.arange(len(truth)))
    assert set(selected(human)) == set(fixed)
    ends = [tuple(edge.vertices) for edge in human.data.edges if edge.select]
    uses = np.bincount(np.ravel(ends), minlength=len(truth))[fixed]
    assert (uses == 2).mean() > 0.98  # a loop: two of its edges at nearly each vertex


def test_the_line_of_an_irregular_mesh(quadruped, mode):
    enter(mode)
    assert ops.select_line() == {"FINISHED"}
    enter("OBJECT")
    found = selected(quadruped)
    assert 20 < len(found) < 400
    ends = [tuple(edge.vertices) for edge in quadruped.data.edges if edge.select]
    assert set(np.ravel(ends)) == set(found)


def test_a_line_has_no_faces(human):
    enter("EDIT")
    bpy.ops.mesh.select_mode(type="FACE")
    with pytest.raises(RuntimeError, match="no faces"):
        ops.select_line()


def test_growing_to_the_line(human, mode):
    side = attribute(human.data, "sym_side")
    select(human, _patch(human, 10))
    enter(mode)
    assert ops.select_to_line() == {"FINISHED"}
    found = selected(human)
    assert set(np.flatnonzero(side == 1)) <= set(found)
    assert (side[found] >= 0).all()
