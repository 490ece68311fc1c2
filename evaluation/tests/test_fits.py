"""The fit scripts on answers and evidence that are made up so that the right weights are known."""

import json
import sys

import numpy as np
import pytest

from evaluation import acceptance, confidence, generated, logistic, synthetic_tables
from training.meshfile import write_shape

COLUMNS, ROWS = 15, 11


def grid():
    """A sheet of unit area whose mirror image is x -> 1 - x."""
    x, y = np.meshgrid(np.linspace(0, 1, COLUMNS), np.linspace(0, 1, ROWS))
    corner = np.array([row * COLUMNS + column for row in range(ROWS - 1) for column in range(COLUMNS - 1)])
    faces = np.concatenate([np.c_[corner, corner + 1, corner + COLUMNS], np.c_[corner + 1, corner + COLUMNS + 1, corner + COLUMNS]])
    index = np.arange(x.size)
    return np.c_[x.ravel(), y.ravel(), np.zeros(x.size)], faces, index // COLUMNS * COLUMNS + COLUMNS - 1 - index % COLUMNS


def write_shapes(folder, prefix, count, symmetric):
    vertices, faces, mirror = grid()
    for index in range(count):
        mirror_of = mirror if symmetric else np.full(len(mirror), -1)
        write_shape(folder, f"{prefix}-{index:04d}", vertices, faces, mirror_of, {"kind": f"{prefix} {index % 2}", "symmetric": symmetric})


def write_answer(folder, name, partners, judged):
    folder.mkdir(exist_ok=True)
    np.savetxt(folder / f"{name}.map", partners, fmt="%d")
    (folder / f"{name}.json").write_text(json.dumps({"outcome": "found", "report": {"judged": judged, "seconds": []}}))


def test_errors_are_distances_from_the_truth(tmp_path):
    write_shapes(tmp_path, "a", 1, True)
    (shape,) = generated.read_shapes(tmp_path)
    assert (shape.errors(shape.mirror) == 0).all()
    assert shape.errors(np.arange(len(shape.mirror))).mean() == pytest.approx(0.5, abs=0.06)
    assert (shape.errors(np.full(len(shape.mirror), -1)) == generated.LARGEST_ERROR).all()


def test_a_folder_without_shapes_is_an_error(tmp_path):
    with pytest.raises(FileNotFoundError, match="no shapes"):
        generated.read_shapes(tmp_path)


def test_acceptance_learns_what_tells_right_maps_from_others(tmp_path, monkeypatch, capsys):
    write_shapes(tmp_path / "symmetric", "even", 40, True)
    write_shapes(tmp_path / "asymmetric", "odd", 40, False)
    rng, mirror = np.random.default_rng(0), grid()[2]
    for prefix, mismatch in (("even", 0.05), ("odd", 0.2)):
        for index in range(40):
            wrong = prefix == "even" and index < 5  # the identity: neither right nor asymmetric
            judged = {"signature_mismatch": mismatch * rng.lognormal(0, 0.8), "isometry_score": float(rng.normal())}
            judged |= {"displacement": float(rng.lognormal()), "plausibility": 0.5}
            judged["disagreement"] = (0.005 if prefix == "even" else 0.02) * rng.lognormal(0, 0.8)
            judged["scatter"] = (0.0 if prefix == "even" else 0.02) + 0.02 * rng.random()
            write_answer(tmp_path / "answers", f"{prefix}-{index:04d}", np.arange(len(mirror)) if wrong else mirror, judged)
    words = [str(tmp_path / "symmetric"), str(tmp_path / "asymmetric"), "--keep", str(tmp_path / "answers")]
    monkeypatch.setattr(sys, "argv", ["acceptance", *words])
    acceptance.main()
    printed = capsys.readouterr().out
    assert "40 symmetric shapes: 35 right maps, 5 wrong, 0 without a map" in printed
    lines = [line.split("|") for line in printed.splitlines() if line.startswith(("| ln", "| iso", "| sig", "| scatter"))]
    weights = [(name.strip().removeprefix("ln("), float(weight)) for _, name, weight, *_ in lines]
    alone, with_parts = ({name.split(" ")[0]: weight for name, weight in part} for part in (weights[:3], weights[3:]))
    assert alone.pop("signature_mismatch") < -1.5 and max(map(abs, alone.values())) < 1.2
    assert with_parts["scatter"] < -20 and with_parts["disagreement"] < -1 and with_parts["signature_mismatch"] < -5
    assert abs(with_parts["displacement"]) < 0.2 * abs(with_parts["signature_mismatch"])
    assert "of kinds not seen:" in printed
    assert "from 50 % on: 35 of 35 right maps accepted, 40 of 40 asymmetric shapes" in printed  # as stated now


def test_confidence_learns_which_evidence_counts(tmp_path, monkeypatch, capsys):
    write_shapes(tmp_path / "symmetric", "even", 12, True)
    (tmp_path / "evidence").mkdir()
    rng, mirror = np.random.default_rng(0), grid()[2]
    for index in range(12):
        round_trip = rng.lognormal(-4, 1.5, len(mirror))
        wrong = rng.random(len(mirror)) < 1 / (1 + np.exp(-2 * (np.log(round_trip) + 4)))
        partner = np.where(wrong, (mirror + 4) % len(mirror), mirror)
        noise = rng.normal(size=(len(mirror), len(confidence.FEATURES) - 1))
        rows = np.c_[np.arange(len(mirror)), partner, np.log(round_trip + 0.002), noise]
        np.savetxt(tmp_path / "evidence" / f"even-{index:04d}.evidence", rows, fmt="%g")
    monkeypatch.setattr(sys, "argv", ["confidence", str(tmp_path / "symmetric"), "--keep", str(tmp_path / "evidence")])
    confidence.main()
    printed = capsys.readouterr().out
    weight = {line.split("|")[1].strip(): float(line.split("|")[2]) for line in printed.splitlines() if line.startswith(("| ln", "| mean"))}
    assert weight["ln(round trip + 0.002)"] == pytest.approx(-2, rel=0.3)
    assert abs(weight["mean doubt"]) < 0.3
    assert "four-fold cross-validation by shape: expected calibration error 0.0" in printed


def test_a_shape_without_a_map_has_no_evidence(tmp_path):
    (tmp_path / "a.evidence").write_text("")
    assert confidence.read_evidence(tmp_path / "a.evidence") is None


def test_tables_of_generated_shapes_keep_wrong_maps_apart():
    row = lambda kind, found, error: {"kind": kind, "found": found, "mean_error": error, "error_95": 2 * error, "truth_error": 0.001}
    text = synthetic_tables.error_table([row("bird", True, 0.01), row("bird", True, 0.3), row("bird", False, 1.0), row("blob", True, 0.02)])
    assert "| bird | 3 | 2 | 1 | 0.1550 | 0.3100 | 0.0100 | 0.0200 | 0.0010 |" in text
    assert "| **people and animals** | 3 | 2 | 1 |" in text and "insect" not in text
    assert "| **all** | 2 | 1 | 50.0 % |" in synthetic_tables.asymmetric_table([{"kind": "lump", "found": True}, {"kind": "lump", "found": False}])
    assert logistic.calibration_error(np.array([0.5]), np.array([True])) == 0.5
