# SPDX-License-Identifier: GPL-3.0-or-later
"""One half of the mesh rebuilt with the other's faces, in a pose."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import (
    attribute, edit_faces, enter, faces_around, module, new_object, positions, read_example, ring, said, select,
)
from mathutils.kdtree import KDTree

ops = bpy.ops.intrinsic_symmetry
DIRECTIONS = {"LEFT_TO_RIGHT": 1, "RIGHT_TO_LEFT": -1}


@pytest.fixture
def remeshed():
    """The posed human with faces that left and right do not share; with its symmetry."""
    object = new_object(read_example("human"))
    object.data.remesh_voxel_size = 0.02
    bpy.ops.object.voxel_remesh()
    assert ops.detect() == {"FINISHED"}
    return object


@pytest.fixture
def body(request):
    return request.getfixturevalue(request.param)


def _faces(mesh):
    """Each face from its least corner on."""
    faces = [list(face.vertices) for face in mesh.polygons]
    return [tuple(face[at:] + face[:at]) for face in faces for at in [face.index(min(face))]]


def _assert_mirrored(mesh):
    """The connectivity is mirrored exactly, and the stored map says how."""
    partner, side = attribute(mesh, "sym_vertex"), attribute(mesh, "sym_side")
    assert partner.min() >= 0 and np.array_equal(partner[partner], np.arange(len(partner)))
    assert np.array_equal(side[partner], -side) and np.array_equal(side == 0, partner == np.arange(len(partner)))
    faces = set(_faces(mesh))
    mirrored = {tuple(int(partner[vertex]) for vertex in face[::-1]) for face in faces}
    assert faces == {face[at:] + face[:at] for face in mirrored for at in [face.index(min(face))]}
    symmetry = module("stored_map").load(mesh)
    assert symmetry.confidence.min() == 1 and mesh["intrinsic_symmetry"]["exact_share"] == 1


def _edge_faces(mesh):
    """(edges,) how many faces each has; every vertex has one fan of them."""
    data = bmesh.new()
    data.from_mesh(mesh)
    assert all(vertex.is_manifold for vertex in data.verts)
    counts = np.array([len(edge.link_faces) for edge in data.edges])
    data.free()
    return counts


def _nearest(places, wanted):
    tree = KDTree(len(places))
    for number, place in enumerate(places):
        tree.insert(place, number)
    tree.balance()
    return np.array([tree.find(place)[1:] for place in wanted])


@pytest.mark.parametrize("body", ["quadruped", "remeshed"], indirect=True)
@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_closed_mesh_with_mirrored_connectivity(body, direction):
    mesh, winner = body.data, DIRECTIONS[direction]
    before, side = positions(mesh), attribute(mesh, "sym_side")
    assert _edge_faces(mesh).max() == 2
    assert ops.symmetrize_topology(direction=direction) == {"FINISHED"}
    _assert_mirrored(mesh)
    assert (_edge_faces(mesh) == 2).all()
    assert len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons) == 2
    lines = module("stored_map").fixed_lines(mesh)
    assert len(lines) == 1 and lines[0].closed
    own = positions(mesh)[attribute(mesh, "sym_side") == winner]
    assert _nearest(before, own)[:, 1].max() < 1e-6, "the winning half stays as it is"
    assert len(own) > 0.98 * np.count_nonzero(side == winner)


def _creased(mesh, at):
    """Pairs of edges that are creased at one side, by the cosine between the normals of their faces."""
    mesh.update()
    normals, of = np.array([face.normal for face in mesh.polygons]), {}
    for face in mesh.polygons:
        for edge in face.edge_keys:
            of.setdefault(frozenset(edge), []).append(normals[face.index])
    bend = {edge: sides[0] @ sides[1] for edge, sides in of.items() if len(sides) == 2}
    partner, side = attribute(mesh, "sym_vertex"), attribute(mesh, "sym_side")
    edges = [edge for edge in bend if all(side[vertex] == at for vertex in edge)]
    return sum(bend[edge] < -0.3 and bend[frozenset(int(partner[vertex]) for vertex in edge)] > 0.3 for edge in edges)


@pytest.mark.parametrize("body", ["quadruped", "remeshed"], indirect=True)
def test_the_copy_is_not_folded(body):
    """Without unfolding, 11 and 29 edges are creased."""
    ops.symmetrize_topology(direction="LEFT_TO_RIGHT")
    assert _creased(body.data, -1) < 4


def _noisy_map(object, noise, seed):
    """Stores the map of the mirror plane X = 0, each image off by about `noise` edges, and so each side near it."""
    from intrinsym import SymmetryKind

    mesh, places = object.data, positions(object.data)
    ends = places[module("mesh_data").edges(mesh)]
    edge = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).mean()
    off = np.random.default_rng(seed).normal(size=places.shape) * noise * edge
    partner = _nearest(places, places * (-1, 1, 1) + off)[:, 0].astype(int)
    side = np.where(partner == np.arange(len(partner)), 0, np.sign(places[:, 0] + off[:, 0]))
    core_mesh = module("detection").core_mesh_of(object, "BASE", None)
    points = module("vertex_map").at_vertices(core_mesh, partner)
    symmetry = core_mesh.restore(SymmetryKind.REFLECTION, partner, np.ones(len(side)), side, points)
    symmetry.fixed_curve = []
    module("stored_map").store(mesh, core_mesh, symmetry)


SHAPES = {
    "sphere": (lambda: bpy.ops.mesh.primitive_uv_sphere_add(rotation=(0.3, 0.2, 0.1)), 2, False),
    "triangles": (lambda: bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, rotation=(0.3, 0.2, 0.1)), 2, False),
    "torus": (lambda: bpy.ops.mesh.primitive_torus_add(rotation=(0, 0, 0.1)), 0, False),
    "grid": (lambda: bpy.ops.mesh.primitive_grid_add(x_subdivisions=15, y_subdivisions=15), 1, True),
}


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("noise", [0.3, 1])
@pytest.mark.parametrize("shape", SHAPES)
def test_a_ragged_line_gives_a_manifold(shape, noise, seed):
    make, characteristic, has_border = SHAPES[shape]
    make()
    object = bpy.context.object
    bpy.ops.object.transform_apply(location=False, rotation=True, scale=False)
    _noisy_map(object, noise, seed)
    assert ops.symmetrize_topology(direction="RIGHT_TO_LEFT") == {"FINISHED"}
    _assert_mirrored(object.data)
    counts = np.bincount(_edge_faces(object.data), minlength=3)
    assert len(counts) == 3 and counts[0] == 0 and (counts[1] > 0) == has_border
    assert len(object.data.vertices) - len(object.data.edges) + len(object.data.polygons) == characteristic


@pytest.mark.parametrize("body", ["quadruped", "remeshed"], indirect=True)
def test_the_copy_lies_on_the_surface_that_was_there(body):
    from mathutils.bvhtree import BVHTree

    mesh = body.data
    old = BVHTree.FromPolygons(positions(mesh).tolist(), [list(face.vertices) for face in mesh.polygons])
    area, size = sum(face.area for face in mesh.polygons), np.ptp(positions(mesh), axis=0).max()
    ops.symmetrize_topology(direction="LEFT_TO_RIGHT")
    copies = positions(mesh)[attribute(mesh, "sym_side") == -1]
    away = np.array([old.find_nearest(place)[3] for place in copies]) / size
    assert away.mean() < 2e-3 and np.quantile(away, 0.95) < 1e-2
    assert abs(sum(face.area for face in mesh.polygons) / area - 1) < 0.02, "nothing is folded"


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_where_connectivity_is_mirrored_nothing_changes(human, mode, direction, capfd):
    before, faces = positions(human.data), [list(face.vertices) for face in human.data.polygons]
    enter(mode)
    assert "nothing to do" in said(capfd, ops.symmetrize_topology, direction=direction)
    enter("OBJECT")
    _assert_mirrored(human.data)
    assert [list(face.vertices) for face in human.data.polygons] == faces
    assert np.array_equal(positions(human.data), before)


@pytest.mark.parametrize("levels", [0, 1, 2])
def test_blenders_monkey_stays_as_it_is(levels):
    """Its line passes through vertices that no edge joins to either side."""
    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    if levels:
        object.modifiers.new("smooth", "SUBSURF").levels = levels
        bpy.ops.object.modifier_apply(modifier="smooth")
    assert ops.detect() == {"FINISHED"}
    before, faces = positions(object.data), len(object.data.polygons)
    assert ops.symmetrize_topology() == {"FINISHED"}
    _assert_mirrored(object.data)
    assert len(object.data.polygons) == faces and len(object.data.vertices) == len(before)
    assert _nearest(before, positions(object.data))[:, 1].max() < 1e-6


def test_at_rest_a_vertex_without_a_twin_is_on_the_side_where_it_lies():
    """The map may have it elsewhere: left and right differ there."""
    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    object.modifiers.new("subdivide", "SUBSURF").levels = 2
    bpy.ops.object.modifier_apply(modifier="subdivide")
    mesh, places = object.data, positions(object.data)
    at_line = [face.index for face in mesh.polygons if (np.abs(places[list(face.vertices), 0]) < 1e-6).sum() == 2]
    face = next(number for number in at_line if mesh.polygons[number].center.x < 0)
    edit_faces(object, [face])
    bpy.ops.mesh.poke()
    enter("OBJECT")
    assert ops.detect() == {"FINISHED"}
    found, core_mesh = module("stored_map").load(mesh), module("detection").core_mesh_of(object, "BASE", None)
    side = np.where(np.arange(len(mesh.vertices)) == len(places), 1, found.side)
    assert found.side[-1] == -1
    wrong = core_mesh.restore(found.kind, found.partner, found.confidence, side, found.surface_points)
    wrong.fixed_curve = found.fixed_curve
    module("stored_map").store(mesh, core_mesh, wrong)
    assert ops.symmetrize_topology() == {"FINISHED"}
    assert len(mesh.vertices) == len(places)
    _assert_mirrored(mesh)


def test_shells_and_open_borders():
    object = new_object(read_example("human_shells"))
    assert ops.detect() == {"FINISHED"}
    borders = np.bincount(_edge_faces(object.data))
    ops.symmetrize_topology(direction="RIGHT_TO_LEFT")
    _assert_mirrored(object.data)
    assert np.array_equal(np.bincount(_edge_faces(object.data)), borders)


def _add_cube(object, place, size):
    """A cube that was added since the symmetry was found; its places."""
    data = bmesh.new()
    data.from_mesh(object.data)
    made = bmesh.ops.create_cube(data, size=size)["verts"]
    bmesh.ops.translate(data, verts=made, vec=place)
    data.to_mesh(object.data)
    data.free()
    return positions(object.data)[-8:]


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_part_across_the_line_stays_alone(human, direction, capfd):
    places, side = positions(human.data), attribute(human.data, "sym_side")
    _add_cube(human, places[np.where(side == 0, places[:, 2], -np.inf).argmax()], 0.02)
    words = said(capfd, ops.symmetrize_topology, direction=direction)
    assert "8 vertices of parts without a mirror image stay alone" in words and "nothing to do" in words
    partner = attribute(human.data, "sym_vertex")
    assert np.count_nonzero(partner < 0) == 8 and (_edge_faces(human.data) == 2).all()
    assert len(human.data.polygons) == 13378 + 6


@pytest.mark.parametrize("at", [1, -1])
@pytest.mark.parametrize("seed", range(4))
def test_a_part_that_was_added_is_copied(human, at, seed, capfd):
    """It is as far from what is around it on both sides of the posed body."""
    places, side, partner = positions(human.data), attribute(human.data, "sym_side"), attribute(human.data, "sym_vertex")
    foot = np.random.default_rng(seed).choice(np.flatnonzero((side == at) & (np.abs(places[:, 0]) > 0.1)))
    human.data.update()
    cube = _add_cube(human, places[foot] + 0.02 * np.array(human.data.vertices[foot].normal), 0.02)
    # The other side's group is missing.
    human.vertex_groups.new(name="Own.L" if at > 0 else "Own.R").add(list(range(13380, 13388)), 0.7, "ADD")
    words = said(capfd, ops.symmetrize_topology)
    assert ("Left to right" if at > 0 else "Right to left") in words and "stay alone" not in words
    _assert_mirrored(human.data)
    assert len(human.data.vertices) == 13380 + 16 and len(human.data.polygons) == 13378 + 12
    now, images = positions(human.data), attribute(human.data, "sym_vertex")
    own = _nearest(now, cube)[:, 0].astype(int)
    around = np.argsort(np.linalg.norm(places - places[foot], axis=1))[:20]
    away = [np.linalg.norm(now[one][:, None] - places[other], axis=2) for one, other in
            ((own, around), (images[own], partner[around]))]
    assert {group.name for group in human.vertex_groups} == {"Own.L", "Own.R"}
    weights = module("weights").read_weights(human)
    assert np.allclose(weights[own], (0.7, 0)) and np.allclose(weights[images[own]], (0, 0.7))
    off = np.abs(away[0] - away[1])
    assert off.mean() < 0.1 * 0.02 and off.max() < 0.5 * 0.02


@pytest.mark.parametrize("off, paired", [(0, True), (0.01, True), (0.2, False)])
def test_issue_38_parts_that_were_added_on_both_sides_are_paired(off, paired, capfd):
    """If they are nearly where they should be. Else one of them is copied, and the other one stays."""
    bpy.ops.mesh.primitive_monkey_add()
    object = bpy.context.object
    assert ops.detect() == {"FINISHED"}
    for at in (1, -1):
        _add_cube(object, np.array((0.6 * at, 0, 1.1 + off * (at > 0))), 0.1)
    before = positions(object.data)
    words = said(capfd, ops.symmetrize_topology)
    assert ("nothing to do" in words) == paired and "is replaced" not in words
    assert len(object.data.vertices) == len(before) + (0 if paired else 8)
    assert _nearest(positions(object.data), before)[:, 1].max() < 1e-6
    assert np.count_nonzero(attribute(object.data, "sym_vertex") < 0) == (0 if paired else 8)


def test_issue_38_an_added_part_keeps_its_form_and_moves_as_its_model_does(human):
    """At a joint that is bent on one side alone, and in keys."""
    mesh, places, side = human.data, positions(human.data), attribute(human.data, "sym_side")
    ends = module("mesh_data").edges(mesh)
    lengths = np.linalg.norm(places[ends[:, 0]] - places[ends[:, 1]], axis=1)
    partner = attribute(mesh, "sym_vertex")
    images = np.linalg.norm(places[partner[ends[:, 0]]] - places[partner[ends[:, 1]]], axis=1)
    joint = ends[np.where((side[ends] == 1).all(axis=1), lengths / images, 0).argmax(), 0]
    human.shape_key_add(name="Basis")
    keys = [human.shape_key_add(name=name) for name in ("Up", "Out.L", "Out.R")]
    _add_cube(human, places[joint], 0.1)
    own = np.arange(13380, 13388)
    write, read = module("mesh_data").set_key_positions, module("mesh_data").key_positions
    for key, moved in zip(keys, (0.1, 0.2, 0.0)):
        points = read(key).astype(float)
        points[own] += (0, 0, moved)
        write(key, points)
    assert ops.symmetrize_topology() == {"FINISHED"}
    now, images = positions(mesh), attribute(mesh, "sym_vertex")
    own = np.flatnonzero((attribute(mesh, "sym_side") == 1) & (_nearest(places, now)[:, 1] > 1e-3))
    between = [np.linalg.norm(now[each][:, None] - now[each], axis=2) for each in (own, images[own])]
    assert len(own) == 8 and np.abs(between[0] - between[1]).max() < 1e-5
    basis, up, left, right = (read(key).astype(float) for key in mesh.shape_keys.key_blocks)
    for key, rows, moved in ((up, own, 0.1), (up, images[own], 0.1), (left, own, 0.2), (right, images[own], 0.2),
                             (left, images[own], 0), (right, own, 0)):
        assert np.allclose(np.linalg.norm((key - basis)[rows], axis=1), moved, atol=1e-5)


def test_issue_38_a_part_whose_mirror_image_was_deleted_is_deleted(human, mode, capfd):
    places, side = positions(human.data), attribute(human.data, "sym_side")
    hand = np.where(side == 1, np.abs(places[:, 0]), 0).argmax()
    _add_cube(human, places[hand], 0.05)
    ops.symmetrize_topology()
    shell = module("regions").components(len(human.data.vertices), module("mesh_data").edges(human.data))
    cube = (shell != shell[hand]) & (attribute(human.data, "sym_side") == 1)
    select(human, np.flatnonzero(cube))
    enter("EDIT")
    bpy.ops.mesh.delete(type="VERT")
    enter(mode)
    assert "deleted on the right side (8 vertices)" in said(capfd, ops.symmetrize_topology)
    enter("OBJECT")
    assert np.count_nonzero(cube) == 8 and len(human.data.vertices) == 13380
    assert _nearest(places, positions(human.data))[:, 1].max() < 1e-6


def _decorate(object, value):
    """A group, a key, colors, UVs that follow a function of the place."""
    mesh, places = object.data, positions(object.data)
    group = object.vertex_groups.new(name="Own")
    for vertex, weight in enumerate(value(places)):
        group.add([vertex], float(weight), "REPLACE")
    object.shape_key_add(name="Basis")
    key = object.shape_key_add(name="Smile")
    module("mesh_data").set_key_positions(key, places + value(places)[:, None] * (0.1, 0.2, 0.3))
    corners = np.array([loop.vertex_index for loop in mesh.loops])
    write = module("mesh_data").write_attribute
    write(mesh, "Color", "FLOAT_COLOR", np.tile(value(places)[:, None], (1, 4)))
    mesh.uv_layers.new(name="UV")
    write(mesh, "UV", "FLOAT2", places[corners][:, [0, 2]], "CORNER")


def test_keys_weights_colors_and_uvs_are_those_of_the_surface_that_was_there(quadruped):
    def value(places):
        return np.clip(0.5 + 0.3 * places[:, 0] + 0.1 * places[:, 2], 0, 1)

    _decorate(quadruped, value)
    ops.symmetrize_topology(direction="LEFT_TO_RIGHT")
    mesh, places = quadruped.data, positions(quadruped.data)
    wanted, keys = value(places), quadruped.data.shape_keys.key_blocks
    size = np.ptp(places, axis=0).max()
    assert np.abs(module("mesh_data").key_positions(keys[0]) - places).max() < 1e-6
    moved = module("mesh_data").key_positions(keys["Smile"]) - places
    weights = module("weights").read_weights(quadruped)[:, 0]
    uvs = attribute(mesh, "UV") - places[[loop.vertex_index for loop in mesh.loops]][:, [0, 2]]
    for off in (weights - wanted, attribute(mesh, "Color")[:, 0] - wanted, moved[:, 1] / 0.2 - wanted, uvs / size):
        assert np.abs(off).mean() < 1e-3 and np.quantile(np.abs(off), 0.95) < 1e-2


def test_uvs_of_mirrored_connectivity_stay_on_their_faces(human):
    """Every face is an island of its own, so that a corner that takes another face's UV is seen."""
    mesh = human.data
    mesh.uv_layers.new(name="UV")
    uvs = np.random.default_rng(1).random((len(mesh.loops), 2))
    module("mesh_data").update_attribute(mesh.attributes["UV"], uvs)

    def by_place():
        values, places = attribute(mesh, "UV"), positions(mesh)
        corner = places[[loop.vertex_index for loop in mesh.loops]]
        middle = np.repeat([face.center for face in mesh.polygons], [face.loop_total for face in mesh.polygons], axis=0)
        return np.column_stack([corner, 0.9 * corner + 0.1 * middle]), values

    before, values = by_place()
    ops.symmetrize_topology(direction="LEFT_TO_RIGHT")
    after, now = by_place()
    nearest = _nearest(before[:, 3:], after[:, 3:])[:, 0].astype(int)
    assert (np.abs(values[nearest] - now).max(axis=1) < 1e-4).mean() > 0.999


