"""How far surfaces of revolution and other shapes lie apart in `least_signature_gradient` (docs/method.md).

    python -m evaluation.continuous_family [MESH ...] --work FOLDER

makes surfaces of revolution and near misses, irregularly triangulated, in FOLDER, asks the example program `continuous_family` about
them and about the meshes named (which have no family), and prints a table.
"""

from __future__ import annotations

import argparse
import subprocess
from pathlib import Path

import numpy as np

from training.meshfile import write_ply

from .markdown import table

VERTICES = (1000, 2000, 4000, 12_000)
JITTER = 0.2  # of a step, along the surface


def arc(centre, radius, start, end):
    """A quarter circle or more in (radius, height)."""
    angle = np.linspace(start, end, 200)
    return np.stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)], 1)


def random_vase(seed):
    """A smooth random profile that stands on a disk."""
    rng = np.random.default_rng(seed)
    height = np.linspace(0, 3, 400)
    waves = sum(rng.normal() * 0.25 / k * np.sin(k * np.pi * height / 3 + rng.uniform(0, 6)) for k in range(1, 5))
    return np.vstack([[0, 0], np.stack([np.maximum(0.7 + waves, 0.2), height], 1)])


def profiles():
    """Polylines of (distance from the axis, height)."""
    half = arc((0, 0), 1, -np.pi / 2, np.pi / 2)
    made = {
        "sphere": half,
        "oblate spheroid": half * [1, 0.5],
        "prolate spheroid": half * [0.5, 1],
        "hemisphere": arc((0, 0), 1, 0, np.pi / 2),
        "capsule": np.vstack([arc((0, -1), 0.5, -np.pi / 2, 0), arc((0, 1), 0.5, 0, np.pi / 2)]),
        "closed cylinder": [[0, -1], [0.5, -1], [0.5, 1], [0, 1]],
        "open cylinder": [[0.5, -1], [0.5, 1]],
        "closed cone": [[0, 0], [0.8, 0], [0, 2]],
        "open cone": [[0.8, 0], [0, 2]],
        "disk": [[0, 0], [1, 0]],
        "annulus": [[0.4, 0], [1, 0]],
        "torus": arc((1, 0), 0.4, 0, 2 * np.pi),
    } | {f"vase {seed}": random_vase(seed) for seed in range(6)}
    return {name: np.asarray(profile, float) for name, profile in made.items()}


def lathe(profile, vertices, rng):
    """Rings of points at random angles, each with its own count, jittered along the profile, joined by triangles."""
    profile = np.where(np.abs(profile) < 1e-9, 0, profile)
    closed = np.allclose(profile[0], profile[-1])
    steps = np.linalg.norm(np.diff(profile, axis=0), axis=1)
    area = np.pi * ((profile[1:, 0] + profile[:-1, 0]) * steps).sum()
    edge = np.sqrt(area / vertices / 0.87)
    along = np.r_[0, np.cumsum(steps)]
    count = max(3, round(along[-1] / (0.87 * edge)))
    at = np.linspace(0, along[-1], count + 1)[: count + 1 - closed]
    points, rings, made = [], [], 0
    for index, middle in enumerate(at):
        radius = np.interp(middle, along, profile[:, 0])
        sides = 1 if radius == 0 else max(5, round(2 * np.pi * radius / edge))
        angle = (np.arange(sides) + rng.uniform(-JITTER, JITTER, sides)) * 2 * np.pi / sides + rng.uniform(0, 2 * np.pi)
        angle = np.sort(angle % (2 * np.pi))
        inside = sides > 1 and (closed or 0 < index < len(at) - 1)
        place = middle + inside * rng.uniform(-JITTER, JITTER, sides) * along[-1] / count
        place = place % along[-1] if closed else place
        distance, height = (np.interp(place, along, profile[:, axis]) for axis in (0, 1))
        points.append(np.stack([distance * np.cos(angle), distance * np.sin(angle), height], 1))
        rings.append((made, angle))
        made += sides
    pairs = zip(rings, rings[1:] + rings[:1] if closed else rings[1:])
    return np.vstack(points), np.array([triangle for pair in pairs for triangle in joined(*pair)])


def joined(lower, upper):
    """Triangles between two rings of (first index, angles); the next point in order of the angle makes the next one."""
    (first, below), (second, above) = lower, upper
    start = int(np.argmin(np.abs((above - below[0] + np.pi) % (2 * np.pi) - np.pi)))
    shift = (above[start] - below[0] + np.pi) % (2 * np.pi) - np.pi
    below = np.r_[below - below[0], 2 * np.pi]
    above = np.r_[shift + (np.roll(above, -start) - above[start]) % (2 * np.pi), shift + 2 * np.pi]
    i, j, n, m = 0, 0, len(below) - 1, len(above) - 1
    while i < (n if n > 1 else 0) or j < (m if m > 1 else 0):
        here, there = first + i % n, second + (start + j) % m
        if m == 1 or (n > 1 and i < n and (j == m or below[i + 1] < above[j + 1])):
            yield here, first + (i + 1) % n, there
            i += 1
        else:
            yield here, second + (start + j + 1) % m, there
            j += 1


