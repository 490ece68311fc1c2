# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror This Edit: the other side gets the mirror image of the edit, and all that was not edited stays as it was."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import attribute, edit_faces, enter, module, new_object, positions, said
from mathutils.kdtree import KDTree

ops = bpy.ops.intrinsic_symmetry
MIRROR = np.array((-1, 1, 1))


@pytest.fixture
def monkey():
    """Blender's monkey, at rest, with its symmetry."""
    bpy.ops.mesh.primitive_monkey_add()
    assert ops.detect() == {"FINISHED"}
    return bpy.context.object


def _found(places, wanted):
    """(wanted, 2) the nearest of the places, by its number, and how far it is."""
    tree = KDTree(len(places))
    for number, place in enumerate(places):
        tree.insert(place, number)
    tree.balance()
    return np.array([tree.find(place)[1:] for place in wanted]).reshape(-1, 2)


def _away(places, wanted):
    return _found(places, wanted)[:, 1]


def _nearest(places, wanted):
    return _found(places, wanted)[:, 0].astype(int)


def _middles(mesh):
    return np.array([face.center for face in mesh.polygons])


def _at_line(mesh):
    """(faces,) bool: those on the left that end on the line."""
    ends = np.array([min(abs(mesh.vertices[vertex].co.x) for vertex in face.vertices) < 1e-5 for face in mesh.polygons])
    return ends & (_middles(mesh)[:, 0] > 0)


def _nearest_faces(mesh, place, count, of=None):
    """Numbers of the faces nearest to a place, of the left side or `of`, (faces,) bool."""
    middles = _middles(mesh)
    chosen = middles[:, 0] > 0.02 if of is None else of
    return np.argsort(np.where(chosen, np.linalg.norm(middles - place, axis=1), np.inf))[:count]


def _edit(object, faces, *steps):
    edit_faces(object, faces)
    for step in steps:
        step()
    enter("OBJECT")
    return positions(object.data)


def _grab(*way):
    return lambda: bpy.ops.transform.translate(value=way)


def _fatten(depth):
    return lambda: bpy.ops.mesh.extrude_region_shrink_fatten(TRANSFORM_OT_shrink_fatten={"value": depth})


def _extrude(*way):
    return lambda: bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": way})


def _assert_mirrored(mesh):
    """The mesh is its own mirror image, faces and places."""
    now = positions(mesh)
    assert _away(now, now * MIRROR).max() < 1e-5
    middles = _middles(mesh)
    assert _away(middles, middles * MIRROR).max() < 1e-5


@pytest.mark.parametrize("count", [9, 20, 40])
@pytest.mark.parametrize("place", [(0.44, -0.65, 0.45), (0.9, 0.2, 0.2)])
def test_issue_38_faces_split_off_and_moved_arrive_exactly(monkey, place, count):
    faces = len(monkey.data.polygons)
    edited = _edit(monkey, _nearest_faces(monkey.data, place, count), bpy.ops.mesh.split, _grab(0.05, 0.02, 0.1))
    assert ops.symmetrize_topology() == {"FINISHED"}
    _assert_mirrored(monkey.data)
    assert len(monkey.data.polygons) == faces
    assert _away(positions(monkey.data), edited[edited[:, 0] > 1e-4]).max() < 1e-6