def test_materials_and_creases_are_those_of_the_winning_half(human):
    mesh, side = human.data, attribute(human.data, "sym_side")
    for name in ("cloth", "skin"):
        mesh.materials.append(bpy.data.materials.new(name))
    left = np.array([(side[list(face.vertices)] >= 0).all() for face in mesh.polygons])
    mesh.polygons.foreach_set("material_index", left.astype(np.int32))
    creases = np.array([(side[list(edge.vertices)] == 1).all() for edge in mesh.edges], float)
    module("mesh_data").write_attribute(mesh, "crease_edge", "FLOAT", creases, "EDGE")
    ops.symmetrize_topology(direction="LEFT_TO_RIGHT")
    assert all(face.material_index == 1 for face in mesh.polygons)
    side = attribute(mesh, "sym_side")
    on_line = np.array([0 in side[list(edge.vertices)] for edge in mesh.edges])
    assert np.array_equal(attribute(mesh, "crease_edge") == 1, ~on_line)


def test_custom_normals_are_mirrored(human, capfd):
    mesh = human.data
    normals = np.array([normal.vector for normal in mesh.corner_normals]) + np.random.default_rng(1).normal(size=3)
    mesh.normals_split_custom_set((normals / np.linalg.norm(normals, axis=1, keepdims=True)).tolist())
    ops.symmetrize_topology(direction="LEFT_TO_RIGHT")
    assert mesh.has_custom_normals
    words = said(capfd, ops.mirror_attribute, name="custom_normal", direction="LEFT_TO_RIGHT")
    changed = int(words.split("Custom normals: ")[1].split(" of ")[0])
    assert changed < 0.01 * len(mesh.loops), "beside the line nothing is left to mirror"


