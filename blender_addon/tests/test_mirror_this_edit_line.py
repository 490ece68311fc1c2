# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror This Edit: what lies in the plane between left and right, and what is torn along the line."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, positions
from mathutils import Vector
from test_mirror_this_edit import MIRROR, _assert_mirrored, _away, _edit, _fatten, _middles, _nearest_faces, monkey  # noqa: F401
from test_mirror_this_edit_before import EAR, extrude_fin

ops = bpy.ops.intrinsic_symmetry


def _in_edit_mode(object, change):
    enter("EDIT")
    data = bmesh.from_edit_mesh(object.data)
    change(data, [edge for edge in data.edges if all(abs(v.co.x) < 1e-5 and v.co.y > 0.2 and v.co.z > 0 for v in edge.verts)])
    bmesh.update_edit_mesh(object.data)
    enter("OBJECT")


def _fill(data, edges):
    """A face in the plane."""
    line = sorted({vertex for edge in edges for vertex in edge.verts}, key=lambda vertex: vertex.co.z)
    data.faces.new([line[0], line[len(line) // 2], line[-1]])


def _strip(data, edges):
    """A strip in the plane that touches nothing."""
    copies = bmesh.ops.duplicate(data, geom=edges)["geom"]
    made = bmesh.ops.extrude_edge_only(data, edges=[each for each in copies if isinstance(each, bmesh.types.BMEdge)])["geom"]
    bmesh.ops.translate(data, verts=[each for each in copies if isinstance(each, bmesh.types.BMVert)], vec=(0, 0.2, 0))
    bmesh.ops.translate(data, verts=[each for each in made if isinstance(each, bmesh.types.BMVert)], vec=(0, 0.5, 0))


@pytest.mark.parametrize("also", [False, True], ids=["alone", "with an extrusion"])
@pytest.mark.parametrize("kind", ["fin", "face", "strip"])
def test_issue_38_what_an_edit_makes_in_the_plane_stays(monkey, kind, also):  # noqa: F811
    mesh, before = monkey.data, len(monkey.data.polygons)
    if kind == "fin":
        assert extrude_fin(monkey) > 1
    else:
        _in_edit_mode(monkey, {"face": _fill, "strip": _strip}[kind])
    made, count = len(mesh.polygons), 0
    assert made > before
    if also:
        _edit(monkey, _nearest_faces(mesh, EAR, 2), _fatten(0.05))
        count = len(mesh.polygons) - made
    edited = positions(mesh)
    assert ops.symmetrize_topology() == {"FINISHED"}
    assert len(mesh.polygons) == made + 2 * count
    now = positions(mesh)
    assert _away(now, now * MIRROR).max() < 1e-5 and _away(now, edited).max() < 1e-6
    assert attribute(mesh, "sym_vertex").min() >= 0
    assert len({frozenset(face.vertices) for face in mesh.polygons}) == len(mesh.polygons), "nothing is doubled"


def _borders(mesh):
    data = bmesh.new()
    data.from_mesh(mesh)
    count = sum(edge.is_boundary for edge in data.edges)
    data.free()
    return count


@pytest.mark.parametrize("also", [False, True], ids=["alone", "with an extrusion"])
def test_issue_38_a_mesh_that_is_torn_along_the_line_stays_open(monkey, also):  # noqa: F811
    """Each border is the other one's mirror image."""
    mesh, before = monkey.data, _borders(monkey.data)
    _in_edit_mode(monkey, lambda data, edges: bmesh.ops.split_edges(data, edges=edges))
    torn = _borders(mesh)
    assert torn > before
    if also:
        _edit(monkey, _nearest_faces(mesh, EAR, 2), _fatten(0.05))
    count = len(mesh.vertices)
    assert ops.symmetrize_topology() == {"FINISHED"}
    assert _borders(mesh) == torn and (len(mesh.vertices) > count) == also
    partner, side = attribute(mesh, "sym_vertex"), attribute(mesh, "sym_side")
    own = np.arange(len(partner))
    assert np.array_equal(partner[partner], own) and np.array_equal(side == 0, partner == own)


def test_issue_38_a_face_that_would_be_gone_is_refused(monkey, monkeypatch):  # noqa: F811
    """Here one of the extrusion is deleted with what the other half loses."""
    _edit(monkey, _nearest_faces(monkey.data, EAR, 2), _fatten(0.05))
    copy, faces = module("half_copy"), len(monkey.data.polygons)
    clean = copy._clean

    def lossy(bm, *rest):
        clean(bm, *rest)
        near = min(bm.faces, key=lambda face: (face.calc_center_median() - Vector(EAR)).length)
        bmesh.ops.delete(bm, geom=[near], context="FACES_ONLY")

    monkeypatch.setattr(copy, "_clean", lossy)
    with pytest.raises(RuntimeError, match="1 faces would be deleted on both sides. Nothing is changed"):
        ops.symmetrize_topology()
    assert len(monkey.data.polygons) == faces


def _smooth_monkey(levels):
    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    object.modifiers.new("Subdivision", "SUBSURF").levels = levels
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    assert ops.detect() == {"FINISHED"}
    return object


def _at_chin(object, reach, step):
    """An edit of the faces around the foremost vertex of the line: in the hollows there, what is moved along the normals
    crosses the line."""
    places, middles = positions(object.data), _middles(object.data)
    chin = places[np.argmin(np.where(np.abs(places[:, 0]) < 1e-4, places[:, 1], np.inf))]
    return _edit(object, np.flatnonzero(np.linalg.norm(middles - chin, axis=1) < reach), step)


@pytest.mark.parametrize("levels, reach, step", [
    (1, 0.27, lambda: bpy.ops.mesh.inset(thickness=0.02, depth=0.05)),
    (1, 0.4, lambda: bpy.ops.mesh.inset(thickness=0.02, depth=0.05)),
    (1, 0.15, _fatten(0.1)),
    (1, 0.6, _fatten(0.1)),
    (2, 0.27, _fatten(0.01)),
    (2, 0.27, _fatten(0.1)),
], ids=["inset", "wide inset", "extrusion", "wide extrusion", "of small faces", "deep, of small faces"])
def test_an_edit_across_the_line_that_is_mirrored_stays(levels, reach, step):
    object = _smooth_monkey(levels)
    edited = _at_chin(object, reach, step)
    _assert_mirrored(object.data)
    count = len(object.data.polygons)
    assert ops.symmetrize_topology() == {"FINISHED"}
    assert len(object.data.polygons) == count
    assert np.abs(positions(object.data) - edited).max() < 1e-6


@pytest.mark.parametrize("levels, width", [(1, 0.01), (1, 0.02), (2, 0.005)])
def test_faces_that_are_folded_over_the_line_are_cut(levels, width):
    """A bevel leaves some there, and no two of them are each other's mirror images."""
    object = _smooth_monkey(levels)
    _at_chin(object, 0.27, lambda: bpy.ops.mesh.bevel(offset=width, segments=2))
    assert ops.symmetrize_topology() == {"FINISHED"}
    mesh = object.data
    partner, places = attribute(mesh, "sym_vertex"), positions(mesh)
    faces = {frozenset(face.vertices) for face in mesh.polygons}
    assert partner.min() >= 0 and {frozenset(partner[list(face)].tolist()) for face in faces} == faces
    assert np.abs(places[partner] - places * MIRROR).max() < 1e-5
