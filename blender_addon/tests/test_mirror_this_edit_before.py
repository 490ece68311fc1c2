# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror This Edit: what differed between left and right before the edit is no part of it."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import attribute, faces_around, module, positions, said, select
from mathutils import Vector
from test_mirror_this_edit import MIRROR, _away, _edit, _fatten, _middles, _nearest_faces

ops = bpy.ops.intrinsic_symmetry
CHEEK, EAR = np.array((0.5, -0.6, 0.4)), (0.9, 0.2, 0.2)


def extrude_fin(object, back=0.3):
    """Extrudes edges of the line away from the back of the head, in the plane; in object mode."""
    data = bmesh.new()
    data.from_mesh(object.data)
    edges = [edge for edge in data.edges if all(abs(v.co.x) < 1e-5 and v.co.y > 0.2 and v.co.z > 0 for v in edge.verts)]
    made = bmesh.ops.extrude_edge_only(data, edges=edges)["geom"]
    bmesh.ops.translate(data, verts=[each for each in made if isinstance(each, bmesh.types.BMVert)], vec=(0, back, 0))
    data.to_mesh(object.data)
    data.free()
    return len(edges)


def _detail(kind, sign):
    """Blender's monkey with a detail, then with its symmetry."""
    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    steps = {"pocket": [_fatten(-0.05)], "hole": [lambda: bpy.ops.mesh.delete(type="FACE")]}
    side = np.sign(_middles(object.data)[:, 0]) == sign
    if kind == "fin":
        extrude_fin(object)
    else:
        _edit(object, _nearest_faces(object.data, CHEEK * (sign, 1, 1), 1 if kind == "hole" else 2, side), *steps[kind])
    assert ops.detect() == {"FINISHED"}
    return object


def _edit_vertices(object, vertices, step):
    select(object, vertices)
    bpy.ops.object.mode_set(mode="EDIT")
    step()
    bpy.ops.object.mode_set(mode="OBJECT")


@pytest.mark.parametrize("kind, sign", [("pocket", 1), ("pocket", -1), ("hole", 1), ("hole", -1), ("fin", 0)])
def test_issue_38_what_differed_before_the_edit_stays_on_both_sides(kind, sign):
    """Also when another edit is mirrored after the first; images that are no vertices are kept until then."""
    object = _detail(kind, sign)
    mesh, had = object.data, np.count_nonzero(attribute(object.data, "sym_vertex") >= 0)
    for place in (EAR, (0.2, -0.5, -0.8)):
        before, count = _middles(mesh), len(mesh.polygons)
        edited = _edit(object, _nearest_faces(mesh, place, 2), _fatten(0.05))
        added = len(mesh.polygons) - count
        assert ops.symmetrize_topology() == {"FINISHED"}
        assert len(mesh.polygons) == count + 2 * added and added > 0
        assert np.count_nonzero(_away(_middles(mesh), before) > 1e-5) == 4, "only what was extruded, and its image, is gone"
        assert _away(positions(mesh), edited).max() < 1e-6
        assert np.count_nonzero(attribute(mesh, "sym_vertex") >= 0) >= had


def test_a_second_time_there_is_nothing_to_do(capfd):
    """The pocket is not taken for an edit, nor its side for the one that was edited last."""
    object = _detail("pocket", 1)
    _edit(object, _nearest_faces(object.data, EAR * np.array((-1, 1, 1)), 2, _middles(object.data)[:, 0] < 0), _fatten(0.05))
    assert "Right to left" in said(capfd, ops.symmetrize_topology)
    before = positions(object.data)
    assert "nothing to do" in said(capfd, ops.symmetrize_topology)
    assert np.array_equal(positions(object.data), before)
    _edit(object, _nearest_faces(object.data, EAR, 1), bpy.ops.mesh.poke)
    assert "Left to right: 1 vertices are copies" in said(capfd, ops.symmetrize_topology)


