# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes whose edges are split, as importers of glTF do it: a face goes to the mirrored face, whatever vertices it has."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import attribute, edit_faces, enter, module, positions, said
from mathutils.kdtree import KDTree

ops = bpy.ops.intrinsic_symmetry


def _is_along_line(edge):
    return all(abs(vertex.co.x) < 1e-5 for vertex in edge.verts)


#: Which edges are split; the last ones are so on one side alone.
SPLITS = {
    "all": lambda edge: True,
    "all beside the line": lambda edge: not _is_along_line(edge),
    "sharp": lambda edge: edge.calc_face_angle(9) > 0.35,
    "seam": lambda edge: all(abs(vertex.co.z - 0.2) < 0.02 for vertex in edge.verts) or _is_along_line(edge),
    "left": lambda edge: all(vertex.co.x > 0.1 for vertex in edge.verts) and edge.calc_face_angle(9) > 0.35,
    "left, all": lambda edge: all(vertex.co.x > 0.1 for vertex in edge.verts),
}
ALIKE = [name for name in SPLITS if not name.startswith("left")]


@pytest.fixture(params=SPLITS)
def head(request):
    """Blender's monkey, subdivided, some edges split, with its symmetry."""
    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    data = bmesh.new()
    data.from_mesh(object.data)
    bmesh.ops.subdivide_edges(data, edges=data.edges, cuts=1, use_grid_fill=True)
    bmesh.ops.split_edges(data, edges=[edge for edge in data.edges if SPLITS[request.param](edge)])
    data.to_mesh(object.data)
    data.free()
    assert ops.detect() == {"FINISHED"}
    object.data["split"] = request.param
    return object


def _truth(mesh):
    """(faces,) the face in the mirrored place."""
    tree, middles = KDTree(len(mesh.polygons)), np.array([face.center for face in mesh.polygons])
    for face, middle in enumerate(middles):
        tree.insert(middle, face)
    tree.balance()
    found = [tree.find(middle) for middle in middles * (-1, 1, 1)]
    assert max(away for _, _, away in found) < 1e-4
    return np.array([face for _, face, _ in found]), middles[:, 0]


def _face_of_corner(mesh):
    return np.repeat(np.arange(len(mesh.polygons)), [face.loop_total for face in mesh.polygons])


def test_partners_are_mutual_and_faces_go_to_faces(head):
    partner, places = attribute(head.data, "sym_vertex"), positions(head.data)
    assert np.abs(places[partner] * (-1, 1, 1) - places).max() < 1e-5
    assert np.array_equal(module("elements").exact_face_partners(head.data, partner), _truth(head.data)[0])
    if head.data["split"] in ALIKE:
        assert np.array_equal(partner[partner], np.arange(len(partner)))
        faces = {frozenset(face.vertices) for face in head.data.polygons}
        assert all(frozenset(partner[list(face)].tolist()) in faces for face in faces)


def test_values_of_faces_and_corners_arrive(head):
    mesh, (truth, x) = head.data, _truth(head.data)
    random, corners = np.random.default_rng(0), _face_of_corner(mesh)
    number, colour = random.integers(0, 1000, len(x)), random.random((len(x), 4))
    module("mesh_data").write_attribute(mesh, "number", "INT", number, "FACE")
    module("mesh_data").write_attribute(mesh, "colour", "FLOAT_COLOR", colour[corners], "CORNER")
    for name in ("number", "colour"):
        assert ops.mirror_attribute(name=name, direction="LEFT_TO_RIGHT") == {"FINISHED"}
    right = x < -1e-4
    assert np.array_equal(attribute(mesh, "number")[right], number[truth][right])
    wrong = np.abs(attribute(mesh, "colour") - colour[truth[corners]]).max(axis=1) > 1e-3
    assert not wrong[right[corners]].any()


def test_uv_islands_arrive(head):
    """Each face is an island."""
    mesh, (truth, x) = head.data, _truth(head.data)
    corners = _face_of_corner(mesh)
    mesh.uv_layers.new(name="UVMap")
    places = positions(mesh)[[loop.vertex_index for loop in mesh.loops]]
    uvs = places[:, [0, 2]] / 3 + np.random.default_rng(0).random((len(x), 2))[corners]
    module("mesh_data").update_attribute(mesh.attributes["UVMap"], uvs)
    assert ops.mirror_uvs(direction="LEFT_TO_RIGHT", placement="OVERLAP") == {"FINISHED"}

    def middles(values):
        return np.stack([np.bincount(corners, column) / np.bincount(corners) for column in values.T], axis=1)

    away = np.abs(middles(attribute(mesh, "UVMap")) - middles(uvs)[truth]).max(axis=1)
    assert away[x < -1e-4].max() < 1e-4


def test_selected_faces_are_selected_on_the_other_side(head):
    truth, x = _truth(head.data)
    chosen = np.flatnonzero((x > 0.1) & (np.random.default_rng(0).random(len(x)) < 0.3))
    edit_faces(head, chosen)
    assert ops.select() == {"FINISHED"}
    enter("OBJECT")
    assert {face.index for face in head.data.polygons if face.select} == set(truth[chosen].tolist())


def _state(mesh):
    faces = [tuple(face.vertices) for face in mesh.polygons]
    return positions(mesh).tolist(), faces, sorted(tuple(edge.vertices) for edge in mesh.edges)


@pytest.mark.parametrize("direction", ["EDITED", "LEFT_TO_RIGHT", "RIGHT_TO_LEFT"])
def test_topology_that_is_mirrored_stays(head, capfd, direction):
    before = _state(head.data)
    for _ in range(2):
        assert "mirrored already" in said(capfd, ops.symmetrize_topology, direction=direction)
        assert _state(head.data) == before
    assert (attribute(head.data, "sym_vertex") >= 0).all()


def _places(mesh):
    """The faces by the places of their corners."""
    points = np.round(positions(mesh), 4) + 0.0
    faces = [frozenset(map(tuple, points[list(face.vertices)].tolist())) for face in mesh.polygons]
    assert len(set(faces)) == len(faces), "faces are doubled"
    return set(faces)


def test_an_edit_is_mirrored_and_the_rest_stays(head):
    """A face is pulled out on the left, where the most splits are."""
    mesh, x = head.data, _truth(head.data)[1]
    before = _places(mesh)
    edit_faces(head, [int(np.argmax(x))])
    bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0.1, 0, 0)})
    enter("OBJECT")
    edited = _places(mesh)
    enter("EDIT")
    assert ops.symmetrize_topology() == {"FINISHED"}
    enter("OBJECT")
    after = _places(mesh)
    assert len(after - before) == 2 * len(edited - before) and len(before - after) == 2 * len(before - edited)
