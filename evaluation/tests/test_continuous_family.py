"""The surfaces of revolution that the test for a continuous family is measured on."""

import numpy as np
import pytest

from evaluation.continuous_family import bumped, lathe, profiles, sided


@pytest.mark.parametrize("name, characteristic", [("sphere", 2), ("torus", 0), ("disk", 1), ("annulus", 0), ("closed cone", 2)])
def test_a_lathe_has_the_right_topology_and_lies_on_its_profile(name, characteristic):
    profile = profiles()[name]
    points, faces = lathe(profile, 800, np.random.default_rng(1))
    directed = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    assert len(np.unique(directed, axis=0)) == len(directed)  # oriented alike, and manifold
    edges = np.unique(np.sort(directed, 1), axis=0)
    assert len(points) - len(edges) + len(faces) == characteristic
    assert 700 < len(points) < 900
    at = np.stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]], 1)
    starts, ways = profile[:-1], np.diff(profile, axis=0)
    along = ((at[:, None] - starts) * ways).sum(2) / np.maximum((ways**2).sum(1), 1e-30)
    nearest = starts + np.clip(along, 0, 1)[..., None] * ways
    assert np.linalg.norm(at[:, None] - nearest, axis=2).min(1).max() < 1e-9


def test_sides_and_bumps_are_where_they_should_be():
    angle = np.linspace(0, 2 * np.pi, 13)
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    square = sided(circle, 4)
    assert np.allclose(np.abs(square[:, 0]) + np.abs(square[:, 1]), 1)
    dent = bumped(circle, (1, 0, 0), -0.2, 0.1)
    assert np.allclose(dent[0], [0.8, 0, 0]) and np.allclose(dent[1:-1], circle[1:-1], atol=1e-5)