def test_issue_38_faces_split_off_and_moved_keep_their_form_in_a_pose(human):
    mesh, side = human.data, attribute(human.data, "sym_side")
    left = np.array([(side[list(face.vertices)] == 1).all() for face in mesh.polygons])
    arm = _nearest_faces(mesh, _middles(mesh)[np.flatnonzero(left)[2000]], 30, left)
    before, count = positions(mesh), len(mesh.vertices)
    edited = _edit(human, arm, bpy.ops.mesh.split, _grab(0.03, 0, 0.03))
    added = len(mesh.vertices) - count
    assert ops.symmetrize_topology() == {"FINISHED"}
    now, partner = positions(mesh), attribute(mesh, "sym_vertex")
    assert len(mesh.vertices) == count + 2 * added and partner.min() >= 0
    piece = np.flatnonzero(_away(before, now) > 1e-5)
    own = piece[_away(edited, now[piece]) < 1e-6]
    assert len(own) == len(piece) / 2
    between = [np.linalg.norm(now[each][:, None] - now[each], axis=2) for each in (own, partner[own])]
    size = between[0].max()
    assert np.abs(between[0] - between[1]).max() < 0.05 * size, "its form"
    moved = np.linalg.norm(now[partner[own]] - before[_nearest(before, now[partner[own]])], axis=1)
    assert moved.min() > 1e-3


@pytest.mark.parametrize("count", [1, 2])
def test_issue_38_a_split_beside_the_line_deletes_nothing(monkey, count):
    base = monkey.data
    at_line = np.flatnonzero(_at_line(base))
    for face in at_line[::4]:
        object = new_object(base.copy())
        _edit(object, _nearest_faces(base, _middles(base)[face], count, _at_line(base)), bpy.ops.mesh.split)
        assert ops.symmetrize_topology() == {"FINISHED"}
        assert len(object.data.polygons) == len(base.polygons)
        _assert_mirrored(object.data)
        assert attribute(object.data, "sym_vertex").min() >= 0


@pytest.mark.parametrize("times", [1, 2])
@pytest.mark.parametrize("way", [(0.06, -0.05, 0), (-0.06, -0.05, 0)], ids=["off it", "over it"])
def test_issue_38_an_extrusion_at_the_line_that_is_moved_off_it_loses_nothing(monkey, way, times):
    middles = _middles(monkey.data)
    faces = np.flatnonzero(_at_line(monkey.data) & (middles[:, 1] < -0.2) & (middles[:, 2] > 0.2) & (middles[:, 2] < 0.6))
    edited = _edit(monkey, faces, *[_extrude(*way)] * times)
    assert ops.symmetrize_topology() == {"FINISHED"}
    _assert_mirrored(monkey.data)
    now = positions(monkey.data)
    assert _away(now, edited).max() < 1e-6, "all vertices of the edit are there"
    assert _away(now, edited * MIRROR).max() < 1e-5


def _pull_wide(object, place, radius, way):
    """Moves what is on the left around a place, as proportional editing does, in edit mode."""
    data = bmesh.from_edit_mesh(object.data)
    for vertex in data.verts:
        away = np.linalg.norm(np.array(vertex.co) - place)
        if vertex.co.x > 1e-3 and away < radius:
            vertex.co += type(vertex.co)(way) * (1 - away / radius)
    bmesh.update_edit_mesh(object.data)


def _extrude_and_pull(object, order):
    edit_faces(object, _nearest_faces(object.data, (0.8, -0.3, 0.3), 4))
    for step in order:
        _fatten(0.1)() if step == "extrude" else _pull_wide(object, (0.8, -0.3, 0.3), 0.5, (0.02, 0, 0.12))


@pytest.mark.parametrize("order", [("pull", "extrude"), ("extrude", "pull")])
def test_issue_38_what_was_moved_beside_an_extrusion_is_carried(monkey, mode, order):
    before = positions(monkey.data)
    _extrude_and_pull(monkey, order)
    enter("OBJECT")
    edited = positions(monkey.data)
    assert np.count_nonzero(_away(before, edited) > 1e-3) > 20
    enter(mode)
    assert ops.symmetrize_topology() == {"FINISHED"}
    enter("OBJECT")
    _assert_mirrored(monkey.data)
    assert _away(positions(monkey.data), edited[edited[:, 0] > -1e-4]).max() < 1e-6


