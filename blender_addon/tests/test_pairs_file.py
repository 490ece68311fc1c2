# SPDX-License-Identifier: GPL-3.0-or-later
"""Export and import of the pairs."""

import csv
import json

import bpy
import numpy as np
import pytest
from conftest import attribute, enter, module, positions, said

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


@pytest.mark.parametrize("head, row", [
    ("vertex;partner", "{};{}"), ("vertex, partner", "{}, {}"), ("Vertex,Partner", "{},{}"), ("vertex,partner", "{}.0,{}.0"),
])
def test_tables_of_other_programs(human, truth, tmp_path, head, row):
    path = tmp_path / "mine.csv"
    path.write_text("\n".join([head, *(row.format(*pair) for pair in enumerate(truth))]))
    ops.clear()
    assert ops.import_pairs(filepath=str(path)) == {"FINISHED"}
    assert np.array_equal(attribute(human.data, "sym_vertex"), truth)


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
    ("pairs.csv", "vertex,partner\n0,1\n1,0\n1,0\n", "vertex 1 has two rows"),
    ("pairs.csv", "vertex,partner\n0,1\n2,3\n4,5\n", "vertex 1 has no row. Each vertex needs one: both of a pair"),
    ("pairs.csv", "vertex,partner\n0,x\n", "The file pairs.csv holds no pairs"),
    ("pairs.csv", "vertex,partner\n1,0\n\n0,x\n", "line 4, column partner: x is no whole number"),
    ("pairs.csv", "vertex,partner\n0,1\n,0\n", "line 3, column vertex: an empty cell is no whole number"),
    ("pairs.csv", "vertex,partner,confidence\n0,1,high\n", "line 2, column confidence: high is no number"),
    ("pairs.map", "1 0 x", "vertex 2, column partner: x is no whole number"),
    ("pairs.csv", "vertex,partner\n0,1\n1\n", "see line 3"),
    ("pairs.csv", "vertex,partner\n0,0.5\n", "0.5 is no whole number"),
    ("pairs.csv", "vertex,partner\n0\n", "unlike numbers of cells"),
    ("pairs.csv", "vertex,partner\n0,inf\n", "inf is no whole number"),
    ("pairs.json", "{}", "its format is not"),
    ("pairs.json", "[]", "holds no pairs"),
    ("pairs.json", 100_000 * "[", "holds no pairs"),
    ("pairs.txt", "", "Pairs are read from .csv, .json and .map, not from pairs.txt"),
], ids=lambda text: text[:40])
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


def _refused(object, path, text, problem):
    """The file is refused in words, and the map that was there stays."""
    path.write_text(text)
    before = _attributes(object.data)
    with pytest.raises(RuntimeError, match=problem) as refusal:
        ops.import_pairs(filepath=str(path))
    assert "Traceback" not in str(refusal.value)
    assert all(np.array_equal(values, attribute(object.data, name)) for name, values in before.items())


@pytest.mark.parametrize("column, value, problem", [
    ("partner", 13380, "The column partner holds 13380: it goes from -1, for none, to 13379"),
    ("partner", -7, "The column partner holds -7: "),
    ("partner", 10**30, "holds no pairs"),
    ("confidence", "nan", "The column confidence holds nan: it goes from 0 to 1"),
    ("confidence", 7, "The column confidence holds 7.0: "),
    ("side", 300, "The column side holds 300: it goes from -1 to 1"),
    ("face", 99999999, "The column face holds 99999999: it goes from -1, for none, to 13377"),
    ("corner_0", 99999999, "The column corner_0 holds 99999999: "),
    ("weight_0", "nan", "The column weight_0 holds nan: it goes from 0 to 1"),
])
def test_numbers_out_of_range_are_refused(human, tmp_path, column, value, problem):
    path = tmp_path / "pairs.csv"
    ops.export_pairs(filepath=str(path))
    head, *rows = list(csv.reader(path.open()))
    rows[5][head.index(column)] = str(value)
    _refused(human, path, "\n".join(map(",".join, [head, *rows])), problem)


def test_partners_on_one_side_are_refused(human, tmp_path):
    path = tmp_path / "pairs.csv"
    ops.export_pairs(filepath=str(path))
    head, *rows = list(csv.reader(path.open()))
    for row in rows:
        row[head.index("side")] = "1"
    _refused(human, path, "\n".join(map(",".join, [head, *rows])), "Most partners are on the same side")


