# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that are in edit mode together, and what is said of what a tool does not touch."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import attribute, edit_faces, enter, module, new_object, positions, read_example, said, select, truth_of
from mathutils import Matrix

ops = bpy.ops.intrinsic_symmetry


def _copy_of(object, name):
    """Another object with a mesh and a map of its own, in the selection too."""
    other = bpy.data.objects.new(name, object.data.copy())
    bpy.context.scene.collection.objects.link(other)
    other.select_set(True)
    return other


def test_objects_in_edit_mode_are_all_worked_on(human, truth):
    other = _copy_of(human, "other")
    left = np.flatnonzero(attribute(human.data, "sym_side") == 1)
    chosen = {human: left[:20], other: left[40:70]}
    for object, vertices in chosen.items():
        select(object, vertices)
    enter("EDIT")
    assert ops.select() == {"FINISHED"}
    assert human.mode == other.mode == "EDIT"
    enter("OBJECT")
    for object, vertices in chosen.items():
        assert set(np.flatnonzero(module("mesh_data").selected_vertices(object.data))) == set(truth[vertices])


def select_again(object, vertices):
    enter("OBJECT")
    select(object, vertices)
    enter("EDIT")


def test_a_selection_in_one_object_spares_the_others(human, capfd):
    other = _copy_of(human, "other")
    for object in (human, other):
        left = np.flatnonzero(attribute(object.data, "sym_side") == 1)
        object.vertex_groups.new(name="Arm.L").add(left.tolist(), 1, "ADD")
        select(object, [])
    left = np.flatnonzero(attribute(human.data, "sym_side") == 1)[:30]
    select(human, left)
    enter("EDIT")
    assert "Nothing is selected" not in said(capfd, ops.select_to_line)
    select_again(human, left)
    ops.mirror_vertex_groups(direction="LEFT_TO_RIGHT")
    enter("OBJECT")
    assert np.count_nonzero(module("weights").read_weights(human)[:, 1]) == 30
    assert other.vertex_groups.keys() == ["Arm.L"]


def test_an_object_without_a_map_is_named_and_the_others_are_done(human, capfd):
    bare = new_object(read_example("quadruped"), "bare")
    human.select_set(True)
    bpy.context.view_layer.objects.active = human
    select(human, [0])
    select(bare, [0])
    enter("EDIT")
    text = said(capfd, ops.select)
    assert "bare: Detect the symmetry first" in text and f"{human.name}: 1 vertices selected" in text
    assert human.mode == bare.mode == "EDIT"


def test_what_is_not_touched_is_said(quadruped, capfd):
    text = said(capfd, ops.symmetrize, minimum_confidence=0.9)
    share = (attribute(quadruped.data, "sym_confidence") < 0.9).mean()
    assert 0.01 < share < 1
    assert f"{share:.1%} of the vertices have no mirror image, or none certain enough, and are not touched" in text
    assert "not touched" not in said(capfd, ops.symmetrize)


def _shell_numbers(mesh):
    """(vertices,) a number of each vertex's shell."""
    numbers, ends = np.arange(len(mesh.vertices)), module("mesh_data").edges(mesh)
    while True:
        least = numbers[ends].min(axis=1)
        before = numbers.copy()
        np.minimum.at(numbers, ends[:, 0], least)
        np.minimum.at(numbers, ends[:, 1], least)
        if np.array_equal(before, numbers):
            return numbers


def _part(mesh, name, kept):
    """An object of some of the vertices."""
    object = bpy.data.objects.new(name, mesh.copy())
    bpy.context.scene.collection.objects.link(object)
    data = bmesh.new()
    data.from_mesh(object.data)
    data.verts.ensure_lookup_table()
    bmesh.ops.delete(data, geom=[data.verts[index] for index in np.flatnonzero(~kept)], context="VERTS")
    data.to_mesh(object.data)
    data.free()
    return object


@pytest.fixture
def parts():
    """A head's paired shells, eyes and lashes, as objects of their own, the left ones a mirrored and moved object; with
    the body, which is active, they share one map. Also the true mirror image of each left vertex among the right ones.
    """
    mesh, truth = read_example("human_shells"), truth_of("human_shells")
    shells = _shell_numbers(mesh)
    paired = shells != shells[truth]
    is_left = shells < shells[truth]
    is_right = paired & ~is_left
    body, left, right = (_part(mesh, *part) for part in (("body", ~paired), ("left", is_left), ("right", is_right)))
    turn = Matrix.Translation((3, 0, 0)) @ Matrix.Rotation(0.5, 4, "Z") @ Matrix.Scale(-1, 4, (1, 0, 0))
    left.data.transform(turn.inverted())
    left.data.flip_normals()
    left.matrix_world = turn
    for object in (body, left, right):
        object.select_set(True)
    bpy.context.view_layer.objects.active = body
    bpy.context.view_layer.update()
    assert ops.detect(together=True) == {"FINISHED"}
    return body, left, right, np.cumsum(is_right)[truth[is_left]] - 1


