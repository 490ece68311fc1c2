"""Training data in memory: samples of shapes, their labels, and batches of network inputs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from .network import Design

CLEAR, UNCLEAR = 0.8, 0.5  # |c| above: surely even or odd; below: surely neither; soft in between


@dataclass
class Shapes:
    """Samples (s, p, k), positions (s, p, 3), correlations c (s, k; NaN where nobody labelled), kind (s,)."""

    samples: np.ndarray
    positions: np.ndarray
    labels: np.ndarray
    kind: np.ndarray

    def __len__(self) -> int:
        return len(self.samples)

    def pairs(self, signs: int) -> np.ndarray:
        """All (shape, eigenfunction) that have a label, among the first `signs` functions; (n, 2)."""
        return np.argwhere(np.isfinite(self.labels[:, :signs]))


def load(paths: list[Path]) -> Shapes:
    """The training files of dataset.py, one after another."""
    parts = [np.load(path) for path in paths]
    columns = (np.concatenate([part[name] for part in parts]) for name in ("samples", "positions", "labels", "kind"))
    return Shapes(*columns)


def turned(shapes: Shapes, seed: int) -> Shapes:
    """The same with each shape turned at random: generated shapes stand upright, which gives their mirror plane away."""
    rotations = Rotation.random(len(shapes), rng=np.random.default_rng(seed)).as_matrix()
    positions = np.einsum("sij,spj->spi", rotations, shapes.positions).astype(shapes.positions.dtype)
    return replace(shapes, positions=positions)


def joined(first: Shapes, second: Shapes) -> Shapes:
    """Both sets as one."""
    return Shapes(*(np.concatenate([getattr(first, n), getattr(second, n)]) for n in ("samples", "positions", "labels", "kind")))


def targets(correlation: np.ndarray) -> np.ndarray:
    """Probabilities of (even, odd, neither) from c, by |c| between UNCLEAR and CLEAR linear."""
    sure = np.clip((np.abs(correlation) - UNCLEAR) / (CLEAR - UNCLEAR), 0, 1)
    even = np.where(correlation > 0, sure, 0)
    return np.stack([even, sure - even, 1 - sure], -1).astype(np.float32)


def inputs(design: Design, shapes: Shapes, shape: np.ndarray, function: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Network inputs (batch, points, channels) for pairs (shape, function) at the sample `rows`."""
    take = shapes.samples[shape[:, None], rows[None, :]].astype(np.float32)
    if design.inputs == "all":
        return take[..., : design.signs]
    own = np.take_along_axis(take, function[:, None, None], axis=2)
    if design.inputs == "positions":
        return np.concatenate([shapes.positions[shape[:, None], rows[None, :]], own], -1)
    return np.concatenate([take[..., : design.references], own], -1)