def test_a_map_that_counts_from_1_is_refused(human, truth, tmp_path):
    _refused(human, tmp_path / "mine.map", "\n".join(map(str, truth + 1)), "holds 13380: .* count from 0")


_LINE = {"edges": [[0, 1]], "parameters": [0.5], "closed": False}


@pytest.mark.parametrize("changed, problem", [
    ({"kind": "banana"}, 'the kind "banana" is none of reflection, half_turn'),
    ({"kind": 3}, 'the kind "3" is none of'),
    ({"lines": 5}, "holds no pairs of vertices: it is damaged, or written in another form"),
    ({"lines": [5]}, "holds no pairs"),
    ({"lines": [_LINE | {"edges": [[0, 99999999]]}]}, "The line between left and right holds the vertex 99999999"),
    ({"lines": [_LINE | {"edges": [[0, -1]]}]}, "The line between left and right holds the vertex -1"),
    ({"lines": [_LINE | {"parameters": [float("nan")]}]}, "The line between left and right"),
    ({"lines": [_LINE | {"parameters": [0.5, 0.5]}]}, "The line between left and right"),
    ({"lines": [{"edges": [[0, 1]]}]}, "holds no pairs"),
])
def test_a_json_with_a_wrong_kind_or_line_is_refused(human, tmp_path, changed, problem):
    path = tmp_path / "pairs.json"
    ops.export_pairs(filepath=str(path), file_type=".json")
    _refused(human, path, json.dumps(json.loads(path.read_text()) | changed), problem)


def test_pairs_at_random_are_refused(quadruped, tmp_path):
    """Each is the partner of its partner, but neighbours have partners that are far apart."""
    count = len(quadruped.data.vertices) // 2 * 2
    one, two = np.random.default_rng(0).permutation(count).reshape(2, -1)
    partner = np.arange(len(quadruped.data.vertices))
    partner[one], partner[two] = two, one
    text = "\n".join(map(str, partner))
    _refused(quadruped, tmp_path / "mine.map", text, "Neighbours have partners that are far from each other")


def test_a_small_mesh_takes_its_pairs(tmp_path):
    """A cube's neighbours are as far apart as any two of its vertices."""
    bpy.ops.mesh.primitive_cube_add()
    places = positions(bpy.context.object.data)
    mirrored = places * (-1, 1, 1)
    partner = np.linalg.norm(places - mirrored[:, None], axis=2).argmin(axis=1)
    (tmp_path / "mine.map").write_text("\n".join(map(str, partner)))
    assert ops.import_pairs(filepath=str(tmp_path / "mine.map")) == {"FINISHED"}


@pytest.mark.parametrize("kind", ["csv", "json", "map"])
def test_files_of_programs_that_mark_their_encoding(human, truth, tmp_path, kind):
    path = tmp_path / f"pairs.{kind}"
    if kind == "map":
        path.write_text("\n".join(map(str, truth)))
    else:
        ops.export_pairs(filepath=str(path), file_type=f".{kind}")
    text = path.read_text()
    if kind == "csv":  # in another order, too
        head, *rows = text.splitlines()
        text = "\n".join([head, *rows[::-1]])
    path.write_text("\ufeff" + text)
    ops.clear()
    assert ops.import_pairs(filepath=str(path)) == {"FINISHED"}
    assert np.array_equal(attribute(human.data, "sym_vertex"), truth)


def test_a_file_of_bytes_is_refused(human, tmp_path):
    (tmp_path / "pairs.csv").write_bytes(b"vertex,partner\n0,\x000\n\r\r")
    with pytest.raises(RuntimeError, match="The file pairs.csv holds no pairs"):
        ops.import_pairs(filepath=str(tmp_path / "pairs.csv"))


@pytest.mark.parametrize("kind", ["csv", "json"])
@pytest.mark.parametrize("name", ["pairs", "pairs.v2"])
def test_a_file_without_an_extension_gets_that_of_its_format(human, tmp_path, name, kind, capfd):
    said_so = said(capfd, ops.export_pairs, filepath=str(tmp_path / name), file_type=f".{kind}")
    assert [file.name for file in tmp_path.iterdir()] == [f"{name}.{kind}"] and f"{name}.{kind}" in said_so
    assert ops.import_pairs(filepath=str(tmp_path / f"{name}.{kind}")) == {"FINISHED"}


def test_a_folder_is_no_file(human, tmp_path):
    with pytest.raises(RuntimeError, match="cannot be written"):
        ops.export_pairs(filepath=f"{tmp_path}/")
    assert not list(tmp_path.iterdir())
