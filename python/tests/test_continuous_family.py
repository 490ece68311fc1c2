"""A torus has infinitely many symmetries, a quadruped has not."""

from __future__ import annotations

import numpy as np

import intrinsym


def torus(columns=48, rows=24):
    u, v = np.meshgrid(np.arange(columns) / columns, np.arange(rows) / rows)
    u, v = 2 * np.pi * u.ravel(), 2 * np.pi * v.ravel()
    radius = 1 + 0.4 * np.cos(v)
    index = np.arange(columns * rows).reshape(rows, columns)
    right, up = np.roll(index, -1, 1), np.roll(index, -1, 0)
    quads = np.stack([index, right, np.roll(up, -1, 1), up], -1).reshape(-1, 4)
    return np.stack([radius * np.cos(u), radius * np.sin(u), 0.4 * np.sin(v)], 1), quads


def test_a_torus_has_a_continuous_family(detection):
    found = intrinsym.detect(*torus())
    assert found and found.continuous_family
    assert "continuous family" in found.evidence and found.report.least_signature_gradient < 0.1
    assert not detection.continuous_family