def test_custom_normals_that_do_not_change_are_not_counted(human, capfd):
    mesh = human.data
    normals = np.array([normal.vector for normal in mesh.corner_normals]) + (1, 0, 0)
    mesh.normals_split_custom_set((normals / np.linalg.norm(normals, axis=1, keepdims=True)).tolist())
    edit_faces(human, [face.index for face in mesh.polygons if (attribute(mesh, "sym_side")[face.vertices] == 1).all()][:1])
    bpy.ops.mesh.poke()
    enter("OBJECT")
    words = said(capfd, ops.symmetrize_topology)
    assert int(words.split("Custom normals: ")[1].split(" of ")[0]) <= 12, "four triangles"


def _select_feet(object, sides):
    """In edit mode, faces of the foot on some of the sides."""
    height = np.where(attribute(object.data, "sym_side") == 1, positions(object.data)[:, 2], np.inf)
    feet = dict(zip((1, -1), faces_around(object.data, height.argmin(), slice(20))))
    edit_faces(object, sum((feet[side] for side in sides), []))


def _extrude(object, sides, depth):
    _select_feet(object, sides)
    bpy.ops.mesh.extrude_region_shrink_fatten(TRANSFORM_OT_shrink_fatten={"value": -depth})


def _extrude_inset(object, sides):
    _select_feet(object, sides)
    bpy.ops.mesh.inset(thickness=0.003)
    bpy.ops.mesh.extrude_region_shrink_fatten(TRANSFORM_OT_shrink_fatten={"value": -0.05})