def test_a_vertex_that_is_its_own_partner_beside_the_line_does_not_move():
    """In a middle that is bent and has other faces left than right, the line between the halves need not go through it."""
    bpy.ops.mesh.primitive_monkey_add()
    object, mesh = bpy.context.object, bpy.context.object.data
    bpy.ops.object.modifier_add(type="SUBSURF")
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    data = bmesh.new()
    data.from_mesh(mesh)
    away = {vertex: (vertex.co - Vector((0, -0.8, 0.4))).length / 0.3 for vertex in data.verts}
    near = [vertex for vertex in data.verts if away[vertex] < 1]
    for vertex in near:
        vertex.co.x += 0.1 * (1 - away[vertex])
    bmesh.ops.dissolve_verts(data, verts=near[::3])
    data.to_mesh(mesh)
    data.free()
    assert ops.detect() == {"FINISHED"}
    before = positions(mesh)
    _edit(object, _nearest_faces(mesh, EAR, 1), bpy.ops.mesh.poke)
    assert ops.symmetrize_topology() == {"FINISHED"}
    assert _away(positions(mesh), before).max() < 1e-6


def test_issue_38_with_a_direction_the_whole_half_is_replaced():
    object = _detail("pocket", -1)
    _edit(object, _nearest_faces(object.data, EAR, 2), _fatten(0.05))
    assert ops.symmetrize_topology(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    now = positions(object.data)
    assert _away(now, now * MIRROR).max() < 1e-2 and (attribute(object.data, "sym_confidence") == 1).all()


def test_issue_38_an_edit_in_a_detail_takes_the_whole_detail_along():
    """Nothing would hold the copies of what is made inside it."""
    object = _detail("pocket", 1)
    inside = _nearest_faces(object.data, CHEEK, 2)
    _edit(object, inside, lambda: bpy.ops.mesh.inset(thickness=0.02), _fatten(0.03))
    assert ops.symmetrize_topology() == {"FINISHED"}
    now = positions(object.data)
    assert _away(now, now * MIRROR).max() < 1e-5
    middles = _middles(object.data)
    assert _away(middles, middles * MIRROR).max() < 1e-5


def test_issue_38_a_hand_that_is_missing_is_not_in_the_way(human, truth):
    """Since before Detect: the vertices of the other hand have neither image nor side."""
    mesh, side, places = human.data, attribute(human.data, "sym_side"), positions(human.data)
    tip = int(np.argmax(np.where(side == 1, places[:, 0], -np.inf)))
    hand = np.linalg.norm(places - places[tip], axis=1) < 0.1 * np.ptp(places, axis=0).max()
    _edit_vertices(human, truth[hand], lambda: bpy.ops.mesh.delete(type="VERT"))
    ops.clear()
    assert ops.detect() == {"FINISHED"}
    lone = (attribute(mesh, "sym_vertex") < 0) & (attribute(mesh, "sym_side") == 0)
    assert np.count_nonzero(lone) > 50
    faces, count = len(mesh.polygons), len(mesh.vertices)
    foot = int(np.argmin(np.where(attribute(mesh, "sym_side") == 1, positions(mesh)[:, 2], np.inf)))
    _edit(human, faces_around(mesh, foot, slice(0, 4))[0], _fatten(0.01))
    added = len(mesh.vertices) - count
    assert ops.symmetrize_topology() == {"FINISHED"}
    assert len(mesh.vertices) == count + 2 * added and len(mesh.polygons) > faces


def test_issue_38_faces_that_are_turned_over_are_not_blamed_on_an_edit():
    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    for face in list(object.data.polygons)[::3]:
        face.flip()
    assert ops.detect() == {"FINISHED"}
    with pytest.raises(RuntimeError, match="cannot go through the faces. Nothing is changed. Are some of them turned over"):
        ops.symmetrize_topology()


def test_issue_38_a_pair_whose_neighbours_have_none_is_a_chance(human):
    """It is no twin: what is copied would be joined to a wrong vertex."""
    chance, partner = module("half_pairs")._chance, attribute(human.data, "sym_vertex").astype(np.int64)
    vertex = int(np.argmax(positions(human.data)[:, 0]))
    exact = np.ones(len(partner), bool)
    assert partner[vertex] != vertex and not chance(human.data, exact, partner).any()
    ends = np.array([edge.vertices[:] for edge in human.data.edges])
    around = np.setdiff1d(ends[(ends == vertex).any(axis=1)], vertex)
    exact[around] = False
    assert chance(human.data, exact, partner)[[vertex, partner[vertex]]].all()
