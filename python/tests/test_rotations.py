"""EXPERIMENTAL: rotations of order three or more, for who asks for them."""

from __future__ import annotations

import numpy as np
import pytest

import intrinsym


def three_lobes(rows: int = 40, columns: int = 60) -> tuple[np.ndarray, np.ndarray]:
    """A closed surface of 2,342 vertices that a third of a turn about z leaves as it is, and no reflection."""
    slope = np.linspace(0, np.pi, rows + 1)[1:-1, None]
    angle = 2 * np.pi * np.arange(columns) / columns
    wave = 0.5 * np.cos(3 * angle) + 0.3 * np.sin(3 * angle - 0.4) * np.cos(slope)
    radius = 1 + np.sin(slope) ** 2 * wave
    x, y = (radius * np.sin(slope) * turn(angle) for turn in (np.cos, np.sin))
    rings = np.stack([x, y, radius * np.cos(slope)], axis=-1).reshape(-1, 3)
    vertices = np.vstack([rings, [[0, 0, 1], [0, 0, -1]]])
    first, last = np.arange(columns), len(rings) - columns + np.arange(columns)
    own = np.arange(len(rings) - columns)
    following = own // columns * columns + (own + 1) % columns
    faces = [
        np.stack([own, own + columns, following], axis=1),
        np.stack([following, own + columns, following + columns], axis=1),
        np.stack([first, np.roll(first, -1), np.full(columns, len(rings))], axis=1),
        np.stack([np.roll(last, -1), last, np.full(columns, len(rings) + 1)], axis=1),
    ]
    return vertices, np.concatenate(faces)


def test_a_rotation_comes_last_and_its_partners_are_images():
    vertices, faces = three_lobes()
    assert all(found.kind is not intrinsym.SymmetryKind.ROTATION for found in intrinsym.detect(vertices, faces))
    *others, rotation = intrinsym.detect(vertices, faces, rotations=4)
    assert [other.order for other in others] == [2] * len(others)
    assert rotation.kind is intrinsym.SymmetryKind.ROTATION and rotation.order == 3
    once, back = (
        np.stack([-x / 2 - turn * y, turn * x - y / 2, z], axis=1)
        for x, y, z in [vertices.T]
        for turn in (np.sqrt(0.75), -np.sqrt(0.75))
    )
    away = [np.linalg.norm(vertices[rotation.partner] - image, axis=1).mean() for image in (once, back)]
    assert min(away) < 0.05
    assert not rotation.side.any() and not rotation.fixed_curve
    with pytest.raises(intrinsym.OptionError, match="a rotation of order 3 mirrors nothing"):
        rotation.mirror_selection(np.ones(len(vertices), bool))