def _delete(object, sides):
    _select_feet(object, sides)
    bpy.ops.mesh.delete(type="FACE")


def _cut(object, sides):
    """A loop cut that stays on its side, on some of the sides."""
    side, partner = attribute(object.data, "sym_side"), attribute(object.data, "sym_vertex")
    enter("EDIT")
    data = bmesh.from_edit_mesh(object.data)
    rings = (ring(edge) for edge in data.edges)
    left = next(each for each in rings if all(side[vertex.index] == 1 for edge in each for vertex in edge.verts))
    data.verts.ensure_lookup_table()
    right = [data.edges.get([data.verts[partner[vertex.index]] for vertex in edge.verts]) for edge in left]
    crossed = (left if 1 in sides else []) + (right if -1 in sides else [])
    bmesh.ops.subdivide_edges(data, edges=crossed, cuts=1, use_grid_fill=True)
    bmesh.update_edit_mesh(object.data)


EDITS = {
    "shallow extrusion": lambda object, sides: _extrude(object, sides, 0.02),
    "deep extrusion": lambda object, sides: _extrude(object, sides, 0.1),
    "inset and extrusion": _extrude_inset,
    "loop cut": _cut,
    "deletion": _delete,
}


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("edit", EDITS)
def test_an_edit_of_one_side_arrives_on_the_other(human, mode, edit, side):
    both = new_object(human.data.copy())
    EDITS[edit](both, (1, -1))
    enter("OBJECT")
    wanted = positions(both.data)
    bpy.context.view_layer.objects.active = human
    EDITS[edit](human, (side,))
    enter(mode)
    assert ops.symmetrize_topology() == {"FINISHED"}
    enter("OBJECT")
    _assert_mirrored(human.data)
    assert len(human.data.vertices) == len(wanted) != 13380
    assert _nearest(wanted, positions(human.data))[:, 1].max() < 1e-3