def test_several_objects_share_one_map(parts):
    body, left, right, partner = parts
    assert len(bpy.data.objects) == 3 and bpy.context.active_object == body
    first = len(body.data.vertices) + len(left.data.vertices)
    assert np.array_equal(attribute(left.data, "sym_vertex") - first, partner)
    assert list(left.data["intrinsic_symmetry"]["members"].values()) == ["body", "left", "right"]


def test_selections_go_across_objects(parts):
    body, left, right, partner = parts
    for object, vertices in ((body, []), (left, np.arange(20)), (right, np.arange(len(partner)))):
        select(object, vertices)
    right.select_set(False)  # what is selected in an object that is not edited does not count
    enter("EDIT")
    assert ops.select() == {"FINISHED"}
    assert body.mode == left.mode == "EDIT" and right.mode == "OBJECT"
    enter("OBJECT")
    found = [np.flatnonzero(module("mesh_data").selected_vertices(object.data)) for object in (body, left, right)]
    assert not len(found[0]) and not len(found[1]) and set(found[2]) == set(partner[:20])


def test_weights_go_across_objects_and_materials_stay(parts):
    body, left, right, partner = parts
    for object, count in ((body, 1), (left, 3), (right, 2)):
        for number in range(count):
            object.data.materials.append(bpy.data.materials.new(f"{object.name}{number}"))
        object.data.polygons.foreach_set("material_index", np.full(len(object.data.polygons), count - 1))
    left.vertex_groups.new(name="Eye.L").add(list(range(100)), 0.5, "ADD")
    bpy.context.view_layer.objects.active = left
    assert ops.mirror_vertex_groups() == {"FINISHED"}
    assert [group.name for group in right.vertex_groups] == ["Eye.R"] and not body.vertex_groups
    assert set(np.flatnonzero(module("weights").read_weights(right)[:, 0])) == set(partner[:100])
    assert [group.name for group in left.vertex_groups] == ["Eye.L"]
    for object, count in ((body, 1), (left, 3), (right, 2)):
        assert {face.material_index for face in object.data.polygons} == {count - 1}
        assert len(object.data.materials) == count


def _normals(object):
    return np.array([vertex.normal for vertex in object.data.vertices])


def _swell(object, name, vertices, size):
    """A key that moves vertices along their normals."""
    if object.data.shape_keys is None:
        object.shape_key_add(name="Basis")
    key = object.shape_key_add(name=name)
    inside = np.isin(np.arange(len(object.data.vertices)), vertices)[:, None]
    swollen = positions(object.data) + size * np.where(inside, _normals(object), 0)
    module("mesh_data").set_key_positions(key, swollen)
    object.active_shape_key_index = object.data.shape_keys.key_blocks.find(name)
    bpy.context.view_layer.objects.active = object
    return key


def _outward(object, name):
    """(vertices,) how far a key moves each vertex along its normal."""
    moved = module("mesh_data").key_positions(object.data.shape_keys.key_blocks[name]) - positions(object.data)
    return np.einsum("vx,vx->v", moved, _normals(object))


def test_what_is_locked_on_one_object_stays(parts, capfd):
    _, left, right, partner = parts
    _swell(right, "Swell.R", partner[:100], 0).lock_shape = True
    _swell(left, "Swell.L", np.arange(100), 0.1 * np.ptp(positions(left.data)[:100], axis=0).max())
    left.vertex_groups.new(name="Arm.L").add(range(100), 1, "ADD")
    left.vertex_groups.new(name="Arm.R")
    right.vertex_groups.new(name="Arm.R").lock_weight = True
    assert '"Swell.R" (locked)' in said(capfd, ops.mirror_shape_keys)
    assert '"Arm.R" (locked)' in said(capfd, ops.mirror_vertex_groups, direction="LEFT_TO_RIGHT")
    assert np.abs(_outward(right, "Swell.R")).max() == 0 and not module("weights").read_weights(right).any()