def test_it_says_how_many_vertices_were_moved_and_how_far(monkey, capfd):
    edit_faces(monkey, _nearest_faces(monkey.data, (0.8, -0.3, 0.3), 1))
    bpy.ops.mesh.poke()
    _pull_wide(monkey, np.array(monkey.data.vertices[0].co), 1e-3, (0.02, 0, 0.1))  # this one alone
    enter("OBJECT")
    size = np.ptp(positions(monkey.data), axis=0).max()
    words = said(capfd, ops.symmetrize_topology)
    assert f", 1 were moved by up to {np.hypot(0.02, 0.1) / size:.2%} of the object's size;" in words


def test_issue_38_what_was_split_off_and_moved_with_what_is_around_it_is_carried(monkey):
    edit_faces(monkey, _nearest_faces(monkey.data, (0.8, -0.3, 0.3), 4))
    bpy.ops.mesh.split()
    _pull_wide(monkey, (0.8, -0.3, 0.3), 0.5, (0.02, 0, 0.12))
    enter("OBJECT")
    assert ops.symmetrize_topology() == {"FINISHED"}
    _assert_mirrored(monkey.data)


def test_issue_38_what_was_moved_is_carried_after_an_update_too(monkey):
    _extrude_and_pull(monkey, ("pull", "extrude"))
    ops.carry()
    _pull_wide(monkey, (0.5, -0.5, -0.3), 0.3, (0, -0.1, 0))
    enter("OBJECT")
    assert ops.symmetrize_topology() == {"FINISHED"}
    _assert_mirrored(monkey.data)


def test_issue_38_the_remembered_shape_stays(monkey, capfd):
    """Mirror Edit has nothing to do afterwards, and mirrors what is moved then."""
    ops.remember()
    _extrude_and_pull(monkey, ("pull", "extrude"))
    enter("OBJECT")
    assert ops.symmetrize_topology() == {"FINISHED"}
    assert "0 vertices moved" in said(capfd, ops.mirror_edit)
    enter("EDIT")
    _pull_wide(monkey, (0.5, -0.5, -0.3), 0.3, (0, -0.1, 0))
    enter("OBJECT")
    assert ops.mirror_edit() == {"FINISHED"}
    now = positions(monkey.data)
    assert _away(now, now * MIRROR).max() < 2e-3


def test_issue_38_a_pose_that_was_made_before_edit_mode_is_not_mirrored(monkey):
    """The left ear is turned up in object mode; then the left cheek is extruded."""
    places = positions(monkey.data)
    ear = places[:, 0] > 0.9
    places[ear] += (0, 0, 0.3)
    monkey.data.vertices.foreach_set("co", places.astype(np.float32).ravel())
    monkey.data.update()
    _edit(monkey, _nearest_faces(monkey.data, (0.3, -0.7, -0.3), 4), _fatten(0.05))
    assert np.count_nonzero(ear) > 20
    assert ops.symmetrize_topology() == {"FINISHED"}
    assert _away(positions(monkey.data), places).max() < 1e-6


def test_issue_38_a_pose_between_two_visits_of_edit_mode_is_not_mirrored(monkey):
    """What was moved in edit mode is."""
    enter("EDIT")
    _pull_wide(monkey, (0.5, -0.5, -0.3), 0.3, (0, -0.1, 0))
    enter("OBJECT")
    places = positions(monkey.data)
    places[places[:, 0] > 0.9] += (0, 0, 0.3)
    monkey.data.vertices.foreach_set("co", places.astype(np.float32).ravel())
    monkey.data.update()
    edited = _edit(monkey, _nearest_faces(monkey.data, (0.3, -0.7, -0.3), 4), _fatten(0.05))
    assert ops.symmetrize_topology() == {"FINISHED"}
    now, ear = positions(monkey.data), edited[:, 0] > 0.9
    assert _away(now, edited[edited[:, 0] > 1e-4]).max() < 1e-6
    assert _away(now, edited[(edited[:, 0] > 1e-4) & ~ear] * MIRROR).max() < 1e-5
    assert _away(now, edited[ear] * MIRROR).max() > 0.2 and _away(now, edited[edited[:, 0] < -0.9]).max() < 1e-6


