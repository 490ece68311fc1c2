# SPDX-License-Identifier: GPL-3.0-or-later
"""Detect, and what it keeps on the mesh."""

import re
import threading
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from conftest import EXAMPLES, attribute, enter, module, new_object, positions, read_example, said

detect = bpy.ops.intrinsic_symmetry.detect


def test_the_posed_human_is_paired_exactly(human, truth):
    mesh = human.data
    assert np.array_equal(attribute(mesh, "sym_vertex"), truth)
    assert attribute(mesh, "sym_confidence").mean() > 0.9
    side = attribute(mesh, "sym_side")
    assert np.array_equal(side[truth], -side)
    assert positions(mesh)[side == 1, 0].mean() > positions(mesh)[side == -1, 0].mean()


def test_a_symmetry_that_is_not_sure_is_called_so():
    found = SimpleNamespace(kind=1, mean_confidence=0.5, exact_share=0.0, plausibility=0.62)
    about = module("ops_detect").about
    assert about(found).endswith("mean confidence 0.50, 62% plausible")
    found.plausibility = 0.97
    assert about(found).endswith("mean confidence 0.50")


def test_exact_points_lie_on_the_faces_that_are_named(quadruped):
    mesh = quadruped.data
    faces, bary = attribute(mesh, "sym_face"), attribute(mesh, "sym_bary")
    corners = np.stack([attribute(mesh, f"sym_corner_{k}") for k in range(3)], axis=1)
    assert np.allclose(bary.sum(axis=1), 1, atol=1e-5)
    for vertex in range(0, len(faces), 97):
        assert set(corners[vertex]) <= set(mesh.polygons[faces[vertex]].vertices)


def test_it_runs_in_both_modes_and_comes_back(mode):
    object = new_object(read_example("quadruped"))
    enter(mode)
    assert detect() == {"FINISHED"}
    assert object.mode == mode
    enter("OBJECT")
    assert attribute(object.data, "sym_vertex").min() >= 0


def test_every_source_of_positions():
    object = new_object(read_example("quadruped"))
    object.shape_key_add(name="Basis")
    object.shape_key_add(name="Other")
    object.active_shape_key_index = 1
    object.modifiers.new("wave", "WAVE").height = 0.01
    for source in ("BASE", "KEY", "EVALUATED"):
        assert detect(source=source) == {"FINISHED"}, source


def test_evaluated_positions_of_another_number_of_vertices_are_refused():
    object = new_object(read_example("quadruped"))
    object.modifiers.new("subdivide", "SUBSURF").levels = 1
    with pytest.raises(RuntimeError, match="turn 3398 vertices into"):
        detect(source="EVALUATED")
    assert detect(source="BASE") == {"FINISHED"}


def test_no_symmetry_is_an_answer_and_leaves_the_mesh_alone():
    rng = np.random.default_rng(1)
    mesh = bpy.data.meshes.new("loose triangles")
    points = (rng.random((200, 1, 3)) + 0.05 * rng.random((200, 3, 3))).reshape(-1, 3)
    mesh.from_pydata(points.tolist(), [], np.arange(600).reshape(-1, 3).tolist())
    object = new_object(mesh)
    assert detect() == {"CANCELLED"}
    assert "sym_vertex" not in object.data.attributes


def test_a_doubtful_symmetry_is_kept_and_called_so():
    object = new_object(read_example("quadruped"))
    preferences = bpy.context.preferences.addons[module("preferences").__package__].preferences
    preferences.plausibility = 100
    try:
        assert detect() == {"FINISHED"}
    finally:
        preferences.property_unset("plausibility")
    assert attribute(object.data, "sym_vertex").min() >= 0
    _, found = module("detection").remembered(object.data)
    said = module("ops_detect").in_words(found)
    assert said.startswith("Doubtful: Reflection") and "100 % of the surface has a partner" in said
    assert object.data[module("undo").RECORD]["doubtful"]
    show = module("overlay").settings(bpy.context)
    assert show.colours == "CONFIDENCE"
    show.colours = "NONE"


def test_poll_says_what_is_missing():
    with pytest.raises(RuntimeError, match="Needs an active mesh object"):
        detect()
    new_object(read_example("quadruped"))
    with pytest.raises(RuntimeError, match="Detect the symmetry first"):
        bpy.ops.intrinsic_symmetry.select()


def test_the_library_s_errors_are_shown():
    """Without its advice on exported files."""
    shapes = {
        "no vertices": ([], []),
        "no faces, only vertices": ([(0, 0, 0)], []),
        "one line or in one point": ([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]),
    }
    for words, (vertices, faces) in shapes.items():
        mesh = bpy.data.meshes.new("bad")
        mesh.from_pydata(vertices, [], faces)
        new_object(mesh)
        with pytest.raises(RuntimeError, match=f"(?i)the mesh cannot be used: .*{words}$"):
            detect()
    mesh = bpy.data.meshes.new("not a number")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, float("nan"), 0)], [], [(0, 1, 2)])
    new_object(mesh)
    with pytest.raises(RuntimeError, match="vertex 2"):
        detect()


@pytest.mark.parametrize("model", ["/nowhere/network.onnx", __file__, str(EXAMPLES)])
@pytest.mark.parametrize("body", ["quadruped", "human"])
def test_preferences_reach_the_library(body, model):
    """Also where the connectivity is mirrored, and no network is needed."""
    preferences = bpy.context.preferences.addons[module("preferences").__package__].preferences
    new_object(read_example(body))
    preferences.model = model
    try:
        with pytest.raises(RuntimeError, match=re.escape(model)):
            detect()
    finally:
        preferences.model = ""
    preferences.symmetries = 3
    try:
        arguments = module("preferences").detect_arguments(bpy.context)
    finally:
        preferences.property_unset("symmetries")
    assert arguments["symmetries"] == 3 and "model" not in arguments