def test_keys_go_across_objects_both_ways(parts):
    body, left, right, partner = parts
    before, size = positions(right.data), 0.1 * np.ptp(positions(left.data)[:100], axis=0).max()
    swell = _swell(left, "Swell.L", np.arange(100), size)
    swell.slider_max = 2
    swell.driver_add("value").driver.expression = "0.5"
    assert ops.mirror_shape_keys() == {"FINISHED"}
    outward = _outward(right, "Swell.R")
    assert np.allclose(outward[partner[:100]], size, rtol=0.1) and np.abs(outward[partner[100:]]).max() < 0.01 * size
    made = right.data.shape_keys.key_blocks["Swell.R"]
    assert made.slider_max == 2 and np.array_equal(positions(right.data), before)
    drivers = right.data.shape_keys.animation_data.drivers
    assert [(curve.data_path, curve.driver.expression) for curve in drivers] == [('key_blocks["Swell.R"].value', "0.5")]
    assert "Swell.R" not in left.data.shape_keys.key_blocks and body.data.shape_keys is None
    _swell(right, "Frown.R", partner[:100], size)
    assert ops.mirror_shape_keys() == {"FINISHED"}
    assert np.allclose(_outward(left, "Frown.L")[:100], size, rtol=0.1)


def test_positions_go_across_objects_and_the_map_can_be_removed(parts):
    body, left, right, partner = parts
    before = [positions(object.data) for object in (body, left, right)]
    ops.remember()
    moved = before[1] + 0.01 * (np.arange(len(before[1])) < 100)[:, None]
    module("mesh_data").set_shown_positions(left, moved)
    assert ops.mirror_edit() == {"FINISHED"}
    change = np.linalg.norm(positions(right.data) - before[2], axis=1)
    assert np.allclose(change[partner[:50]], 0.01 * 3**0.5, rtol=0.1)
    assert np.array_equal(positions(body.data), before[0])
    bpy.context.view_layer.objects.active = right
    assert ops.exchange_sides() == {"FINISHED"}
    assert left.data["intrinsic_symmetry"]["left_from"] == "Exchange Sides"
    assert ops.clear() == {"FINISHED"}
    assert not [name for part in parts[:3] for name in part.data.attributes.keys() if name.startswith("sym_")]


@pytest.mark.parametrize("edit", ["subdivide", "delete"])
def test_the_map_is_carried_through_an_edit_of_one_of_them(parts, edit, capfd):
    body, left, right, partner = parts
    before = positions(left.data)
    for object in (body, right):
        object.select_set(False)
    bpy.context.view_layer.objects.active = left
    edit_faces(left, np.arange(10, 14))
    bpy.ops.mesh.subdivide() if edit == "subdivide" else bpy.ops.mesh.delete(type="FACE")
    enter("OBJECT")
    after, first = positions(left.data), len(body.data.vertices)
    assert (len(after) > len(before)) == (edit == "subdivide")
    old = {tuple(place): number for number, place in enumerate(before)}
    new, number = np.array([(new, old[tuple(place)]) for new, place in enumerate(after) if tuple(place) in old]).T
    left.vertex_groups.new(name="Eye.L").add(new[:100].tolist(), 0.5, "ADD")
    bpy.context.view_layer.objects.active = right
    assert "carried through an edit" in said(capfd, ops.mirror_vertex_groups)
    assert "carried" not in said(capfd, ops.mirror_vertex_groups)
    found = np.flatnonzero(module("weights").read_weights(right)[:, 0])
    assert len(set(found) ^ set(partner[number[:100]])) < 5
    images, last = attribute(left.data, "sym_vertex"), first + len(after)
    assert images.min() >= last and (images[new] - last == partner[number]).mean() > 0.97
    assert (attribute(right.data, "sym_vertex")[partner[number]] == new + first).mean() > 0.97


def test_objects_may_be_renamed(parts):
    """Also where another object gets the name."""
    body, left, right, partner = parts
    left.name, right.name = "right hand", "left hand"
    new_object(read_example("quadruped"), "left")
    bpy.context.view_layer.objects.active = body
    left.vertex_groups.new(name="Eye.L").add(list(range(100)), 0.5, "ADD")
    assert ops.mirror_vertex_groups() == {"FINISHED"}
    assert right.vertex_groups.keys() == ["Eye.R"]
    copy = _copy_of(right, "copy")
    bpy.context.view_layer.objects.active = copy
    with pytest.raises(RuntimeError, match="copied from"):
        ops.exchange_sides()


def test_a_missing_object_is_named(parts):
    body, left, right, _ = parts
    bpy.data.objects.remove(right)
    with pytest.raises(RuntimeError, match='"right" is missing: Detect again'):
        ops.exchange_sides()
    assert len(bpy.data.objects) == 2
    assert ops.detect() == {"FINISHED"}  # of the one alone
    assert ops.exchange_sides() == {"FINISHED"}


