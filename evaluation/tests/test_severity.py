"""Each kind of damage does what its severity says, and no damage leaves the shape alone."""

import re
from pathlib import Path

import numpy as np
import pytest

from evaluation import robustness, robustness_tables, severity
from evaluation.remeshed import edge_graph
from evaluation.severity import SERIES, Subject, genus_of
from evaluation.surface import Surface
from training.mirror_truth import mirror_map

SUBJECT = Subject("biped", (1, 2))


@pytest.fixture(scope="module")
def shape():
    return SUBJECT.mesh(None, 2_500)


def area(sample):
    return Surface(sample.rest, sample.faces).area


@pytest.mark.parametrize("share", [0.1, 0.3])
def test_holes_take_their_share_of_the_area(shape, share):
    left = severity.with_holes(np.random.default_rng(0), shape, share)
    assert area(left) < (1 - share) * area(shape) + 1e-9
    assert severity.with_holes(np.random.default_rng(0), shape, 0).rest.shape == shape.rest.shape


def test_a_limb_is_cut_on_one_side_only(shape):
    left = severity.without_limb_end(None, shape, 0.25)
    lost = {tuple(point) for point in shape.rest} - {tuple(point) for point in left.rest}
    assert lost and all(point[0] > 0 for point in lost)
    orphan = mirror_map(left.rest, left.faces) < 0
    assert orphan.any() and (left.rest[orphan, 0] < 0).all()


def test_handles_are_added_and_counted():
    for genus in (0, 2):
        assert genus_of(SERIES["handles"].draw(SUBJECT, genus, None)) == genus
    assert SERIES["handles"].draw(Subject("person", (1,)), 0, None) is None


def test_thinning_keeps_vertices_and_reaches_the_number(shape):
    few = severity.thinned(np.random.default_rng(0), shape, severity.spacing_for(shape, 600))
    assert 400 < len(few.rest) < 800
    whole = {tuple(point) for point in shape.rest}
    assert all(tuple(point) in whole for point in few.rest)
    assert area(few) == pytest.approx(area(shape), rel=0.1)


def test_an_uneven_mesh_is_dense_on_one_side():
    sample = SERIES["uneven"].draw(SUBJECT, 20, None)
    left, right = (sample.rest[:, 0] < -0.05).sum(), (sample.rest[:, 0] > 0.05).sum()
    assert 10 < left / right < 40


def test_a_scan_from_the_side_sees_one_side(shape):
    beside, front = severity.scan_from(None, shape, 90), severity.scan_from(None, shape, 0)
    paired = [(mirror_map(sample.rest, sample.faces) >= 0).mean() for sample in (front, beside)]
    assert paired[0] > 0.9 and paired[1] < 0.8


@pytest.mark.parametrize("series, worst", [("sword", 0.5), ("bag", 0.12)])
def test_a_prop_has_no_partner(series, worst):
    plain, armed = (SERIES[series].draw(SUBJECT, amount, None) for amount in (0, worst))
    assert (mirror_map(plain.rest, plain.faces) >= 0).mean() > 0.98
    orphan = mirror_map(armed.rest, armed.faces) < 0
    assert 0.02 < orphan.mean() < 0.6 and armed.rest[orphan, 0].mean() > 0


def test_the_same_shape_comes_again():
    first, second = (SERIES["noise"].draw(SUBJECT, 0.2, None) for _ in range(2))
    assert np.array_equal(first.posed, second.posed)
    assert edge_graph(first.rest, first.faces).nnz == edge_graph(second.rest, second.faces).nnz


def row(number, **measures):
    blank = {"series": "holes", "severity": number, "vertices": 100, "answered": True, "mean_error": 0.02, "wrong_share": 0.1,
             "confidence": 0.8, "confidence_without_partner": None}  # fmt: skip
    return blank | measures


def test_tables_and_chart_leave_out_what_was_not_measured(tmp_path):
    rows = [
        row(0),
        row(0, mean_error=0.04),
        row(0.4, answered=False, mean_error=None, wrong_share=None, confidence=None),
    ]
    result = {"date": "2026-01-01", "quick": False, "rows": rows}
    text = robustness_tables.report(result)
    assert (
        "| 0 | 100 | 2 of 2 | 0.030 | 0.10 | 0.80 | - |" in text
        and "| 0.4 | 100 | 0 of 1 | - | - | - | - |" in text
    )
    assert "sword" not in text
    robustness_tables.draw(result, tmp_path / "chart.png")
    assert (tmp_path / "chart.png").read_bytes().startswith(b"\x89PNG")


def test_what_is_not_answered_has_no_error(tmp_path):
    from evaluation.generated import Shape
    from evaluation.program import Answer

    mirror = np.array([1, 0, -1])
    shape = Shape(
        "a", tmp_path / "a.ply", mirror, {"series": "holes", "severity": 0, "subject": 0, "kind": "bird"}
    )
    nothing = Answer("a", False, np.full(3, -1), {"outcome": "none", "report": {"judged": None, "seconds": []}}, np.zeros(3))
    found = robustness.judge(shape, nothing)
    assert (
        not found["answered"]
        and found["mean_error"] is None
        and found["paired_share"] == pytest.approx(2 / 3, abs=1e-3)
    )


def test_accepted_is_the_default_of_the_program():
    options = (Path(__file__).parents[2] / "src" / "base" / "options.rs").read_text()
    default = re.search(r'"plausibility",\s*(\d+)', options)[1]
    assert int(default) / 100 == robustness.ACCEPTED
