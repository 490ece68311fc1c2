# SPDX-License-Identifier: GPL-3.0-or-later
"""The stored map: undo, staleness, saving."""

import bmesh
import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, new_object, read_example, select, selected

detect = bpy.ops.intrinsic_symmetry.detect


def test_undo_and_redo():
    new_object(read_example("quadruped"), "undone")
    bpy.ops.ed.undo_push(message="before")
    detect("EXEC_DEFAULT", True)
    assert "sym_vertex" in bpy.data.objects["undone"].data.attributes
    bpy.ops.ed.undo()
    mesh = bpy.data.objects["undone"].data
    assert "sym_vertex" not in mesh.attributes and module("stored_map").RECORD not in mesh
    bpy.ops.ed.redo()
    mesh = bpy.data.objects["undone"].data
    assert module("stored_map").load(mesh).partner.min() >= 0


@pytest.mark.parametrize("tool", ["detect", "clear"])
def test_further_symmetries_of_an_imported_file_go(quadruped, tool):
    others = "sym_vertex_2", "sym_confidence_12", "sym_side_3", "_SYM_VERTEX_2", "_SYM_SIDE_3"
    own = "sym_vertex_2b", "my_sym_side_2", "_SYM_VERTEX"
    for name in (*others, *own):
        quadruped.data.attributes.new(name, "FLOAT", "POINT")
    assert getattr(bpy.ops.intrinsic_symmetry, tool)() == {"FINISHED"}
    left = set(quadruped.data.attributes.keys())
    assert not left & set(others) and left >= set(own) and ("sym_corner_2" in left) is (tool == "detect")


#: Layers of a user's that have names of the map.
TAKEN = {"sym_side": ("FLOAT_COLOR", "CORNER"), "sym_index": ("FLOAT", "FACE"), "sym_edit": ("FLOAT_COLOR", "POINT")}


@pytest.mark.parametrize("name", [*TAKEN, "sym_image"])
def test_a_layer_that_has_a_name_of_the_map_stays(name):
    bpy.ops.mesh.primitive_monkey_add()
    mesh = bpy.context.object.data
    if name in TAKEN:
        mesh.attributes.new(name, *TAKEN[name])
    else:
        mesh.uv_layers.new(name=name)
    kind = mesh.attributes[name].data_type, mesh.attributes[name].domain
    with pytest.raises(RuntimeError, match=f'"{name}" is needed for the symmetry: rename it'):
        bpy.ops.intrinsic_symmetry.detect()
    assert (mesh.attributes[name].data_type, mesh.attributes[name].domain) == kind
    assert not [other for other in mesh.attributes.keys() if other.startswith("sym_") and other != name]
    mesh.attributes[name].name = "mine"
    assert bpy.ops.intrinsic_symmetry.detect() == {"FINISHED"} and "mine" in mesh.attributes


@pytest.mark.parametrize("name, kind", [
    ("sym_moved", "FLOAT"), ("sym_moved", "FLOAT_VECTOR"), ("sym_edit", "INT"), ("sym_place", "FLOAT_VECTOR"), ("sym_side", "INT"),
    ("sym_confidence", "FLOAT"), ("sym_record", "INT"),
])
def test_a_layer_of_the_map_s_own_kind_stays_on_a_mesh_without_map(name, kind):
    bpy.ops.mesh.primitive_monkey_add()
    mesh = bpy.context.object.data
    values = np.arange(len(mesh.vertices) * (3 if kind == "FLOAT_VECTOR" else 1)).reshape(len(mesh.vertices), -1).squeeze()
    module("mesh_data").write_attribute(mesh, name, kind, values)
    with pytest.raises(RuntimeError, match=f'"{name}" is needed for the symmetry: rename it'):
        detect()
    assert bpy.ops.intrinsic_symmetry.remember() == {"FINISHED"} and bpy.ops.intrinsic_symmetry.clear() == {"FINISHED"}
    assert np.array_equal(attribute(mesh, name), values)
    mesh.attributes[name].name = "mine"
    assert detect() == detect() == {"FINISHED"} and np.array_equal(attribute(mesh, "mine"), values)