@pytest.mark.parametrize("steps", [[_fatten(0.1)], [bpy.ops.mesh.split, _grab(-0.05, 0.02, 0.1)]], ids=["extrude", "split, move"])
def test_issue_38_an_edit_of_the_losing_side_is_taken_back(monkey, steps, capfd):
    before = positions(monkey.data)
    right = _nearest_faces(monkey.data, (-0.5, -0.6, 0.4), 20, _middles(monkey.data)[:, 0] < -0.02)
    _edit(monkey, right, *steps)
    assert "is replaced" in said(capfd, ops.symmetrize_topology, direction="LEFT_TO_RIGHT")
    _assert_mirrored(monkey.data)
    assert len(monkey.data.vertices) == len(before) and _away(positions(monkey.data), before).max() < 1e-5


def _decorate(mesh):
    """Materials, seams, sharp edges, creases, face values and UVs that differ between left and right."""
    for name in ("skin", "cloth", "hair"):
        mesh.materials.append(bpy.data.materials.new(name))
    middles, random = _middles(mesh), np.random.default_rng(1)
    mesh.polygons.foreach_set("material_index", np.where(middles[:, 0] > 0, 0, 1 + (middles[:, 2] > 0)).astype(np.int32))
    right = np.array([positions(mesh)[list(edge.vertices)].mean(axis=0)[0] < -0.01 for edge in mesh.edges])
    mesh.edges.foreach_set("use_seam", right & (random.random(len(right)) < 0.3))
    mesh.edges.foreach_set("use_edge_sharp", right & (random.random(len(right)) < 0.3))
    write = module("mesh_data").write_attribute
    write(mesh, "crease_edge", "FLOAT", 0.5 * right, "EDGE")
    write(mesh, "value", "FLOAT", random.random(len(middles)), "FACE")
    mesh.uv_layers.new(name="UV")
    write(mesh, "UV", "FLOAT2", random.random((len(mesh.loops), 2)), "CORNER")


def _belongings(mesh, chosen):
    """{middle of a face: what belongs to it, its edges and corners}, of the chosen faces, (faces,) bool."""
    crease, value, uv = (attribute(mesh, name) for name in ("crease_edge", "value", "UV"))
    edge_of = attribute(mesh, ".corner_edge")
    found = {}
    for face in np.array(mesh.polygons)[chosen]:
        loops = list(face.loop_indices)
        own = [mesh.edges[at] for at in edge_of[loops]]
        edges = sorted((edge.use_seam, edge.use_edge_sharp, float(crease[edge.index])) for edge in own)
        uvs = sorted(map(tuple, uv[loops].tolist()))
        found[tuple(np.round(face.center, 4))] = (face.material_index, float(value[face.index]), edges, uvs)
    return found


OWN = {
    "extrude": [_fatten(0.06)],
    "inset": [lambda: bpy.ops.mesh.inset(thickness=0.01)],
    "delete": [lambda: bpy.ops.mesh.delete(type="FACE")],
    "split": [bpy.ops.mesh.split],
    "flip": [bpy.ops.mesh.flip_normals],
}


@pytest.mark.parametrize("steps", OWN)
def test_issue_38_the_other_side_keeps_what_belongs_to_its_faces(monkey, steps):
    mesh = monkey.data
    _decorate(mesh)
    faces = _nearest_faces(mesh, (0.5, -0.6, 0.4), 4)
    away = _away(_middles(mesh)[faces] * MIRROR, _middles(mesh))
    kept = (_middles(mesh)[:, 0] < 0) & (away > 1e-5 if steps in ("extrude", "inset", "delete") else True)
    before = _belongings(mesh, kept)
    assert len(before) > 240
    _edit(monkey, faces, *OWN[steps])
    assert ops.symmetrize_topology() == {"FINISHED"}
    now = _belongings(mesh, np.ones(len(mesh.polygons), bool))
    assert {middle: now.get(middle) for middle in before} == before


