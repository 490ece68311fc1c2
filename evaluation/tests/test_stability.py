"""The changes of `evaluation.stability`, and what counts as changed."""

import numpy as np
import pytest

from evaluation.program import Answer
from evaluation.stability import CHANGES, NOISE, Written, compared

VERTICES = np.array([[0.0, 0, 0], [2, 0, 0], [0, 3, 0], [0, 0, 4], [1, 1, 1]])
FACES = np.array([[0, 1, 2], [0, 3, 1], [1, 3, 4]])


def sides(vertices, faces):
    """Sorted side lengths of each face, the faces sorted."""
    lengths = np.linalg.norm(vertices[faces] - vertices[np.roll(faces, 1, axis=1)], axis=2)
    return sorted(map(tuple, np.sort(lengths, axis=1)))


@pytest.mark.parametrize("name", CHANGES)
def test_a_change_writes_the_same_shape(name):
    written = CHANGES[name](VERTICES, FACES, np.random.default_rng(1))
    scale = {"in millimetres": 1000, "a third as large": 1 / 3}.get(name, 1)
    assert np.allclose(sides(written.vertices, written.faces), scale * np.array(sides(VERTICES, FACES)), rtol=10 * NOISE)
    assert np.allclose(sides(VERTICES, written.first[written.faces]), sides(VERTICES, FACES))
    assert sorted(written.first) == list(range(len(VERTICES)))


def answer(partners, outcome="found"):
    return Answer("mesh", True, np.array(partners), {"outcome": outcome}, np.zeros(0))


def test_partners_are_compared_by_their_first_numbers():
    before = [1, 0, 2, -1, 4]
    first = np.array([4, 2, 0, 1, 3])
    place = np.argsort(first)
    same = [place[before[vertex]] if before[vertex] >= 0 else -1 for vertex in first]
    written = Written(VERTICES[first], place[FACES], first)
    row = compared(answer(before), answer(same), written, VERTICES, 1.0)
    assert row == {"changed": 0.0, "moved": 0.0, "outcomes": ["found", "found"]}
    same[place[0]] = place[2]
    row = compared(answer(before), answer(same, "doubtful"), written, VERTICES, 0.5)
    assert row["changed"] == 0.2 and row["outcomes"] == ["found", "doubtful"]
    assert row["moved"] == pytest.approx(np.sqrt(13) / 0.5 / 4, abs=1e-4)