@pytest.mark.parametrize("name, kind, domain", [
    ("sym_edit", "FLOAT2", "CORNER"), ("sym_lift", "INT", "FACE"), ("sym_lift", "FLOAT", "POINT"), ("sym_moved", "FLOAT", "POINT"),
    ("sym_remembered", "FLOAT", "FACE"),
])
def test_a_layer_that_gets_a_name_of_the_map_after_the_detection_stays(human, name, kind, domain):
    human.data.attributes.new(name, kind, domain)
    select(human, np.flatnonzero(attribute(human.data, "sym_side") == 1)[:20])
    enter("EDIT")
    bpy.ops.mesh.subdivide()
    enter("OBJECT")
    for tool in (bpy.ops.intrinsic_symmetry.mirror_edit, bpy.ops.intrinsic_symmetry.symmetrize_topology, detect):
        if tool.poll():
            with pytest.raises(RuntimeError, match=f'"{name}" is needed for the symmetry: rename it') as problem:
                tool()
            assert "Traceback" not in str(problem.value)
    assert human.data.attributes[name].data_type == kind and human.data.attributes[name].domain == domain
    human.data.attributes[name].name = "mine"
    assert bpy.ops.intrinsic_symmetry.symmetrize_topology() == {"FINISHED"} and "mine" in human.data.attributes


def test_what_was_remembered_without_a_map_can_be_removed(human):
    bpy.ops.intrinsic_symmetry.clear()
    assert not bpy.ops.intrinsic_symmetry.clear.poll()
    bpy.ops.intrinsic_symmetry.remember()
    assert bpy.ops.intrinsic_symmetry.clear() == {"FINISHED"}
    assert "sym_remembered" not in human.data.attributes and not bpy.ops.intrinsic_symmetry.clear.poll()


@pytest.mark.parametrize("name", ["sym_vertex", "sym_confidence", "sym_remembered"])
def test_a_vertex_group_that_has_a_name_of_the_map_keeps_its_weights(human, name):
    remembered = name == "sym_remembered"
    if remembered:
        assert bpy.ops.intrinsic_symmetry.remember() == {"FINISHED"}
    human.vertex_groups.new(name=name).add([0, 7], 0.5, "REPLACE")
    tools = bpy.ops.intrinsic_symmetry
    for tool in (tools.detect, tools.clear, *([tools.remember] if remembered else [])):
        with pytest.raises(RuntimeError, match=f'vertex group "{name}" is needed for the symmetry: rename it'):
            tool()
    assert human.vertex_groups[name].weight(7) == 0.5
    human.vertex_groups[name].name = "mine"
    assert tools.clear() == {"FINISHED"} and human.vertex_groups["mine"].weight(7) == 0.5


@pytest.mark.parametrize("name", ["sym_edit", "sym_side_2", "sym_remembered"])
def test_remove_symmetry_leaves_layers_of_the_user(human, name):
    human.data.uv_layers.new(name=name)
    if name == "sym_remembered":
        with pytest.raises(RuntimeError, match='UV map "sym_remembered" is needed'):
            bpy.ops.intrinsic_symmetry.remember()
    assert bpy.ops.intrinsic_symmetry.clear() == {"FINISHED"}
    assert [other for other in human.data.attributes.keys() if other.startswith("sym_")] == [name]


def test_numbers_of_an_imported_ply_file_are_replaced(human):
    """Blender reads them all as floats."""
    bpy.ops.intrinsic_symmetry.clear()
    for name in ("sym_vertex", "sym_confidence", "sym_side"):
        human.data.attributes.new(name, "FLOAT", "POINT")
    assert bpy.ops.intrinsic_symmetry.detect() == {"FINISHED"}


