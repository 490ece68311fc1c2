"""Series of ever worse input: each turns an undamaged shape, a severity and a generator of random numbers into a sample.

Severity 0 (or the first of a series) leaves the shape as it is. Lengths are in sqrt(area) of the undamaged shape, or in
diagonals of its bounding box where said so.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from training import damage
from training.creatures import SYMMETRIC_KINDS
from training.damage import Sample, restrict
from training.generate import posed_shape
from training.implicit import largest_piece
from training.mirror_truth import vertex_normals
from training.people import People
from training.skeleton import Skeleton

from .remeshed import edge_graph

POSE = 0.35  # typical joint angle, radians
# Vertices of the undamaged shapes, and of those that are then thinned out.
USUAL, DENSE = 5_000, 20_000
SWORD_RADIUS = 0.03
# Bridges tried before a skeleton is given up with fewer handles than wanted.
ATTEMPTS = 60
SMALLEST_GAP = 0.15


@dataclass
class Subject:
    """An undamaged shape: a kind and a number. The same skeleton, proportions and pose at every severity."""

    kind: str
    seed: tuple[int, ...]

    def mesh(self, people: People | None, vertices: int = USUAL, change: Callable | None = None) -> Sample | None:
        """The posed mesh; left and right share no connectivity.

        `change(rng, skeleton, build)` adds bones, and says False if it cannot; then, and for people, there is no mesh. What
        `build` makes of a skeleton is the mesh that it will become.
        """
        rng = np.random.default_rng(self.seed)
        if self.kind == "person":
            return None if change else people.remeshed_person(rng, 0.8 * POSE, vertices)
        skeleton = SYMMETRIC_KINDS[self.kind](rng)
        build = lambda bones: posed_shape(
            np.random.default_rng([*self.seed, 2]), copy.deepcopy(bones), False, POSE, vertices
        )
        if change and change(np.random.default_rng([*self.seed, 1]), skeleton, build) is False:
            return None
        return build(skeleton)


def with_holes(rng, sample: Sample, share: float) -> Sample:
    """Cuts balls of 0.8 to 2 % of the diagonal anywhere until `share` of the area is gone; the largest piece stays."""
    corners = sample.rest[sample.faces]
    centre_of = corners.mean(1)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    diagonal = np.linalg.norm(np.ptp(sample.rest, axis=0))
    keep = np.ones(len(sample.faces), bool)
    while area[~keep].sum() < share * area.sum():
        centre = centre_of[rng.choice(np.flatnonzero(keep))]
        keep &= np.linalg.norm(centre_of - centre, axis=1) > rng.uniform(0.008, 0.02) * diagonal
    return restrict(sample, keep)


def without_limb_end(_rng, sample: Sample, length: float) -> Sample:
    """Cuts everything within `length` of the tip of one limb: the vertex of the +x side farthest from the middle."""
    graph = edge_graph(sample.rest, sample.faces)
    middle = np.linalg.norm(sample.rest - sample.rest.mean(0), axis=1).argmin()
    beside = sample.rest[:, 0] > 0.1 * sample.rest[:, 0].max()
    reach = dijkstra(graph, directed=False, indices=middle)
    tip = np.where(beside & np.isfinite(reach), reach, -1).argmax()
    gone = dijkstra(graph, directed=False, indices=tip) < length
    return restrict(sample, ~gone[sample.faces].all(1))


def thinned(rng, sample: Sample, spacing: np.ndarray) -> Sample:
    """Another triangulation on some of the vertices, about `spacing` (n, in rest units) apart.

    Vertices are kept in random order unless one is nearer than the spacing; the triangles join vertices whose cells of
    nearest points along the edges meet (a dual of the geodesic Voronoi diagram).
    """
    normals = vertex_normals(sample.rest, sample.faces)
    tree, covered, seeds = cKDTree(sample.rest), np.zeros(len(sample.rest), bool), []
    for vertex in rng.permutation(len(sample.rest)):
        if not covered[vertex]:
            seeds.append(vertex)
            near = np.array(tree.query_ball_point(sample.rest[vertex], spacing[vertex]))
            covered[near[normals[near] @ normals[vertex] > 0]] = True  # not the other side of a thin sheet
            covered[vertex] = True
    _, _, nearest = dijkstra(
        edge_graph(sample.rest, sample.faces),
        directed=False,
        indices=seeds,
        min_only=True,
        return_predecessors=True,
    )
    own = np.full(len(sample.rest), -1)
    own[seeds] = np.arange(len(seeds))
    cells = own[np.maximum(nearest, 0)][sample.faces]
    meet = (cells[:, 0] != cells[:, 1]) & (cells[:, 1] != cells[:, 2]) & (cells[:, 2] != cells[:, 0])
    stacked, faces = largest_piece(np.c_[sample.rest, sample.posed][seeds], cells[meet])
    return Sample(stacked[:, :3], stacked[:, 3:], faces)


def spacing_for(sample: Sample, vertices: np.ndarray | float) -> np.ndarray:
    """The spacing at which `thinned` keeps about `vertices` of a whole shape (one number, or one for each vertex)."""
    corners = sample.rest[sample.faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    return np.sqrt(0.52 * area / np.broadcast_to(vertices, len(sample.rest)))


def uneven(rng, sample: Sample, ratio: float) -> Sample:
    """One side (+x) has a density of vertices 1/`ratio` of the other's, with a short transition."""
    width = np.abs(sample.rest[:, 0]).max()
    side = np.clip(0.5 + sample.rest[:, 0] / (0.2 * width), 0, 1)
    return thinned(rng, sample, spacing_for(sample, USUAL * ratio**-side))