FORMS = {
    "inset": [lambda: bpy.ops.mesh.inset(thickness=0.02)],
    "inset with a depth": [lambda: bpy.ops.mesh.inset(thickness=0.02, depth=0.1)],
    "inset, extrude": [lambda: bpy.ops.mesh.inset(thickness=0.02), lambda: _pull(0.1)],
    "inset, extrude inwards": [lambda: bpy.ops.mesh.inset(thickness=0.02), lambda: _pull(-0.1)],
    "extrude, update, inset": [lambda: _pull(0.1), ops.carry, lambda: bpy.ops.mesh.inset(thickness=0.02)],
    "bevel": [lambda: bpy.ops.mesh.bevel(offset=0.02, segments=1)],
    "bevel, rounded": [lambda: bpy.ops.mesh.bevel(offset=0.02, segments=3)],
}


def _pull(depth):
    bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (depth, 0, 0)})


def _edited_sphere(middle, count, steps):
    """A sphere with its symmetry, then edited at the `count` faces nearest to a place."""
    bpy.ops.mesh.primitive_uv_sphere_add()
    object = bpy.context.object
    _noisy_map(object, 0, 0)
    away = [np.linalg.norm(np.array(face.center) - middle) for face in object.data.polygons]
    edit_faces(object, np.argsort(away)[:count])
    for step in steps:
        step()
    enter("OBJECT")
    return object


@pytest.mark.parametrize("count", [1, 9, 30])
@pytest.mark.parametrize("steps", FORMS)
def test_a_form_arrives_at_its_mirrored_place(steps, count):
    object = _edited_sphere((0.8, 0.4, 0.4), count, FORMS[steps])
    wanted = positions(object.data)
    wanted = wanted[wanted[:, 0] > 1e-3] * (-1, 1, 1)
    assert ops.symmetrize_topology() == {"FINISHED"}
    _assert_mirrored(object.data)
    now = positions(object.data)
    assert np.count_nonzero(now[:, 0] < -1e-3) == len(wanted)
    assert _nearest(now, wanted)[:, 1].max() < 1e-3


ACROSS = {
    **{name: FORMS[name] for name in ("inset", "bevel", "bevel, rounded")},
    "extrude": [lambda: bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0, 0.1, 0.1)})],
    "delete": [lambda: bpy.ops.mesh.delete(type="FACE")],
    "merge": [lambda: bpy.ops.mesh.merge(type="COLLAPSE")],
}