def test_issue_38_flags_that_only_the_replaced_faces_have_stay(monkey):
    """Blender drops a layer of flags when nothing has any."""
    mesh = monkey.data
    faces = _nearest_faces(mesh, (0.5, -0.6, 0.4), 4)
    images = [int(_nearest(_middles(mesh), [place])[0]) for place in _middles(mesh)[faces] * MIRROR]
    others = [key for face in images[1:] for key in mesh.polygons[face].edge_keys]
    inner = next(key for key in mesh.polygons[images[0]].edge_keys if key in others)
    next(edge for edge in mesh.edges if edge.key == inner).use_seam = True
    mesh.materials.append(bpy.data.materials.new("skin"))
    mesh.materials.append(bpy.data.materials.new("cloth"))
    for face in images:
        mesh.polygons[face].material_index = 1
    _edit(monkey, faces, bpy.ops.mesh.split)
    assert ops.symmetrize_topology() == {"FINISHED"}
    assert sum(edge.use_seam for edge in mesh.edges) == 1
    cloth = [face.center.x for face in mesh.polygons if face.material_index == 1]
    assert len(cloth) == 4 and max(cloth) < 0


def test_issue_38_without_an_edit_nothing_is_overwritten(monkey, capfd):
    _decorate(monkey.data)
    everything = np.ones(len(monkey.data.polygons), bool)
    before = _belongings(monkey.data, everything)
    assert "nothing to do" in said(capfd, ops.symmetrize_topology)
    assert _belongings(monkey.data, everything) == before


def test_issue_38_faces_turned_over_at_the_line_stay_in_place(monkey):
    before, faces = positions(monkey.data), len(monkey.data.polygons)
    chosen = _nearest_faces(monkey.data, (0.1, -0.7, 0.3), 20, _middles(monkey.data)[:, 0] > 0)
    own = [monkey.data.polygons[face] for face in chosen]
    middles, normals = np.array([face.center for face in own]), np.array([face.normal for face in own])
    assert _at_line(monkey.data)[chosen].any()
    _edit(monkey, chosen, bpy.ops.mesh.flip_normals)
    assert ops.symmetrize_topology() == {"FINISHED"}
    assert len(monkey.data.polygons) == faces and _away(positions(monkey.data), before).max() == 0
    monkey.data.update()
    images = _nearest(_middles(monkey.data), middles * MIRROR)
    now = np.array([monkey.data.polygons[image].normal for image in images.astype(int)])
    assert len(set(images)) == 20 and np.einsum("fx,fx->f", now * MIRROR, normals).max() < -0.99


def test_issue_38_a_wire_of_the_other_side_hangs_on(monkey):
    """As a guide of hair, that was there when the symmetry was found."""
    data = bmesh.new()
    data.from_mesh(monkey.data)
    root = max((vertex for vertex in data.verts if vertex.co.x < -0.2), key=lambda vertex: vertex.co.z)
    tip = data.verts.new(root.co + type(root.co)((0, 0, 0.4)))
    data.edges.new((root, tip))
    place, end = np.array(root.co), np.array(tip.co)
    data.to_mesh(monkey.data)
    data.free()
    ops.detect()
    _edit(monkey, _nearest_faces(monkey.data, (0.5, -0.6, 0.4), 4), _fatten(0.06))
    assert ops.symmetrize_topology() == {"FINISHED"}
    now = positions(monkey.data)
    assert np.count_nonzero(np.linalg.norm(now - place, axis=1) < 1e-6) == 1
    assert np.count_nonzero(np.linalg.norm(now - end, axis=1) < 1e-6) == 1 and _away(now, [end * MIRROR])[0] > 0.1
    assert sum(edge.is_loose for edge in monkey.data.edges) == 1