def scan_from(_rng, sample: Sample, degrees: float) -> Sample:
    """What a camera sees that stands so many degrees beside the mirror plane: at 90, one side only."""
    angle = np.radians(degrees)
    return damage.seen_from(sample, np.array([np.sin(angle), np.cos(angle), 0.15]))


def with_handles(rng, skeleton: Skeleton, build, genus: int) -> bool:
    """Bridges the ends of limbs with other bones, as touching parts are glued in a scan, until there are `genus` handles.

    False if that cannot be had, because the shape touches itself already or no bridge makes a handle.
    """
    have = genus_of(build(skeleton))
    for _ in range(ATTEMPTS):
        if have >= genus:
            break
        tried = copy.deepcopy(skeleton)
        bridge(rng, tried)
        handles = genus_of(build(tried))
        if have < handles <= genus:
            have = handles
            skeleton.__dict__.update(tried.__dict__)
    return have == genus


def bridge(rng, skeleton: Skeleton) -> None:
    """Joins the end of a limb with that of one of the four nearest bones that are not of its own chain, with a gap between."""
    ends = np.array(skeleton.end)
    first = int(rng.choice([bone for bone in range(len(ends)) if bone not in skeleton.parent]))
    others = [bone for bone in range(len(ends)) if bone not in _chain(skeleton, first)]
    gap = lambda bone: np.linalg.norm(ends[bone] - ends[first])
    nearest = sorted((bone for bone in others if gap(bone) > SMALLEST_GAP), key=gap)[:4]
    second = nearest[rng.integers(len(nearest))]
    radius = 0.8 * min(skeleton.end_radius[first], skeleton.end_radius[second])
    skeleton.add(ends[first], ends[second], radius, radius, first)


def _chain(skeleton: Skeleton, bone: int) -> set[int]:
    """A bone and those it hangs from."""
    found = set()
    while bone >= 0:
        found.add(bone)
        bone = skeleton.parent[bone]
    return found


def genus_of(sample: Sample) -> int:
    """Handles of a closed mesh."""
    edges = np.sort(
        np.concatenate([sample.faces[:, [0, 1]], sample.faces[:, [1, 2]], sample.faces[:, [2, 0]]]), axis=1
    )
    return (2 - len(sample.rest) + len(np.unique(edges, axis=0)) - len(sample.faces)) // 2


def _hand(skeleton: Skeleton) -> int:
    """The bone of the +x side whose end is farthest out."""
    outward = [np.linalg.norm(end) if side > 0 else -1 for end, side in zip(skeleton.end, skeleton.side)]
    return int(np.argmax(outward))


def diagonal_of(skeleton: Skeleton) -> float:
    """Diagonal of the box around the bones."""
    return float(np.linalg.norm(np.ptp(np.array(skeleton.start + skeleton.end), axis=0)))


def sword(_rng, skeleton: Skeleton, _build, length: float) -> None:
    """A thin rod of `length` diagonals at the end of one limb."""
    if length > 0:
        hand = _hand(skeleton)
        direction = skeleton.end[hand] - skeleton.start[hand]
        tip = skeleton.end[hand] + direction / np.linalg.norm(direction) * length * diagonal_of(skeleton)
        skeleton.add(skeleton.end[hand], tip, SWORD_RADIUS, SWORD_RADIUS, hand)


def bag(_rng, skeleton: Skeleton, _build, radius: float) -> None:
    """A ball of `radius` diagonals that hangs from the end of one limb."""
    if radius > 0:
        hand, size = _hand(skeleton), radius * diagonal_of(skeleton)
        centre = skeleton.end[hand] - [0, 0, size]
        skeleton.add(centre, centre + [0, 0, 1e-3], size, size, hand)


@dataclass
class Series:
    """Severities and what they mean; `damage` works on the mesh, `change` on the skeleton (then there are no people)."""

    title: str
    severities: tuple[float, ...]
    damage: Callable | None = None
    change: Callable | None = None
    vertices: int = USUAL
    # Mean edges within which a true partner must lie: more where edges differ much in length.
    tolerance: float = 2.0

    def draw(self, subject: Subject, severity: float, people: People | None) -> Sample | None:
        """The damaged shape; None if this series cannot be made from the subject."""
        change = (lambda *made: self.change(*made, severity)) if self.change else None
        sample = subject.mesh(people, self.vertices, change)
        if sample is None or self.damage is None:
            return sample
        return self.damage(np.random.default_rng([*subject.seed, 3]), sample, severity)


SERIES = {
    "holes": Series("holes: share of the area", (0, 0.05, 0.1, 0.2, 0.3, 0.4), damage=with_holes),
    "limb": Series("one limb cut off: length, sqrt(area)", (0, 0.1, 0.2, 0.3, 0.4, 0.5), damage=without_limb_end),
    "handles": Series("touching parts glued: handles (genus)", (0, 1, 2, 3, 4, 5), change=with_handles),
    "noise": Series("noise: deviation, mean edges", (0, 0.05, 0.1, 0.2, 0.4, 0.8), damage=damage.add_noise),
    "uneven": Series("density of one side to the other: 1 to", (1, 2, 5, 10, 20), damage=uneven, vertices=DENSE, tolerance=6.0),
    "coarse": Series("remeshed: share of 10,000 vertices", (1, 0.5, 0.25, 0.1, 0.05), vertices=DENSE,
                     damage=lambda rng, sample, share: thinned(rng, sample, spacing_for(sample, 10_000 * share))),
    "scan": Series("open scan: degrees beside the mirror plane", (0, 15, 30, 45, 60, 90), damage=scan_from),
    "sword": Series("a sword in one hand: length, diagonals", (0, 0.125, 0.25, 0.5, 1.0), change=sword),
    "bag": Series("a bag on one hand: radius, diagonals", (0, 0.04, 0.08, 0.12, 0.16), change=bag),
}  # fmt: skip
