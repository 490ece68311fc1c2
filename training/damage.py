"""What happens to real meshes: noise, holes, cut limbs, flipped edges, one-sided scans, glued contacts, further shells.

Every function takes and returns a `Sample`, whose rest positions carry the truth along.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .implicit import keep_faces, largest_piece
from .mirror_truth import mean_edge, vertex_normals
from .skeleton import Skeleton


@dataclass
class Sample:
    """A shape: `rest` (n, 3) symmetric about x = 0, `posed` (n, 3) what is written, `faces` (m, 3)."""

    rest: np.ndarray
    posed: np.ndarray
    faces: np.ndarray


def restrict(sample: Sample, keep: np.ndarray) -> Sample:
    """The faces in `keep`, and of these only the largest piece."""
    rest, faces, old = keep_faces(sample.rest, sample.faces, keep)
    stacked = np.c_[rest, sample.posed[old]]
    stacked, faces = largest_piece(stacked, faces)
    return Sample(stacked[:, :3], stacked[:, 3:], faces)


def add_noise(rng, sample: Sample, amount: float) -> Sample:
    """Move each vertex along its normal by a normal deviate of `amount` mean edges."""
    normals = vertex_normals(sample.posed, sample.faces)
    shift = rng.normal(size=(len(normals), 1)) * amount * mean_edge(sample.posed, sample.faces)
    return replace(sample, posed=sample.posed + normals * shift)


def cut_holes(rng, sample: Sample, count: int) -> Sample:
    """Remove `count` discs of 2 to 5 % of the diagonal, anywhere (so not symmetric)."""
    keep = np.ones(len(sample.faces), bool)
    centre_of = sample.rest[sample.faces].mean(1)
    diagonal = np.linalg.norm(np.ptp(sample.rest, axis=0))
    for _ in range(count):
        centre = sample.rest[rng.integers(len(sample.rest))]
        keep &= np.linalg.norm(centre_of - centre, axis=1) > rng.uniform(0.02, 0.05) * diagonal
    return restrict(sample, keep)


def cut_limb(rng, sample: Sample) -> Sample:
    """Cut the end of one limb: everything beyond a plane near an extremity of the rest shape."""
    centre = sample.rest.mean(0)
    outward = sample.rest - centre
    far = np.linalg.norm(outward, axis=1)
    tip = int(rng.choice(np.flatnonzero(far > np.quantile(far, 0.9))))
    direction = outward[tip] / far[tip]
    reach = (sample.rest[sample.faces].mean(1) - centre) @ direction
    near = np.linalg.norm(sample.rest[sample.faces].mean(1) - sample.rest[tip], axis=1) < 0.35 * far[tip]
    return restrict(sample, ~((reach > far[tip] * rng.uniform(0.75, 0.92)) & near))


def flip_edges(rng, sample: Sample, share: float) -> Sample:
    """Flip `share` of the edges: two triangles a b c, b a d become c d b, d c a. Edges are left whose triangles would turn over
    in the rest pose, whose new edge is there already, or whose triangles another flip has changed."""
    faces, edges = sample.faces.copy(), {}
    for face, (a, b, c) in enumerate(faces):
        edges |= {(a, b): (face, c), (b, c): (face, a), (c, a): (face, b)}
    normal = lambda p, q, r: np.cross(sample.rest[q] - sample.rest[p], sample.rest[r] - sample.rest[p])
    inner = sorted(edge for edge in edges if edge[0] < edge[1] and edge[::-1] in edges)
    changed, wanted = set(), int(share * len(inner))
    for index in rng.permutation(len(inner)):
        if wanted == 0:
            break
        a, b = inner[index]
        (first, c), (second, d) = edges[a, b], edges[b, a]
        if {first, second} & changed or (c, d) in edges or (d, c) in edges:
            continue
        before, new = normal(a, b, c) + normal(b, a, d), (normal(c, d, b), normal(d, c, a))
        if min(new[0] @ before, new[1] @ before) > 0.1 * (before @ before) / 2:
            faces[first], faces[second] = (c, d, b), (d, c, a)
            changed |= {first, second}
            edges |= {(c, d): (first, b), (d, c): (second, a)}
            wanted -= 1
    return replace(sample, faces=faces)


def scan_from_front(rng, sample: Sample) -> Sample:
    """Keep the faces that a camera roughly in the mirror plane sees: an open, one-sided scan."""
    return seen_from(sample, np.array([rng.normal() * 0.15, rng.choice([-1.0, 1.0]), rng.normal() * 0.4]))


def seen_from(sample: Sample, view: np.ndarray, cells: int = 48) -> Sample:
    """Keep the faces that a far camera in direction `view` sees, in the rest pose."""
    view = view / np.linalg.norm(view)
    across = np.cross(view, [0, 0, 1.0])
    across /= np.linalg.norm(across)
    centres = sample.rest[sample.faces].mean(1)
    flat = np.stack([centres @ across, centres @ np.cross(across, view)], 1)
    pixel = ((flat - flat.min(0)) / np.ptp(flat, axis=0).max() * (cells - 1)).astype(int) @ [cells, 1]
    depth = centres @ view
    front = np.full(cells * cells, -np.inf)
    np.maximum.at(front, pixel, depth)
    return restrict(sample, depth > front[pixel] - np.ptp(flat, axis=0).max() / cells * 3)


def add_shells(rng, sample: Sample) -> Sample:
    """Add a mirrored pair of small spheres ("eyes") as separate pieces beside the shape."""
    steps = np.linspace(0, np.pi, 9)
    rings = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    ball = np.array([[np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)] for a in steps[1:-1] for b in rings])
    ball = np.r_[ball, [[0, 0, 1.0], [0, 0, -1.0]]]
    faces = _ball_faces(len(steps) - 2, len(rings))
    size = np.linalg.norm(np.ptp(sample.rest, axis=0)) * 0.03
    top = sample.rest[sample.rest[:, 2].argmax()] * [0, 1, 1] + [0, 0, 2 * size]
    rest, all_faces = [sample.rest], [sample.faces]
    for side in (-1.0, 1.0):
        mirrored = faces if side > 0 else faces[:, ::-1]
        all_faces.append(mirrored + sum(map(len, rest)))
        rest.append((ball * size + top + [2 * size, 0, 0]) * [side, 1, 1])
    new = np.concatenate(rest[1:])
    return Sample(np.r_[sample.rest, new], np.r_[sample.posed, new], np.concatenate(all_faces))


def _ball_faces(bands: int, ring: int) -> np.ndarray:
    faces, north, south = [], bands * ring, bands * ring + 1
    for k in range(ring):
        right = (k + 1) % ring
        faces.append([north, k, right])
        faces.append([south, (bands - 1) * ring + right, (bands - 1) * ring + k])
        for band in range(bands - 1):
            a, b = band * ring + k, band * ring + right
            faces += [[a, a + ring, b], [b, a + ring, b + ring]]
    return np.array(faces)


def glue(rng, skeleton: Skeleton) -> Skeleton:
    """Bridge two bones that are apart, as a hand resting on a hip does: one more handle (genus)."""
    ends = np.array(skeleton.end)
    first = int(rng.integers(len(ends)))
    gap = np.linalg.norm(ends - ends[first], axis=1)
    near = np.argsort(np.where(gap < 0.15, np.inf, gap))
    second = int(near[rng.integers(min(4, len(near)))])
    radius = 0.8 * min(skeleton.end_radius[first], skeleton.end_radius[second])
    skeleton.add(ends[first], ends[second], radius, radius, first)
    return skeleton