def test_one_of_several_symmetries_can_be_chosen():
    preferences = bpy.context.preferences.addons[module("preferences").__package__].preferences
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=24, y_subdivisions=16, size=2)
    object = bpy.context.object
    object.scale = (1, 1, 1)
    for vertex in object.data.vertices:  # a rectangle, bent
        vertex.co = (1.5 * vertex.co.x, vertex.co.y, 0.2 * vertex.co.x * vertex.co.x)
    preferences.symmetries = 4
    try:
        assert detect() == {"FINISHED"}
    finally:
        preferences.property_unset("symmetries")
    first = attribute(object.data, "sym_vertex")
    assert bpy.ops.intrinsic_symmetry.choose(index=2) == {"FINISHED"}
    assert not np.array_equal(first, attribute(object.data, "sym_vertex"))
    with pytest.raises(RuntimeError, match="no symmetry 16"):
        bpy.ops.intrinsic_symmetry.choose(index=16)


def test_what_was_found_on_a_mesh_that_is_gone_is_forgotten():
    first = new_object(read_example("human_shells"))
    assert detect() == {"FINISHED"}
    number = first.data.session_uid
    assert number in module("detection")._found
    bpy.data.meshes.remove(first.data)
    second = new_object(read_example("human_shells"))
    assert detect() == {"FINISHED"}
    assert number not in module("detection")._found and module("detection").remembered(second.data)


def test_sides_can_be_exchanged_and_the_map_removed(human, mode):
    before = attribute(human.data, "sym_side")
    enter(mode)
    assert bpy.ops.intrinsic_symmetry.exchange_sides() == {"FINISHED"}
    enter("OBJECT")
    assert np.array_equal(attribute(human.data, "sym_side"), -before)
    enter(mode)
    assert bpy.ops.intrinsic_symmetry.select_line() == {"FINISHED"}  # the map is still accepted
    assert bpy.ops.intrinsic_symmetry.clear() == {"FINISHED"}
    enter("OBJECT")
    assert not [a.name for a in human.data.attributes if a.name.startswith("sym_")]
    assert not bpy.ops.intrinsic_symmetry.clear.poll()


def test_a_job_can_be_watched_and_cancelled():
    import intrinsym

    detection = module("detection")
    object = new_object(read_example("human"))
    job = detection.Job(detection.maker_of(object, "BASE", bpy.context.evaluated_depsgraph_get()), {})
    while job.is_running() and job.fraction == 0:
        pass
    assert job.stage and 0 < job.fraction <= 1
    job.cancel()
    with pytest.raises(intrinsym.CancelledError):
        job.answer()


def test_blender_does_not_wait_while_the_library_makes_the_mesh(monkeypatch):
    detection, threads = module("detection"), []
    make = detection.intrinsym.Mesh

    def made(*arrays):
        threads.append(threading.current_thread())
        return make(*arrays)

    new_object(read_example("quadruped"))
    monkeypatch.setattr(detection.intrinsym, "Mesh", made)
    assert detect() == {"FINISHED"}
    assert len(threads) == 1 and threads[0] is not threading.main_thread()


def test_the_active_attribute_and_color_stay():
    object = new_object(read_example("human"))
    for name, kind in (("first", "FLOAT_COLOR"), ("mine", "FLOAT"), ("second", "FLOAT_COLOR")):
        object.data.attributes.new(name, kind, "CORNER")
    object.data.attributes.active_color_name = "first"
    object.data.attributes.active = object.data.attributes["mine"]
    ops = bpy.ops.intrinsic_symmetry
    for operator in (ops.detect, ops.remember, ops.clear):
        assert operator() == {"FINISHED"}
        assert object.data.attributes.active.name == "mine" and object.data.attributes.active_color_name == "first"


@pytest.mark.parametrize("changed", ["flipped", "loose vertex", "moved"])
def test_a_mesh_that_changed_meanwhile_does_not_get_the_map(quadruped, changed):
    mesh, detection = quadruped.data, module("detection")
    core_mesh = detection.core_mesh_of(quadruped, "BASE", None)
    found = detection.Job(lambda: core_mesh, {}).answer()
    if changed == "flipped":
        mesh.flip_normals()
    elif changed == "loose vertex":
        mesh.vertices.add(1)
    else:
        mesh.vertices[0].co.x += 0.1
    keep = module("ops_detect").keep
    if changed == "moved":
        assert "Reflection" in keep(quadruped, core_mesh, found)
    else:
        with pytest.raises(module("mesh_data").MeshProblem, match="Detect again"):
            keep(quadruped, core_mesh, found)


@pytest.mark.parametrize("place", [1e10, 1e20, 3e38])
def test_a_vertex_far_from_all_others_is_named(human, place):
    human.data.vertices[5].co.x = place
    ops = bpy.ops.intrinsic_symmetry
    for tool in (ops.detect, ops.symmetrize_exactly, ops.select_asymmetric):
        with pytest.raises(RuntimeError, match="ertex 5 is (too far|over a hundred million).* move or delete it") as refusal:
            tool()
        assert "Traceback" not in str(refusal.value)


def test_issue_38_a_mirror_modifier_is_a_warning(capfd):
    """The other half is no part of the mesh."""
    object = new_object(read_example("human"))
    object.modifiers.new("Mirror", "MIRROR")
    words = said(capfd, detect)
    assert "Warning: Reflection" in words and '"object" has a Mirror modifier' in words
