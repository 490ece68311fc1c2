# SPDX-License-Identifier: GPL-3.0-or-later
"""Export and import of the pairs."""

import csv
import json

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module

ops = bpy.ops.intrinsic_symmetry


def _attributes(mesh):
    return {name: attribute(mesh, name) for name in module("stored_map").KINDS}


@pytest.mark.parametrize("kind", ["csv", "json"])
def test_there_and_back(quadruped, tmp_path, kind, mode):
    """All attributes are those of before, to the last bit; a JSON brings the line, too."""
    mesh, path = quadruped.data, str(tmp_path / f"pairs.{kind}")
    before, lines = _attributes(mesh), module("stored_map").fixed_lines(mesh)
    enter(mode)
    assert ops.export_pairs(filepath=path, file_type=f".{kind}") == {"FINISHED"}
    ops.clear()
    assert ops.import_pairs(filepath=path) == {"FINISHED"}
    enter("OBJECT")
    after = _attributes(mesh)
    for name in before:
        if name != module("undo").NUMBER:
            assert np.array_equal(before[name], after[name]), name
    found = module("stored_map").fixed_lines(mesh)
    assert len(found) == (len(lines) if kind == "json" else 0)
    assert all(np.array_equal(one.edges, two.edges) for one, two in zip(found, lines))
    assert ops.mirror_attribute.poll() and ops.symmetrize() == {"FINISHED"}, "the tools accept the map"


def test_a_table_for_people(human, truth, tmp_path):
    ops.export_pairs(filepath=str(tmp_path / "pairs.csv"))
    rows = list(csv.DictReader((tmp_path / "pairs.csv").open()))
    assert [int(row["partner"]) for row in rows] == truth.tolist()
    assert [int(row["vertex"]) for row in rows] == list(range(len(truth)))
    assert {row["side"] for row in rows} == {"-1", "0", "1"}


@pytest.mark.parametrize("text, kind", [("vertex,partner\n{rows}", "csv"), ("{map}", "map")])
def test_partners_alone_are_enough(human, truth, tmp_path, text, kind):
    """Sides come from the mirror plane: two partners are on two of them, and left is mostly +X."""
    rows = "".join(f"{vertex},{partner}\n" for vertex, partner in reversed(list(enumerate(truth))))
    path = tmp_path / f"mine.{kind}"
    path.write_text(text.format(rows=rows, map="\n".join(map(str, truth))))
    before = attribute(human.data, "sym_side")
    ops.clear()
    assert ops.import_pairs(filepath=str(path)) == {"FINISHED"}
    assert np.array_equal(attribute(human.data, "sym_vertex"), truth)
    side = attribute(human.data, "sym_side")
    assert np.array_equal(side[truth], -side) and (side == 0).sum() == (before == 0).sum()
    assert (side == before).mean() > 0.8
    symmetry = module("stored_map").load(human.data)
    values = np.random.default_rng(0).random(len(truth))
    assert np.allclose(symmetry.mirror_values(values), values[truth])


@pytest.mark.parametrize("name, text, problem", [
    ("pairs.csv", "vertex,partner\n0,0\n", "speaks of 1 vertices"),
    ("pairs.csv", "vertex,other\n0,0\n", "no column partner"),
    ("pairs.csv", "vertex,partner\n1,0\n", "does not count from 0"),
    ("pairs.csv", "vertex,partner\n0,x\n", "The file pairs.csv holds no pairs"),
    ("pairs.json", "{}", "its format is not"),
    ("pairs.json", "[]", "holds no pairs"),
    ("pairs.txt", "", "Pairs are read from .csv, .json and .map, not from pairs.txt"),
])
def test_files_that_are_refused(human, tmp_path, name, text, problem):
    (tmp_path / name).write_text(text)
    before = _attributes(human.data)
    with pytest.raises(RuntimeError, match=problem):
        ops.import_pairs(filepath=str(tmp_path / name))
    assert all(np.array_equal(values, attribute(human.data, name)) for name, values in before.items())


def test_a_mesh_with_other_faces_is_refused(human, tmp_path):
    ops.export_pairs(filepath=str(tmp_path / "pairs.json"), file_type=".json")
    stored = json.loads((tmp_path / "pairs.json").read_text())
    past_the_end = {"partner": [99999999] * stored["vertices"]}
    for changed, problem in (({"connectivity": "0" * 16}, "other faces"), (past_the_end, "99999999")):
        (tmp_path / "pairs.json").write_text(json.dumps(stored | changed))
        with pytest.raises(RuntimeError, match=problem):
            ops.import_pairs(filepath=str(tmp_path / "pairs.json"))
    with pytest.raises(RuntimeError, match='There is no file ".*nowhere.csv"'):
        ops.import_pairs(filepath=str(tmp_path / "nowhere.csv"))


def test_partners_that_do_not_lead_back_are_refused(human, tmp_path):
    count = len(human.data.vertices)
    (tmp_path / "mine.map").write_text("\n".join(str((vertex + 1) % count) for vertex in range(count)))
    before = _attributes(human.data)
    with pytest.raises(RuntimeError, match="Only .*% of the vertices are the partner of their partner"):
        ops.import_pairs(filepath=str(tmp_path / "mine.map"))
    assert all(np.array_equal(values, attribute(human.data, name)) for name, values in before.items())