@pytest.mark.parametrize("count", [12, 30, 60])
@pytest.mark.parametrize("steps", ACROSS)
def test_a_form_across_the_line_arrives_at_its_mirrored_place(steps, count):
    """More of it is on the left. At a corner of its border it may be off by twice the width, which is 0.02."""
    object = _edited_sphere((0.2, 0.8, 0.4), count, ACROSS[steps])
    before = positions(object.data)
    assert ops.symmetrize_topology(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    _assert_mirrored(object.data)
    places, partner, left = positions(object.data), *(attribute(object.data, f"sym_{name}") for name in ("vertex", "side"))
    off = np.linalg.norm(places[partner] * (-1, 1, 1) - places, axis=1)[left == 1]
    assert np.quantile(off, 0.96) < 5e-3 and off.max() < 0.04
    assert _nearest(before, places[left == 1])[:, 1].max() < 1e-6


def _pull_out():
    bpy.ops.mesh.extrude_region_move(TRANSFORM_OT_translate={"value": (0, 0, 0.05)})


AT_THE_LINE = {
    "extrude twice": [_pull_out] * 2,
    "extrude three times": [_pull_out] * 3,
    "extrude, inset": [_pull_out, lambda: bpy.ops.mesh.inset(thickness=0.01)],
    "inset, extrude": [lambda: bpy.ops.mesh.inset(thickness=0.01), _pull_out],
    "merge": [lambda: bpy.ops.mesh.merge(type="CENTER")],
    "collapse": [lambda: bpy.ops.mesh.merge(type="COLLAPSE")],
    "bevel": [lambda: bpy.ops.mesh.bevel(offset=0.02, segments=2, affect="EDGES")],
}


@pytest.mark.parametrize("across", [0, -0.15])
@pytest.mark.parametrize("make", [bpy.ops.mesh.primitive_uv_sphere_add, bpy.ops.mesh.primitive_monkey_add])
@pytest.mark.parametrize("steps", AT_THE_LINE)
def test_issue_38_an_edit_at_the_line_arrives_exactly(steps, make, across):
    """It ends on the line, or goes across it."""
    make()
    object = bpy.context.object
    _noisy_map(object, 0, 0)
    before = positions(object.data)
    middles = np.array([face.center for face in object.data.polygons])
    edit_faces(object, (middles[:, 0] > across) & (middles[:, 0] < 0.4) & (middles[:, 2] > 0.6))
    for step in AT_THE_LINE[steps]:
        step()
    enter("OBJECT")
    edited = positions(object.data)
    assert ops.symmetrize_topology(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    _assert_mirrored(object.data)
    now = positions(object.data)
    assert _nearest(now, now * (-1, 1, 1))[:, 1].max() < 1e-3, "the whole is its own mirror image"
    assert _nearest(now, edited[edited[:, 0] > 1e-3])[:, 1].max() < 1e-6
    still = _nearest(edited, before * (-1, 1, 1))[:, 1] < 1e-6
    assert _nearest(now, before[still & (before[:, 0] < -1e-3)])[:, 1].max() < 1e-5, "what was not edited does not move"


def test_issue_38_half_a_belt_that_becomes_one_face_moves_no_vertex():
    """Its mirror image shares the edges of the line with it."""
    bpy.ops.mesh.primitive_uv_sphere_add()
    object = bpy.context.object
    _noisy_map(object, 0, 0)
    edit_faces(object, [face.index for face in object.data.polygons if face.center.x > 0 and abs(face.center.z) < 0.3])
    bpy.ops.mesh.dissolve_faces()
    enter("OBJECT")
    edited, count = positions(object.data), sum(face.center.x > 1e-5 for face in object.data.polygons)
    assert ops.symmetrize_topology() == {"FINISHED"}
    _assert_mirrored(object.data)
    now = positions(object.data)
    assert _nearest(edited, now)[:, 1].max() < 1e-6, "no vertex moves or is made"
    assert _nearest(now, edited[edited[:, 0] > -1e-5])[:, 1].max() < 1e-6, "the edited half is as it was"
    assert len(object.data.polygons) == 2 * count


@pytest.mark.parametrize("step", [
    lambda: bpy.ops.mesh.extrude_faces_move(TRANSFORM_OT_shrink_fatten={"value": 0.1}),
    lambda: bpy.ops.mesh.inset(thickness=0.02, depth=0.1),
    lambda: bpy.ops.mesh.extrude_region_shrink_fatten(TRANSFORM_OT_shrink_fatten={"value": 0.1}),
], ids=["individual", "inset with a depth", "region"])
def test_a_key_that_lacks_an_extrusion_lacks_it_on_both_sides(step):
    """Blender leaves the first two out of the keys that are not active."""
    bpy.ops.mesh.primitive_uv_sphere_add()
    object = bpy.context.object
    _noisy_map(object, 0, 0)
    places = positions(object.data)
    object.shape_key_add(name="Basis")
    module("mesh_data").set_key_positions(object.shape_key_add(name="Up"), places + 0.3 * np.abs(places[:, :1]) * (0, 0, 1))
    object.active_shape_key_index = 0
    away = [np.linalg.norm(np.array(face.center) - (0.8, 0.4, 0.4)) for face in object.data.polygons]
    edit_faces(object, np.argsort(away)[:9])
    step()
    enter("OBJECT")
    read, keys = module("mesh_data").key_positions, object.data.shape_keys.key_blocks
    before = read(keys["Up"])
    assert ops.symmetrize_topology() == {"FINISHED"}
    up, partner = read(keys["Up"]), attribute(object.data, "sym_vertex")
    assert np.abs(up[partner] * (-1, 1, 1) - up).max() < 0.02, "a fifth of the depth, at the inset's corners"
    assert _nearest(before, up[attribute(object.data, "sym_side") == 1])[:, 1].max() < 1e-6


@pytest.mark.parametrize("count", [1, 9, 30])
def test_what_is_merged_arrives_at_its_mirrored_place(count):
    """Blender keeps one of the merged vertices, and moves it."""
    bpy.ops.mesh.primitive_uv_sphere_add()
    object = bpy.context.object
    _noisy_map(object, 0, 0)
    away = [np.linalg.norm(np.array(face.center) - (0.8, 0.4, 0.4)) for face in object.data.polygons]
    edit_faces(object, np.argsort(away)[:count])
    bpy.ops.mesh.merge(type="COLLAPSE")
    enter("OBJECT")
    wanted = positions(object.data)
    wanted = wanted[wanted[:, 0] > 1e-3] * (-1, 1, 1)
    assert ops.symmetrize_topology() == {"FINISHED"}
    _assert_mirrored(object.data)
    assert _nearest(positions(object.data), wanted)[:, 1].max() < 3e-3


def test_undo_in_edit_mode(human):
    enter("EDIT")
    bpy.ops.ed.undo_push(message="before")
    ops.symmetrize_topology("EXEC_DEFAULT", True, direction="RIGHT_TO_LEFT")
    bpy.ops.ed.undo()
    enter("OBJECT")
    mesh = bpy.context.object.data
    assert mesh["intrinsic_symmetry"]["left_from"] and module("stored_map").load(mesh).partner.min() >= 0


def test_what_cannot_work_is_refused(human):
    human.modifiers.new("detail", "MULTIRES")
    bpy.ops.object.multires_subdivide(modifier="detail")
    with pytest.raises(RuntimeError, match="Multires"):
        ops.symmetrize_topology()
    human.modifiers.clear()
    human.data["intrinsic_symmetry"]["kind"] = 1
    with pytest.raises(RuntimeError, match="half turn"):
        ops.symmetrize_topology()


def test_a_hole_in_the_map_is_refused(quadruped):
    mesh = quadruped.data
    partner, side = attribute(mesh, "sym_vertex"), attribute(mesh, "sym_side")
    lost = np.flatnonzero(side == 1)[:30]
    partner[lost] = -1
    core_mesh = module("detection").core_mesh_of(quadruped, "BASE", None)
    points = module("vertex_map").at_vertices(core_mesh, partner)
    symmetry = module("stored_map").load(mesh)
    holed = core_mesh.restore(symmetry.kind, partner, partner >= 0, np.where(partner < 0, 0, side), points)
    holed.fixed_curve = []
    module("stored_map").store(mesh, core_mesh, holed)
    with pytest.raises(RuntimeError, match="30 of 3,398 vertices have no mirror image"):
        ops.symmetrize_topology()


FACE_EDITS = {
    "triangulate": lambda: bpy.ops.mesh.quads_convert_to_tris(),
    "delete only faces": lambda: bpy.ops.mesh.delete(type="ONLY_FACE"),
    "dissolve": lambda: bpy.ops.mesh.dissolve_faces(),
    "flip": lambda: bpy.ops.mesh.flip_normals(),
}


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("edit", FACE_EDITS)
def test_an_edit_of_faces_alone_arrives_on_the_other_side(human, edit, side, capfd):
    both = new_object(human.data.copy())
    _select_feet(both, (1, -1))
    FACE_EDITS[edit]()
    enter("OBJECT")
    bpy.context.view_layer.objects.active = human
    both.select_set(False)
    _select_feet(human, (side,))
    FACE_EDITS[edit]()
    enter("OBJECT")
    assert module("ops_carry")._has_changed(human.data) == (edit != "flip"), "the panel offers Mirror This Edit"
    words = said(capfd, ops.symmetrize_topology)
    assert ("Left to right" if side > 0 else "Right to left") in words and "is replaced" not in words
    sizes = (sorted(len(face.vertices) for face in object.data.polygons) for object in (human, both))
    assert next(sizes) == next(sizes)
    turned = [sum(face.normal.z < 0 for face in object.data.polygons) for object in (human, both)]
    assert abs(turned[0] - turned[1]) < 2


def test_where_both_sides_were_edited_it_says_what_is_replaced(human, capfd):
    _extrude(human, (1,), 0.02)
    ops.carry()
    enter("OBJECT")
    hand = np.where(attribute(human.data, "sym_side") == -1, positions(human.data)[:, 0], np.inf).argmin()
    edit_faces(human, [face.index for face in human.data.polygons if hand in face.vertices])
    bpy.ops.mesh.subdivide()
    enter("OBJECT")
    words = said(capfd, ops.symmetrize_topology)
    assert "Right to left" in words and "What was edited on the left side is replaced" in words, "also across two edits"
    assert "is replaced" not in said(capfd, ops.symmetrize_topology, direction="RIGHT_TO_LEFT")


def test_the_same_edit_of_both_sides_replaces_nothing(human, capfd):
    _select_feet(human, (1, -1))
    FACE_EDITS["triangulate"]()
    assert "is replaced" not in said(capfd, ops.symmetrize_topology)


def test_a_deleted_hand_comes_back(human):
    """In the form of the other one, with the weights that are around it."""
    places, side = positions(human.data), attribute(human.data, "sym_side")
    tip = np.where(side == 1, np.abs(places[:, 0]), 0).argmax()
    lost = np.linalg.norm(places - places[tip], axis=1) < 0.2
    for name, at in (("A.L", 1), ("A.R", -1)):
        human.vertex_groups.new(name=name).add(np.flatnonzero(side == at).tolist(), 1, "ADD")
    enter("EDIT")
    data = bmesh.from_edit_mesh(human.data)
    data.verts.ensure_lookup_table()
    bmesh.ops.delete(data, geom=[data.verts[index] for index in np.flatnonzero(lost)], context="VERTS")
    bmesh.update_edit_mesh(human.data)
    assert ops.symmetrize_topology(direction="RIGHT_TO_LEFT") == {"FINISHED"}
    enter("OBJECT")
    _assert_mirrored(human.data)
    assert len(human.data.vertices) == 13380
    now, partner = positions(human.data), attribute(human.data, "sym_vertex")
    away = _nearest(places[~lost], now)[:, 1] > 1e-5
    ends = module("mesh_data").edges(human.data)
    ends = ends[away[ends].all(axis=1)]
    lengths = [np.linalg.norm(now[each[:, 0]] - now[each[:, 1]], axis=1) for each in (ends, partner[ends])]
    assert np.count_nonzero(away) > 1000 and np.abs(lengths[0] / lengths[1] - 1).mean() < 0.05
    weights = module("weights").read_weights(human)
    assert np.allclose(weights[away], (1, 0))


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_part_that_was_split_off(human, direction, side):
    """If its side wins, the other one is split off, too; else it is joined again, as its side is replaced."""
    before = positions(human.data)
    _select_feet(human, (side,))
    bpy.ops.mesh.split()
    enter("OBJECT")
    count = len(human.data.vertices)
    added = 2 * (count - len(before)) if DIRECTIONS[direction] == side else 0
    assert ops.symmetrize_topology(direction=direction) == {"FINISHED"}
    _assert_mirrored(human.data)
    assert len(human.data.polygons) == 13378 and len(human.data.vertices) == len(before) + added != count
    assert _nearest(positions(human.data), before)[:, 1].max() < 1e-5


def test_a_part_that_was_split_off_a_paired_shell():
    """Of two spheres, the one that is split wins."""
    for at in (1, -1):
        bpy.ops.mesh.primitive_uv_sphere_add(location=(2 * at, 0, 0))
    bpy.data.objects[0].select_set(True)
    bpy.ops.object.join()
    bpy.ops.object.transform_apply()
    object = bpy.context.object
    _noisy_map(object, 0, 0)
    edit_faces(object, [face.index for face in object.data.polygons if face.center.x > 2.5])
    bpy.ops.mesh.split()
    enter("OBJECT")
    counts = [np.count_nonzero(positions(object.data)[:, 0] * at > 0) for at in (1, -1)]
    assert ops.symmetrize_topology() == {"FINISHED"}
    _assert_mirrored(object.data)
    assert counts[0] > counts[1] and len(object.data.vertices) == 2 * counts[0]


def test_hooks_and_children_of_vertices_stay_where_they_are(human, mode, capfd):
    side, places = attribute(human.data, "sym_side"), positions(human.data)
    tips = [int(np.where(side == at, np.abs(places[:, 0]), 0).argmax()) for at in (1, -1)]
    for tip in tips:
        hook, child = human.modifiers.new("hook", "HOOK"), bpy.data.objects.new("child", None)
        hook.object = child
        hook.vertex_indices_set([tip])
        child.parent, child.parent_type, child.parent_vertices = human, "VERTEX_3", [tip, *human.data.edges[0].vertices]
    wanted = [places[list(child.parent_vertices)] for child in human.children]
    _select_feet(human, (1,))
    bpy.ops.mesh.subdivide()
    enter(mode)
    words = said(capfd, ops.symmetrize_topology)
    assert ('does not take back the vertices of "hook"' in words) == (mode == "EDIT")
    enter("OBJECT")
    now = positions(human.data)
    for hook, tip, child, where in zip(human.modifiers, tips, human.children, wanted):
        assert np.allclose(now[list(hook.vertex_indices)], places[tip], atol=1e-5)
        assert np.allclose(now[list(child.parent_vertices)], where, atol=1e-5)


def test_all_objects_in_edit_mode(human):
    other = new_object(human.data.copy(), "other")
    for object in (other, human):
        other.select_set(object is other)
        bpy.context.view_layer.objects.active = object
        normals = np.array([normal.vector for normal in object.data.corner_normals])
        object.data.normals_split_custom_set((normals + (0, 0, 0.1)).tolist())
        _extrude(object, (1,), 0.02)
        enter("OBJECT")
    other.select_set(True)
    enter("EDIT")
    assert ops.symmetrize_topology() == {"FINISHED"}
    enter("OBJECT")
    assert len(human.data.vertices) == len(other.data.vertices)
    for object in (human, other):
        _assert_mirrored(object.data)


@pytest.mark.parametrize("name", ["sym_wear", "sym_source", "sym_label", "sym_remembered_pose"])
def test_attributes_of_the_user_s_that_begin_as_ours_are_those_of_the_surface(quadruped, name):
    mesh = quadruped.data
    mesh.attributes.new(name, "FLOAT_VECTOR", "POINT")
    module("mesh_data").update_attribute(mesh.attributes[name], positions(mesh))
    before = set(mesh.attributes.keys())
    assert ops.remember() == ops.symmetrize_topology(direction="LEFT_TO_RIGHT") == {"FINISHED"}
    assert set(mesh.attributes.keys()) >= before and not {f"{name}.001", ".sym_source", ".sym_label"} & set(mesh.attributes.keys())
    off = np.linalg.norm(attribute(mesh, name) - positions(mesh), axis=1)
    assert np.quantile(off, 0.9) < 0.01