def test_undo_in_edit_mode(human):
    side = attribute(human.data, "sym_side")
    left = np.flatnonzero(side == 1)[:20]
    select(human, left)
    enter("EDIT")
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.intrinsic_symmetry.select("EXEC_DEFAULT", True)
    assert not set(selected(bpy.context.object)) & set(left)
    bpy.ops.ed.undo()
    assert set(selected(bpy.context.object)) == set(left)


def _state(object_name):
    """What the tools would use: sides, confidences and the line; nothing without a map."""
    object = bpy.data.objects[object_name]
    mode = object.mode
    usable = bpy.ops.intrinsic_symmetry.select_line.poll()
    enter("OBJECT")
    try:
        if not usable:
            return None
        stored_map = module("stored_map")
        symmetry, record = stored_map.load(object.data), object.data[stored_map.RECORD]
        lines = stored_map.fixed_lines(object.data)
        return symmetry.side.tolist(), symmetry.confidence.tolist(), record["mean_confidence"], str(lines)
    finally:
        enter(mode)


def test_each_map_comes_back_by_undo_and_redo_in_edit_mode():
    object = new_object(read_example("quadruped"), "undone")
    for vertex in object.data.vertices:
        vertex.co.z += 0.02 * vertex.co.x
    enter("EDIT")
    operators = bpy.ops.intrinsic_symmetry
    steps = [
        lambda: None,
        lambda: operators.detect(),
        lambda: operators.exchange_sides(),
        lambda: (bpy.ops.mesh.select_all(action="SELECT"), bpy.ops.transform.resize(value=(1, 1, 1.4))),
        lambda: operators.detect(),
        lambda: operators.clear(),
        lambda: operators.detect(),
    ]
    states = []
    for step in steps:
        step()
        bpy.ops.ed.undo_push(message="step")
        states.append(_state("undone"))
    assert states[0] is None and states[5] is None
    different = [str(states[index]) for index in (1, 2, 4)]
    assert len(set(different)) == 3 and "None" not in different
    for state in reversed(states[:-1]):
        bpy.ops.ed.undo()
        assert bpy.context.object.mode == "EDIT"
        assert _state("undone") == state
    for state in states[1:]:
        bpy.ops.ed.redo()
        assert _state("undone") == state


def test_undo_from_object_mode_back_into_edit_mode():
    new_object(read_example("quadruped"), "undone")
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.object.mode_set("EXEC_DEFAULT", True, mode="EDIT")
    for operator in (bpy.ops.intrinsic_symmetry.detect, bpy.ops.intrinsic_symmetry.exchange_sides):
        operator("EXEC_DEFAULT", True)
    before = _state("undone")
    bpy.ops.object.mode_set("EXEC_DEFAULT", True, mode="OBJECT")
    bpy.ops.intrinsic_symmetry.exchange_sides("EXEC_DEFAULT", True)
    assert _state("undone") != before
    for _ in range(2):
        bpy.ops.ed.undo()
    assert bpy.context.object.mode == "EDIT"
    assert _state("undone") == before


def _cut_one_edge(object):
    """So that the map cannot be carried either; see test_carry."""
    object.data.attributes.remove(object.data.attributes["sym_mixed"])
    data = bmesh.new()
    data.from_mesh(object.data)
    data.edges.ensure_lookup_table()
    bmesh.ops.subdivide_edges(data, edges=[data.edges[0]], cuts=1)
    data.to_mesh(object.data)
    data.free()


@pytest.mark.parametrize("operator", ["select", "select_line", "symmetrize", "exchange_sides"])
def test_a_stale_map_is_refused(quadruped, mode, operator):
    _cut_one_edge(quadruped)
    enter(mode)
    with pytest.raises(RuntimeError, match="Detect again"):
        getattr(bpy.ops.intrinsic_symmetry, operator)()
    assert detect() == {"FINISHED"}
    assert bpy.ops.intrinsic_symmetry.select_line() == {"FINISHED"}


