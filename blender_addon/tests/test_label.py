# SPDX-License-Identifier: GPL-3.0-or-later
"""Correct and label."""

import hashlib
import json
import struct

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, new_object, read_example

ops = bpy.ops.intrinsic_symmetry


@pytest.fixture
def studied(human):
    assert ops.study() == {"FINISHED"}
    yield human
    bpy.context.window_manager.intrinsic_symmetry_show.colours = "NONE"


def test_the_network_is_right_about_the_human(studied, truth):
    """Each eigenfunction is compared with its mirror image by the exact truth."""
    entries = module("labels").of(studied.data)
    functions = module("eigenfunctions").studied(studied.data).pairs.functions
    assert len(entries) == functions.shape[1] == 12
    for entry, values in zip(entries, functions.T):
        cosine = values @ values[truth] / (values @ values)
        if abs(cosine) > 0.9:
            assert (entry.even > entry.odd) == (cosine > 0)
    assert module("labels").network_says(entries[0]).startswith(("even ", "odd "))


def test_stepping_shows_one_after_another(studied, mode):
    mesh = studied.data
    enter(mode)
    assert mesh.intrinsic_symmetry_eigenfunction == 1
    shown = []
    for _ in range(12):
        shape = module("overlay_data").shape_of(studied, bpy.context.evaluated_depsgraph_get())
        shown.append(module("overlay_data").surface_colours(shape, studied, "EIGENFUNCTION"))
        ops.step()
    assert mesh.intrinsic_symmetry_eigenfunction == 1  # around
    ops.step(by=-1)
    assert mesh.intrinsic_symmetry_eigenfunction == 12
    assert len({colours.tobytes() for colours in shown}) == 12


def test_wrong_signs_spoil_the_map_and_right_ones_rescue_it(studied, truth):
    """The user's word counts: told that the first odd functions are even, the search finds another map or none."""
    mesh = studied.data
    entries = module("labels").of(mesh)
    right = ["EVEN" if entry.even > entry.odd else "ODD" for entry in entries]
    for entry, judgement in zip(entries, right):
        entry.judgement = "ODD" if judgement == "EVEN" else "EVEN"
    known = module("labels").known_signs(mesh)
    assert known == [-1 if judgement == "EVEN" else 1 for judgement in right]
    for number, judgement in enumerate(right, start=1):
        mesh.intrinsic_symmetry_eigenfunction = number
        ops.judge(judgement=judgement)
    assert ops.detect() == {"FINISHED"}
    assert np.array_equal(attribute(mesh, "sym_vertex"), truth)
    assert ops.forget_judgements() == {"FINISHED"}
    assert module("labels").known_signs(mesh) == []


def test_labels_are_saved_as_docs_labels_md_says(studied, tmp_path):
    mesh = studied.data
    ops.judge(judgement="EVEN")
    ops.step()
    ops.judge(judgement="ODD")
    ops.step(by=3)
    ops.judge(judgement="NEITHER")
    assert ops.save_labels(directory=str(tmp_path)) == {"FINISHED"}
    stored = json.loads((tmp_path / "human.labels.json").read_text())
    assert stored["labels"] == {"1": "even", "2": "odd", "5": "neither"}
    assert (stored["format"], stored["version"], stored["mesh"]) == ("intrinsym-labels", 1, "human.ply")
    header, body = (tmp_path / "human.ply").read_bytes().split(b"end_header\n")
    assert b"element vertex 13380\n" in header and b"binary_little_endian" in header
    points = body[: 12 * len(mesh.vertices)]
    faces = np.frombuffer(body[len(points) :], [("count", "u1"), ("corners", "<u4", 3)])
    assert (faces["count"] == 3).all()
    counts = struct.pack("<QQ", len(mesh.vertices), len(faces))
    digest = hashlib.sha256(counts + points + faces["corners"].tobytes()).hexdigest()
    assert stored["mesh_hash"] == "sha256:" + digest


def test_what_is_missing_is_said(tmp_path):
    new_object(read_example("quadruped"))
    for call in (ops.step, ops.judge):
        with pytest.raises(RuntimeError, match="Show Eigenfunctions first"):
            call()
    with pytest.raises(RuntimeError, match="Nothing is judged"):
        ops.save_labels(directory=str(tmp_path))


def test_a_folder_is_needed(studied, tmp_path):
    ops.judge(judgement="EVEN")
    with pytest.raises(RuntimeError, match="no folder"):
        ops.save_labels(directory=str(tmp_path / "nowhere"))
    with pytest.raises(RuntimeError, match="Choose a folder"):
        ops.save_labels(directory="")


def test_judgements_are_saved_with_the_file(studied, tmp_path):
    ops.judge(judgement="ODD")
    name = studied.name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "saved.blend"))
    assert module("labels").known_signs(bpy.data.objects[name].data)[0] == -1
