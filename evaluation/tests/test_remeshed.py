"""The judge of the remeshed sets, on a strip whose mirror map and distances are known."""

import stat
from dataclasses import asdict

import numpy as np
import pytest

from evaluation import remeshed

COLUMNS, ROWS = 21, 21


@pytest.fixture
def strip(tmp_path):
    """A square grid of unit area over x in 0..1, its truth (x to 1 - x), and its file in the data set's layout."""
    points = np.array([[column, row, 0.0] for row in range(ROWS) for column in range(COLUMNS)]) / (COLUMNS - 1)
    corner = np.array([row * COLUMNS + column for row in range(ROWS - 1) for column in range(COLUMNS - 1)])
    faces = np.concatenate([np.c_[corner, corner + 1, corner + COLUMNS], np.c_[corner + 1, corner + COLUMNS + 1, corner + COLUMNS]])
    index = np.arange(len(points))
    truth = index // COLUMNS * COLUMNS + (COLUMNS - 1 - index % COLUMNS)
    folder = tmp_path / "SET" / "vtx_5k"
    (folder / "corres").mkdir(parents=True)
    rows = [f"{len(points)} {len(faces)} 0", *(f"{x} {y} {z}" for x, y, z in points), *(f"3 {a} {b} {c}" for a, b, c in faces)]
    (folder / "strip.off").write_text("OFF\n" + "\n".join(rows) + "\n")
    np.savetxt(folder / "corres" / "strip.vts", index + 1, fmt="%d")
    np.savetxt(folder / "corres" / "strip.sym.vts", truth + 1, fmt="%d")
    return folder / "strip.off", truth


def test_the_truth_has_no_error(strip):
    mesh, truth = strip
    assert remeshed.mean_error(mesh, truth) == 0


def test_one_column_beside_the_truth_is_one_edge_away(strip):
    mesh, truth = strip
    beside = np.where(truth % COLUMNS > 0, truth - 1, truth + 1)
    assert remeshed.mean_error(mesh, beside) == pytest.approx(1 / (COLUMNS - 1))


def test_the_identity_is_far_from_the_truth_and_no_partner_costs_one(strip):
    mesh, truth = strip
    assert remeshed.mean_error(mesh, np.arange(len(truth))) == pytest.approx(0.5, abs=0.05)
    assert remeshed.mean_error(mesh, np.full(len(truth), -1)) == remeshed.NO_PARTNER_ERROR


@pytest.mark.parametrize("status, row", [(0, "| SET | 1 | 1 | 0 | 0.0000 | 0.0000 | 0.75 |"), (1, "| SET | 1 | 0 | 0 | - | - | 0.75 |")])
def test_a_program_is_run_and_judged(strip, tmp_path, status, row):
    mesh, truth = strip
    answer = tmp_path / "answer.map"
    np.savetxt(answer, truth, fmt="%d")
    program = tmp_path / "program"
    report = '"report": {"judged": {"plausibility": 0.75}, "seconds": [["a", 0.25], ["b", 0.5]]}'
    outcome = "found" if status == 0 else "none"
    program.write_text(
        f"#!/bin/sh\ncp {answer} $4/strip.map\necho '{{\"outcome\": \"{outcome}\", {report}}}' > $4/strip.json\nexit {status}\n"
    )
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    result = remeshed.measure(str(program), mesh, [])
    assert (result.set, result.name, result.found, result.seconds) == ("SET", "strip", status == 0, 0.75)
    assert result.error == (0 if status == 0 else None)
    assert row in remeshed.table([asdict(result)])
    assert ("Without an answer: `strip` (plausibility 75 %)" in remeshed.unanswered_or_wrong([asdict(result)])) == (status == 1)


def test_a_program_that_fails_is_an_error(strip, tmp_path):
    program = tmp_path / "program"
    program.write_text("#!/bin/sh\necho broken >&2\nexit 2\n")
    program.chmod(0o755)
    with pytest.raises(RuntimeError, match="broken"):
        remeshed.measure(str(program), strip[0], [])
