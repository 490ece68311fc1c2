"""The measures of a map, on a tube whose mirror image and rotations are known."""

import numpy as np
import pytest

from evaluation import map_metrics
from evaluation.map_metrics import THRESHOLD, measure
from evaluation.surface import Surface

ROUND, RINGS = 24, 9


@pytest.fixture
def tube():
    """An open tube of 24 columns and 9 rings: vertex ring * 24 + column."""
    angle = 2 * np.pi * np.arange(ROUND) / ROUND
    vertices = np.array([[np.cos(a), np.sin(a), 0.3 * ring] for ring in range(RINGS) for a in angle])
    index = np.arange((RINGS - 1) * ROUND)
    right = index // ROUND * ROUND + (index + 1) % ROUND
    return Surface(vertices, np.r_[np.c_[index, right, index + ROUND], np.c_[right, right + ROUND, index + ROUND]])


def columns(change):
    """The map that moves every column as `change` says."""
    index = np.arange(ROUND * RINGS)
    return index // ROUND * ROUND + change(index % ROUND) % ROUND


MIRROR = columns(lambda column: -column)
LANDMARKS = np.arange(0, ROUND * RINGS, 5)


def judged(tube, partners):
    return measure(tube, partners, LANDMARKS, MIRROR[LANDMARKS])


def test_the_true_map_is_perfect(tube):
    found = judged(tube, MIRROR)
    assert (found.correspondence_rate, found.mean_error, found.exact_share, found.bijectivity) == (1, 0, 1, 1)
    assert found.cycle_error == 0 and found.turned_share == 1 and found.mesh_right
    assert found.fixed_share == pytest.approx(2 / ROUND)


def test_a_rotation_turns_nothing_over_and_is_no_involution(tube):
    found = judged(tube, columns(lambda column: column + 3))
    assert found.turned_share == 0 and found.fixed_share == 0 and found.bijectivity == 1
    six = 6 * 2 * np.sin(np.pi / ROUND) / tube.unit  # the image of the image is six columns away
    assert found.cycle_error == pytest.approx(six, rel=1e-6)


def test_one_column_beside_the_truth(tube):
    found = judged(tube, columns(lambda column: 1 - column))
    assert found.mean_error == pytest.approx(2 * np.sin(np.pi / ROUND) / tube.unit)
    assert found.exact_share == 0 and found.correspondence_rate == 1


def test_everything_to_one_vertex(tube):
    found = judged(tube, np.zeros(ROUND * RINGS, int))
    assert found.bijectivity == 1 / (ROUND * RINGS) and np.isnan(found.turned_share)
    assert not found.mesh_right


def test_no_answer_is_wrong_but_has_no_error(tube):
    half = np.where(np.arange(ROUND * RINGS) < ROUND * RINGS // 2, MIRROR, -1)
    found = judged(tube, half)
    assert found.mean_error == 0 and found.bijectivity == pytest.approx(0.5, abs=0.01)
    assert found.correspondence_rate == pytest.approx((LANDMARKS < ROUND * RINGS // 2).mean())
    nothing = judged(tube, np.full(ROUND * RINGS, -1))
    assert nothing.correspondence_rate == 0 and np.isnan(nothing.mean_error) and np.isnan(nothing.cycle_error)


def test_close_calls_are_settled_exactly(tube, monkeypatch):
    asked = []
    monkeypatch.setattr(Surface, "distances", lambda self, a, b: np.array([1.5, 1.01, 0.99, 0.5]) * THRESHOLD)
    monkeypatch.setattr(Surface, "exact_distance", lambda self, a, b: asked.append((a, b)) or 0.97 * THRESHOLD)
    found = map_metrics.landmark_distances(tube, np.array([1, 2, 3, 4]), np.array([5, 6, 7, 8]))
    assert asked == [(2, 6), (3, 7)]
    assert found == pytest.approx(np.array([1.5, 0.97, 0.97, 0.5]) * THRESHOLD)