def test_a_copy_does_not_change_its_originals(parts):
    body, left, right, _ = parts
    copy = _copy_of(left, "copy")
    bpy.context.view_layer.objects.active = copy
    before = attribute(left.data, "sym_side")
    with pytest.raises(RuntimeError, match="copied from: Detect again"):
        ops.exchange_sides()
    assert np.array_equal(attribute(left.data, "sym_side"), before)


def test_what_edit_mode_began_with_is_that_of_all_objects(parts):
    body, left, right, partner = parts
    before = [positions(object.data) for object in (body, left, right)]
    for object in (body, left, right):
        select(object, np.arange(100) if object == left else [])
        object.select_set(object == left)
    bpy.context.view_layer.objects.active = left
    enter("EDIT")
    bpy.ops.transform.translate(value=(0, 0, 0.01))
    assert ops.mirror_edit() == {"FINISHED"}
    with pytest.raises(RuntimeError, match="Nothing is remembered or edited"):
        ops.mirror_edit()
    enter("OBJECT")
    change = np.linalg.norm(positions(right.data) - before[2], axis=1)
    assert np.allclose(change[partner[:50]], 0.01, rtol=0.1)
    assert np.array_equal(positions(body.data), before[0])


def test_a_hidden_object_is_left_alone_and_named(parts, capfd):
    body, left, right, _ = parts
    before = positions(right.data)
    module("mesh_data").set_shown_positions(left, 1.1 * positions(left.data))
    right.hide_set(True)
    assert 'Left alone: "right" (hidden)' in said(capfd, ops.symmetrize, direction="LEFT_TO_RIGHT")
    assert np.array_equal(positions(right.data), before)
    assert "hidden" not in said(capfd, ops.exchange_sides)
    ops.exchange_sides()
    right.hide_set(False)
    assert "hidden" not in said(capfd, ops.symmetrize, direction="LEFT_TO_RIGHT")
    assert not np.array_equal(positions(right.data), before)


def test_keys_that_only_other_objects_have(parts):
    """The active one has none. Then the map does not fit after an edit, and the tool does not need it."""
    body, left, right, _ = parts
    _swell(left, "Swell.L", np.arange(100), 0.01)
    assert ops.mirror_shape_keys(all_keys=True) == {"FINISHED"}
    assert right.data.shape_keys.key_blocks.keys() == ["Basis", "Swell.R"] and body.data.shape_keys is None
    for object in (body, right):
        object.select_set(False)
    bpy.context.view_layer.objects.active = left
    edit_faces(left, range(5))
    bpy.ops.mesh.delete(type="VERT")
    enter("OBJECT")
    bpy.context.view_layer.objects.active = body
    assert ops.remember() == {"FINISHED"}
    assert body.data.shape_keys is None