def with_noise(vertices, faces, share, rng):
    """Each vertex displaced by a normal deviate of `share` mean edges."""
    edge = np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1).mean()
    return vertices + share * edge * rng.normal(size=vertices.shape)


def bumped(vertices, at, height, width):
    """A bump away from the axis; a dent if `height` is negative."""
    outward = np.array([at[0], at[1], 0]) / np.hypot(at[0], at[1])
    bump = np.exp(-((vertices - at) ** 2).sum(1) / width**2)
    return vertices + height * bump[:, None] * outward


def sided(vertices, sides, depth=1.0):
    """A regular polygon instead of each circle (`depth` 1), or a little of it."""
    angle = np.arctan2(vertices[:, 1], vertices[:, 0])
    ratio = np.cos(np.pi / sides) / np.cos(angle % (2 * np.pi / sides) - np.pi / sides)
    return vertices * np.stack([1 + depth * (ratio - 1)] * 2 + [np.ones(len(angle))], 1)


def near_misses(families):
    """Shapes without a family, made from those that have one."""
    of = {name: families[name] for name in ("sphere", "closed cylinder", "capsule", "disk", "torus", "vase 1")}
    move = {
        "triaxial ellipsoid, 1 : 0.8 : 0.64": ("sphere", lambda v: v * [1, 0.8, 0.64]),
        "triaxial ellipsoid, 1 : 0.6 : 0.36": ("sphere", lambda v: v * [1, 0.6, 0.36]),
        "square prism": ("closed cylinder", lambda v: sided(v, 4)),
        "hexagonal prism": ("closed cylinder", lambda v: sided(v, 6)),
        "hexagon": ("disk", lambda v: sided(v, 6)),
        "dodecagon": ("disk", lambda v: sided(v, 12)),
        "ellipse 1 : 0.9": ("disk", lambda v: v * [1, 0.9, 1]),
        "capsule squashed to 0.8": ("capsule", lambda v: v * [1, 0.8, 1]),
        "torus squashed to 0.8": ("torus", lambda v: v * [1, 0.8, 1]),
        "torus with a bump": ("torus", lambda v: bumped(v, (1.4, 0, 0), 0.3, 0.2)),
        "cylinder with a dent": ("closed cylinder", lambda v: bumped(v, (0.5, 0, 0), -0.2, 0.25)),
        "capsule with a dent": ("capsule", lambda v: bumped(v, (0.5, 0, 0), -0.2, 0.25)),
        "bent vase": ("vase 1", bent),
    }
    return {name: (change(of[start][0]), of[start][1]) for name, (start, change) in move.items()}


def bent(vertices):
    """Bent about an axis beside it."""
    distance, angle = vertices[:, 0] + 1.5, vertices[:, 2] / 2
    return np.stack([distance * np.cos(angle) - 1.5, vertices[:, 1], distance * np.sin(angle)], 1)


def shapes(vertices, seed=0):
    """Group of the table -> name -> (vertices, faces)."""
    rng = np.random.default_rng(seed)
    plain = {name: lathe(profile, vertices, rng) for name, profile in profiles().items()}
    groups = {"surfaces of revolution": plain}
    for share in (0.05, 0.1):
        noisy = {name: (with_noise(*mesh, share, rng), mesh[1]) for name, mesh in plain.items()}
        groups[f"the same with noise of {share:.0%} of an edge"] = noisy
    return groups | {"near misses": near_misses(plain)}


def ask(program, paths):
    """(statistic, verdict, milliseconds) of each mesh."""
    answer = subprocess.run([program, *map(str, paths)], check=True, capture_output=True, text=True).stdout
    rows = [line.rsplit(" ", 3)[1:] for line in answer.splitlines()]
    return [(float(least), verdict == "true", float(milliseconds)) for least, verdict, milliseconds in rows]


def row(label, vertices, answers):
    """A line of the table."""
    least = np.array([answer[0] for answer in answers])
    said = sum(answer[1] for answer in answers)
    times = np.median([answer[2] for answer in answers])
    return [label, vertices, f"{said} of {len(answers)}", f"{least.min():.4f}", f"{np.median(least):.4f}",
            f"{least.max():.4f}", f"{times:.0f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", nargs="*", help="meshes of shapes without a family")
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--program", default="target/release/examples/continuous_family")
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    rows = []
    for vertices in VERTICES:
        for group, meshes in shapes(vertices).items():
            paths = []
            for name, (points, faces) in meshes.items():
                paths.append(arguments.work / f"{vertices}-{len(rows)}-{name.replace(' ', '-').replace(':', '')}.ply")
                write_ply(paths[-1], points, faces)
            answers = ask(arguments.program, paths)
            rows.append(row(group, f"{vertices:,}", answers))
            for path, answer in zip(paths, answers):
                if answer[1] == (group == "near misses"):
                    print(f"not as it should be: {path.name} {answer[0]:.4f}")
    if arguments.meshes:
        rows.append(row("meshes named", "", ask(arguments.program, arguments.meshes)))
    print(table(["shapes", "vertices", "a family", "least", "median", "largest", "ms"], rows))


if __name__ == "__main__":
    main()