def test_issue_38_a_wire_that_was_made_is_mirrored(monkey):
    enter("EDIT")
    data = bmesh.from_edit_mesh(monkey.data)
    root = max((vertex for vertex in data.verts if vertex.co.x > 0.2), key=lambda vertex: vertex.co.z)
    tip = data.verts.new(root.co + type(root.co)((0.1, 0, 0.4)))
    data.edges.new((root, tip))
    end = np.array(tip.co)
    bmesh.update_edit_mesh(monkey.data)
    enter("OBJECT")
    edit_faces(monkey, _nearest_faces(monkey.data, (0.5, -0.6, 0.4), 4))
    _fatten(0.06)()
    enter("OBJECT")
    assert ops.symmetrize_topology() == {"FINISHED"}
    now = positions(monkey.data)
    assert _away(now, [end, end * MIRROR]).max() < 1e-5 and sum(edge.is_loose for edge in monkey.data.edges) == 2


@pytest.mark.parametrize("place", [(0.1, 0.5, 0.3), (0.1, -0.3, 0.8), (0.1, -0.7, -0.5)])
@pytest.mark.parametrize("count", [1, 9])
def test_issue_38_a_bevel_near_the_line_lands_exactly(monkey, place, count):
    faces = _nearest_faces(monkey.data, place, count, _middles(monkey.data)[:, 0] > 0)
    edited = _edit(monkey, faces, lambda: bpy.ops.mesh.bevel(offset=0.01, segments=2, affect="EDGES"))
    assert ops.symmetrize_topology() == {"FINISHED"}
    _assert_mirrored(monkey.data)
    assert _away(positions(monkey.data), edited[edited[:, 0] > 1e-3]).max() < 1e-6


def _state(mesh):
    faces = [list(face.vertices) for face in mesh.polygons]
    return positions(mesh).tolist(), faces, [(list(edge.vertices), edge.use_seam) for edge in mesh.edges]


def test_issue_38_a_line_that_was_moved_off_is_refused(monkey):
    """Nothing changes, and after it was put back all that was moved is carried."""
    line = np.flatnonzero(np.abs(positions(monkey.data)[:, 0]) < 1e-5)
    far = line[positions(monkey.data)[line, 1].argmax()]
    _extrude_and_pull(monkey, ("pull", "extrude"))
    enter("OBJECT")
    monkey.data.vertices[far].co.x += 0.05
    before = _state(monkey.data)
    with pytest.raises(RuntimeError, match="1 vertices of the line .* Nothing is changed"):
        ops.symmetrize_topology()
    assert _state(monkey.data) == before
    monkey.data.vertices[far].co.x -= 0.05
    assert ops.symmetrize_topology() == {"FINISHED"}
    _assert_mirrored(monkey.data)


def _dissolve_across(object):
    """Makes one face of some on the left and one on the right, and moves its left corners over to the right."""
    middles, left = _middles(object.data), _middles(object.data)[:, 0] > 0
    place = middles[_nearest_faces(object.data, (0, 0.4, 0.6), 1, _at_line(object.data))[0]]
    faces = [*_nearest_faces(object.data, place, 3, left), *_nearest_faces(object.data, place * MIRROR, 1, ~left)]
    edit_faces(object, faces)
    bpy.ops.mesh.dissolve_faces()
    data = bmesh.from_edit_mesh(object.data)
    face = next(face for face in data.faces if face.select)
    for vertex in face.verts:
        if vertex.co.x > 1e-3:
            vertex.co.x -= 0.8
    bmesh.update_edit_mesh(object.data)
    enter("OBJECT")


def test_issue_38_where_the_line_cannot_go_through_nothing_changes(monkey):
    _dissolve_across(monkey)
    before = _state(monkey.data)
    with pytest.raises(RuntimeError, match="cannot go through the edit. Nothing is changed"):
        ops.symmetrize_topology(direction="LEFT_TO_RIGHT")
    assert _state(monkey.data) == before