def test_objects_without_vertices(parts):
    """Blender does not join their groups, of which one is active."""
    enter("EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.delete(type="VERT")
    enter("OBJECT")
    bpy.context.view_layer.objects.active = parts[1]
    parts[1].vertex_groups.new(name="Eye.L")
    with pytest.raises(RuntimeError, match="^Error: (?!Python)"):
        ops.mirror_vertex_groups()


def test_an_object_that_has_lost_a_part_of_the_map_gets_it(parts):
    """Also where the joined map is as it was."""
    right = parts[2]
    right.data.attributes.remove(right.data.attributes["sym_confidence"])
    with module("assembly").whole(list(parts[:3])):
        pass
    assert "sym_confidence" in right.data.attributes and "sym_number_point" not in right.data.attributes


def test_what_is_hidden_is_not_counted(parts, capfd):
    _, left, right, _ = parts
    left.vertex_groups.new(name="Eye.L").add(list(range(100)), 0.5, "ADD")
    module("mesh_data").write_attribute(left.data, "mask", "FLOAT", np.ones(len(left.data.vertices)))
    module("mesh_data").write_attribute(right.data, "mask", "FLOAT", np.zeros(len(right.data.vertices)))
    ops.remember()
    module("mesh_data").set_shown_positions(left, 1.1 * positions(left.data))
    right.hide_set(True)
    assert "0 vertices changed" in said(capfd, ops.mirror_vertex_groups)
    assert "mask: 0 of" in said(capfd, ops.mirror_attribute, name="mask")
    assert "0 vertices moved" in said(capfd, ops.mirror_edit)


def test_symmetrize_on_a_key_makes_it_only_where_it_moves_the_mirror_image(parts):
    body, left, right, _ = parts
    _swell(left, "Swell", np.arange(100), 0.01)
    assert ops.symmetrize() == {"FINISHED"}
    assert body.data.shape_keys is None and right.data.shape_keys.key_blocks.keys() == ["Basis", "Swell"]


def test_weights_are_mirrored_if_any_object_has_them(parts):
    body, left, right, partner = parts
    left.vertex_groups.new(name="Eye.L").add(list(range(100)), 0.5, "ADD")
    assert bpy.context.active_object == body and ops.mirror_vertex_groups() == {"FINISHED"}
    assert right.vertex_groups.keys() == ["Eye.R"] and not body.vertex_groups
    for object in (left, right):
        object.vertex_groups.clear()
    assert not ops.mirror_vertex_groups.poll()


def test_mirror_edit_of_all_objects_in_edit_mode(human):
    """Without Remember Shape: each with the shape that edit mode began with."""
    other = new_object(human.data.copy(), "other")
    human.select_set(True)
    before, hand = positions(human.data), int(np.argmax(attribute(human.data, "sym_side")))
    enter("EDIT")
    bpy.context.view_layer.update()
    for object in (human, other):
        data = bmesh.from_edit_mesh(object.data)
        data.verts.ensure_lookup_table()
        data.verts[hand].co.z += 0.01
        bmesh.update_edit_mesh(object.data)
    assert ops.mirror_edit() == {"FINISHED"}
    enter("OBJECT")
    for object in (human, other):
        assert np.count_nonzero(np.abs(positions(object.data) - before).max(axis=1) > 1e-4) == 2


def test_of_objects_in_edit_mode_those_without_groups_are_named(human, capfd):
    other = _copy_of(human, "other")
    other.vertex_groups.new(name="Arm.L").add([0], 1, "ADD")
    enter("EDIT")
    text = said(capfd, ops.mirror_vertex_groups)
    assert f"{human.name}: The object has no vertex groups" in text and "other: " in text


def _of_faces(mesh, name, kept):
    """An object of some of the faces."""
    object = bpy.data.objects.new(name, mesh.copy())
    bpy.context.scene.collection.objects.link(object)
    data = bmesh.new()
    data.from_mesh(object.data)
    data.faces.ensure_lookup_table()
    bmesh.ops.delete(data, geom=[data.faces[index] for index in np.flatnonzero(~kept)], context="FACES")
    data.to_mesh(object.data)
    data.free()
    object.select_set(True)
    return object


def test_objects_that_touch_are_not_mixed_at_the_seam():
    """Hands cut off at the wrists: what is done to one hand arrives on all of the other, and not on the body."""
    mesh, truth = read_example("human"), truth_of("human")
    points = positions(mesh)
    near = np.linalg.norm(points - points[points[:, 0].argmax()], axis=1) < 0.12 * np.ptp(points[:, 2])
    is_left = np.array([near[face.vertices].all() for face in mesh.polygons])
    is_right = np.array([near[truth[face.vertices]].all() for face in mesh.polygons])
    parts = (("body", ~(is_left | is_right)), ("left", is_left), ("right", is_right))
    body, left, right = (_of_faces(mesh, *part) for part in parts)
    bpy.context.view_layer.objects.active = body
    assert ops.detect(together=True) == {"FINISHED"}
    before = [positions(object.data) for object in (body, left, right)]
    ops.remember()
    module("mesh_data").set_shown_positions(left, before[1] + (0, 0, 0.01))
    assert ops.mirror_edit() == {"FINISHED"}
    assert np.linalg.norm(positions(right.data) - before[2], axis=1).min() > 0.009
    assert np.array_equal(positions(body.data), before[0])


@pytest.mark.parametrize("tool", ["symmetrize", "remember", "symmetrize_exactly"])
def test_objects_that_show_another_key_are_named(parts, tool, capfd):
    body, left, right, _ = parts
    for object in (body, left, right):
        _swell(object, "Swell", np.arange(100), 0.01)
    bpy.context.view_layer.objects.active = body
    assert "another one" not in said(capfd, getattr(ops, tool))
    right.active_shape_key_index = 0
    assert 'the shape key "Swell" in all objects; another one is active in "right"' in said(capfd, getattr(ops, tool))


@pytest.mark.parametrize("tool", ["detect", "clear"])
def test_further_symmetries_of_an_imported_file_go_from_all_objects(parts, tool):
    own, others = "my_side_2", ("sym_vertex_2", "sym_side_3", "_SYM_CONFIDENCE_2")
    for object in parts[:3]:
        for name in (own, *others):
            object.data.attributes.new(name, "FLOAT", "POINT")
    parts[2].hide_set(tool == "clear")
    assert getattr(ops, tool)(**{"together": True} if tool == "detect" else {}) == {"FINISHED"}
    for object in parts[:3]:
        assert own in object.data.attributes and not set(others) & set(object.data.attributes.keys())
