"""The gate on accuracy passes what was recorded, and fails on a spoiled answer."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from evaluation import accuracy, program

FEW = {"animals": {"bird": (1,)}, "plates": {"plate": (4,)}, "assemblies": {"mannequin": (1,)}}
RECORDED = json.loads(accuracy.RECORDED.read_text())["shapes"]


def spoiled(rows, group, factor):
    return [row | {"error": row["error"] * (factor if row["group"] == group else 1)} for row in rows]


def truth_of(case):
    """The best map there is: the true partners."""
    if case.group != "assemblies":
        return np.loadtxt(case.path.with_suffix(".mirror"), dtype=int)
    return accuracy.assemblies.laid_out(accuracy.assemblies.draw("mannequin", 1)[0])[2]["partner"]


def near_truth(partners, rng):
    """The truth with each tenth answer missing."""
    return np.where(rng.random(len(partners)) < 0.1, -1, partners)


def answered_by(monkeypatch, answers):
    """Lets `detect` write these maps, by the name of the mesh."""

    def detect(_, meshes, folder, options, jobs=1):
        folder.mkdir()
        for mesh in meshes:
            np.savetxt(folder / f"{mesh.stem}.map", answers[mesh.stem], fmt="%d")
            (folder / f"{mesh.stem}.json").write_text('{"outcome": "found"}')

    monkeypatch.setattr(accuracy, "detect", detect)


def test_twenty_shapes_are_recorded_and_none_is_wrong():
    kinds = {(group, kind) for group, kinds in accuracy.GROUPS.items() for kind in kinds}
    count = sum(len(numbers) for kinds in accuracy.GROUPS.values() for numbers in kinds.values())
    assert count == len(RECORDED) == 20 and len(kinds) >= 12
    assert {row["group"] for row in RECORDED} == set(accuracy.GROUPS)
    assert all(0 < row["error"] < 0.1 for row in RECORDED)


@pytest.mark.parametrize("group", accuracy.GROUPS)
def test_a_group_that_is_off_by_four_percent_fails_either_way(group):
    assert accuracy.compared(RECORDED, RECORDED)[1] == []
    for factor in (1.04, 0.96):
        assert group in accuracy.compared(RECORDED, spoiled(RECORDED, group, factor))[1]
    assert accuracy.compared(RECORDED, spoiled(RECORDED, group, 1.02))[1] == []
    assert accuracy.compared(RECORDED, spoiled(RECORDED, group, float("nan")))[1]


def test_other_shapes_than_the_recorded_are_an_error():
    with pytest.raises(ValueError, match="record-accuracy"):
        accuracy.compared(RECORDED, RECORDED[1:])


def test_a_spoiled_answer_fails(tmp_path, monkeypatch, capsys):
    chosen = accuracy.cases(tmp_path / "shapes", FEW)
    rng = np.random.default_rng(0)
    answers = {case.path.stem: near_truth(truth_of(case), rng) for case in chosen}
    monkeypatch.setattr(accuracy, "RECORDED", tmp_path / "accuracy.json")
    answered_by(monkeypatch, answers)
    program.write_results(accuracy.RECORDED, {"shapes": accuracy.measured("", chosen, [])})
    assert accuracy.gate("", chosen) == 0
    for name, answer in answers.items():
        worse = np.where(rng.random(len(answer)) < 0.02, -1, answer)
        answered_by(monkeypatch, answers | {name: worse})
        assert accuracy.gate("", chosen) == 1
    assert "record-accuracy" in capsys.readouterr().err


def test_the_same_shapes_are_drawn_again(tmp_path):
    first, second = (accuracy.cases(tmp_path / name, FEW) for name in ("first", "second"))
    for one, other in zip(first, second, strict=True):
        assert one.path.read_bytes() == other.path.read_bytes() and one.path.name == other.path.name


def test_a_moved_mesh_is_the_same_one_elsewhere(tmp_path):
    (case,) = accuracy.cases(tmp_path, {"plates": {"plate": (0,)}})
    moved = accuracy.moved(case.path, Path(shutil.copytree(tmp_path, tmp_path / "copy")), accuracy.TURNED_AND_SCALED[0])
    before, after = accuracy.read_ply(case.path), accuracy.read_ply(moved)
    assert np.array_equal(before[1], after[1])
    areas = [accuracy.assemblies.triangle_areas(*mesh).sum() for mesh in (before, after)]
    assert areas[1] / areas[0] == pytest.approx(1.7**2, rel=1e-4)
