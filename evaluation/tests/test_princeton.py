"""The benchmark's reader, runner and tables, on a data set of two classes of strips."""

import json
import stat
import sys
from pathlib import Path

import numpy as np
import pytest

from evaluation import princeton, princeton_tables
from evaluation.program import write_results

COLUMNS, ROWS = 9, 7

# Answers every mesh with x -> 1 - x; refuses those called wolf unless every map is to be accepted.
PROGRAM = f"""#!{sys.executable}
import json, sys
from pathlib import Path
words = sys.argv[1:]
if words == ["--version"]:
    print("intrinsym 0"), sys.exit()
folder = Path(words[words.index("--output-dir") + 1])
folder.mkdir(exist_ok=True)
for path in [Path(word) for word in words if word.endswith(".off")]:
    count = int(path.read_text().split()[1])
    found = "--plausibility" in words or not path.stem.startswith("wolf")
    partners = [v // {COLUMNS} * {COLUMNS} + {COLUMNS} - 1 - v % {COLUMNS} if found else -1 for v in range(count)]
    report = {{"judged": {{"plausibility": 0.25}}, "seconds": [["one", 0.25], ["two", 0.75]]}}
    (folder / (path.stem + ".map")).write_text("\\n".join(map(str, partners)) + "\\n")
    (folder / (path.stem + ".json")).write_text(json.dumps({{"outcome": "found" if found else "none", "report": report}}))
    (folder / (path.stem + ".png")).write_text("picture")
"""


def strip(path, columns=COLUMNS):
    points = np.array([[column, row, 0.0] for row in range(ROWS) for column in range(columns)]) / (COLUMNS - 1)
    corner = np.array([row * columns + column for row in range(ROWS - 1) for column in range(columns - 1)])
    faces = np.concatenate(
        [np.c_[corner, corner + 1, corner + columns], np.c_[corner + 1, corner + columns + 1, corner + columns]]
    )
    rows = [
        f"{len(points)} {len(faces)} 0",
        *(f"{x} {y} {z}" for x, y, z in points),
        *(f"3 {a} {b} {c}" for a, b, c in faces),
    ]
    path.write_text("OFF\n" + "\n".join(rows) + "\n")


@pytest.fixture
def data(tmp_path):
    """SCAPE with two meshes, TOSCA with cats (one of another vertex count) and a wolf, landmarks 0, 8 and 4."""
    meshes = {"SCAPE": ["mesh000", "mesh001"], "TOSCA": ["cat0", "cat1", "wolf0"]}
    for name, stems in meshes.items():
        for folder in ("Meshes", "Corrs"):
            (tmp_path / "data" / name / folder).mkdir(parents=True)
        for stem in stems:
            strip(tmp_path / "data" / name / "Meshes" / f"{stem}.off")
    strip(tmp_path / "data" / "TOSCA" / "Meshes" / "cat11.off", COLUMNS + 1)
    for name, classes in {"SCAPE": ["1"], "TOSCA": ["cat", "wolf"]}.items():
        for mesh_class in classes:
            stem = tmp_path / "data" / name / "Corrs" / mesh_class
            stem.with_suffix(".pid").write_text("0 1 0 0\n8 1 0 0\n4 1 0 0\n30 1 0 0\n")
            Path(f"{stem}.sym.info").write_text("0 1\n2\n")
    return tmp_path / "data"


@pytest.fixture
def program(tmp_path):
    path = tmp_path / "program"
    path.write_text(PROGRAM)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def test_landmarks_and_meshes_are_read(data):
    entries = princeton.benchmark(data, "TOSCA")
    assert [entry.path.stem for entry in entries] == ["cat0", "cat1", "wolf0"]  # cat11 was cut open
    assert [entry.mesh_class for entry in entries] == ["cat", "cat", "wolf"]
    assert entries[0].points.tolist() == [0, 8, 4] and entries[0].images.tolist() == [8, 0, 4]


def test_the_benchmark_is_run_and_printed(data, program, tmp_path, monkeypatch, capsys):
    out, pictures = tmp_path / "out.json", tmp_path / "pictures"
    words = [str(data), "--program", str(program), "--out", str(out), "--pictures", str(pictures)]
    monkeypatch.setattr(sys, "argv", ["princeton", *words])
    princeton.main()
    result = json.loads(out.read_text())
    default, every = result["default"], princeton_tables.every_map(result)
    assert (
        len(default) == len(every) == 5
        and len(result["refused, accepted"]) == 1
        and result["program"].startswith("intrinsym 0")
    )
    wolf = [row for row in default if row["name"] == "wolf0"][0]
    assert not wolf["found"] and wolf["correspondence_rate"] == 0 and wolf["mean_error"] is None
    assert all(row["mean_error"] == 0 and row["turned_share"] == 1 for row in every)
    printed = capsys.readouterr().out
    assert (
        "| TOSCA | 85.0 / 76 | 98.0 / 98.7 | 95.1 / 92.6 | 94.5 / 100 | 97.8 / 100 | 98.1 / 100 | 66.67 / 66.7 | 100.00 / 100.0 |"
        in printed
    )
    assert "| wolf | 100 | 100 | 100 | 100 | 100 | 100 | 0.00 | 100.00 |" in printed
    assert "| wolf0 | 0.0000 | 100.0 | 25 % | refused |" in printed
    assert len(list(pictures.glob("*.png"))) == 5
    # What was written and what is printed from it again are the same.
    assert princeton_tables.full_report(result) in printed
    again = tmp_path / "again.json"
    write_results(again, result)
    assert again.read_text() == out.read_text()


def test_a_folder_without_the_data_is_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["princeton", str(tmp_path), "--out", str(tmp_path / "out.json")])
    with pytest.raises(SystemExit):
        princeton.main()
    assert "holds no SCAPE/Meshes" in capsys.readouterr().err


def test_a_program_that_fails_is_an_error(data, tmp_path):
    program = tmp_path / "fails"
    program.write_text("#!/bin/sh\necho broken >&2\nexit 2\n")
    program.chmod(0o755)
    with pytest.raises(RuntimeError, match="broken"):
        princeton.run(str(program), princeton.benchmark(data, "SCAPE"), [], 1)


def test_refused_meshes_come_first_among_the_worst():
    row = lambda name, found, error: {"name": name, "found": found, "mean_error": error}
    rows = [row("a", True, 0.1), row("b", True, 0.3), row("c", False, None)]
    assert [row["name"] for row in princeton_tables.worst_first(rows)] == ["c", "b", "a"]