def test_a_flipped_diagonal_is_noticed(quadruped):
    quadruped.data.attributes.remove(quadruped.data.attributes["sym_mixed"])
    data = bmesh.new()
    data.from_mesh(quadruped.data)
    inner = next(edge for edge in data.edges if len(edge.link_faces) == 2)
    bmesh.ops.rotate_edges(data, edges=[inner])
    data.to_mesh(quadruped.data)
    data.free()
    with pytest.raises(RuntimeError, match="other vertices or faces"):
        bpy.ops.intrinsic_symmetry.select_line()


def test_changed_attributes_are_noticed(quadruped):
    quadruped.data.attributes["sym_vertex"].data[0].value = 1
    with pytest.raises(RuntimeError, match="changed by an edit"):
        bpy.ops.intrinsic_symmetry.select_line()
    quadruped.data.attributes.remove(quadruped.data.attributes["sym_bary"])
    with pytest.raises(RuntimeError, match="Detect first"):
        bpy.ops.intrinsic_symmetry.select_line()


def test_moved_vertices_do_not_make_a_map_stale(quadruped, mode):
    for vertex in quadruped.data.vertices:
        vertex.co.z += 0.1 * vertex.co.x
    enter(mode)
    assert bpy.ops.intrinsic_symmetry.select_line() == {"FINISHED"}


def test_the_stored_map_is_the_detected_one(quadruped):
    stored_map, detection = module("stored_map"), module("detection")
    object = new_object(read_example("quadruped"))
    core_mesh = detection.core_mesh_of(object, "BASE", bpy.context.evaluated_depsgraph_get())
    found = core_mesh.detect()[0]
    stored = stored_map.load(quadruped.data)
    assert np.array_equal(stored.partner, found.partner)
    assert np.array_equal(stored.confidence, found.confidence)
    assert np.array_equal(np.abs(stored.side), np.abs(found.side))
    assert np.array_equal(stored.surface_points.barycentrics, found.surface_points.barycentrics)
    lines = stored_map.fixed_lines(quadruped.data)
    assert [line.closed for line in lines] == [line.closed for line in found.fixed_curve]
    for line, curve in zip(lines, found.fixed_curve):
        assert np.allclose(line.positions(core_mesh.vertices), curve.positions(core_mesh.vertices))


def test_a_line_in_many_pieces_has_no_more_names_in_the_record(quadruped):
    stored_map, mesh = module("stored_map"), quadruped.data
    names, lines = set(mesh[stored_map.RECORD].keys()), stored_map.fixed_lines(mesh)
    symmetry = stored_map.load(mesh)
    symmetry.fixed_curve = 100 * lines
    core_mesh = module("detection").core_mesh_of(quadruped, "BASE", None)
    stored_map.store(mesh, core_mesh, symmetry)
    # Blender takes each new name past all that are there: thousands of loose shells took seconds.
    assert set(mesh[stored_map.RECORD].keys()) <= names
    stored = stored_map.fixed_lines(mesh)
    assert [line.closed for line in stored] == 100 * [line.closed for line in lines]
    for line, own in zip(stored, 100 * lines):
        assert np.array_equal(line.edges, own.edges) and np.array_equal(line.parameters, own.parameters)


def test_it_survives_saving(quadruped, tmp_path):
    file = str(tmp_path / "saved.blend")
    before = attribute(quadruped.data, "sym_vertex")
    lines = len(module("stored_map").fixed_lines(quadruped.data))
    name = quadruped.name
    bpy.ops.wm.save_as_mainfile(filepath=file)
    bpy.ops.wm.open_mainfile(filepath=file)
    object = bpy.data.objects[name]
    bpy.context.view_layer.objects.active = object
    assert np.array_equal(module("stored_map").load(object.data).partner, before)
    assert len(module("stored_map").fixed_lines(object.data)) == lines
    assert bpy.ops.intrinsic_symmetry.select_line() == {"FINISHED"}
    with pytest.raises(RuntimeError, match="since Blender was started"):
        bpy.ops.intrinsic_symmetry.choose(index=1)
