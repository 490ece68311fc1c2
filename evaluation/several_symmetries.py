"""How many of a solid's symmetries the program lists, and how many that it lists are none (docs/method.md).

    python -m evaluation.several_symmetries --work FOLDER [--symmetries 32] [--seed 0]

meshes solids with several symmetries in FOLDER, each turned at random so that no symmetry maps the mesh onto itself, and
compares what is listed with the solid's own isometries.
"""

from __future__ import annotations

import argparse
import functools
import itertools
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import fast_simplification
import numpy as np
from scipy.spatial.transform import Rotation
from skimage.measure import marching_cubes

from training.meshfile import write_ply

from .markdown import table
from .program import detect, ply_vertices

RESOLUTION = 90  # cells along the longest side
FACES = 8000
RIGHT = 0.05  # mean error of a map that is one of the solid's, in sqrt(area)

Distance = Callable[[np.ndarray], np.ndarray]


def box(*half: float, centre=(0, 0, 0)) -> Distance:
    """A box; distances are exact outside."""

    def distance(points):
        away = np.abs(points - np.array(centre)) - np.array(half)
        return np.linalg.norm(np.maximum(away, 0), axis=-1) + np.minimum(away.max(-1), 0)

    return distance


def union(*parts: Distance) -> Distance:
    """All parts together."""
    return lambda points: np.minimum.reduce([part(points) for part in parts])


def prism(sides: int, radius: float, half_height: float) -> Distance:
    """A regular prism about the z axis."""

    def distance(points):
        step = 2 * np.pi / sides
        angle = np.arctan2(points[..., 1], points[..., 0]) % step - step / 2
        flat = np.hypot(points[..., 0], points[..., 1]) * np.cos(angle) - radius
        return np.maximum(flat, np.abs(points[..., 2]) - half_height)

    return distance


def halfspaces(normals, offset: float) -> Distance:
    """A polyhedron of faces with these normals, all as far from the centre."""
    unit = np.array(normals, float)
    unit /= np.linalg.norm(unit, axis=1)[:, None]
    return lambda points: (points @ unit.T).max(-1) - offset


def star(arms: int, twist: float = 0.0) -> Distance:
    """Round arms about the z axis, which bend by `twist` radians towards their ends.

    Bent ones leave no reflection but that in z = 0.
    """

    def distance(points):
        radius = np.hypot(points[..., 0], points[..., 1])
        angle = np.arctan2(points[..., 1], points[..., 0]) - twist * radius
        step = 2 * np.pi / arms
        angle = (angle + step / 2) % step - step / 2
        along, aside = radius * np.cos(angle), radius * np.sin(angle)
        past = along - np.clip(along, 0.1, 1.0)
        return np.sqrt(past**2 + aside**2 + points[..., 2] ** 2) - (0.28 - 0.1 * np.clip(along, 0, 1))

    return distance


def pinwheel(arms: int) -> Distance:
    """A star of bent arms with a bump above, so without any reflection."""
    return union(star(arms, 1.0), lambda points: np.linalg.norm(points - [0, 0, 0.25], axis=-1) - 0.25)


def legged(length: float, width: float) -> Distance:
    """A table."""
    legs = [box(0.08, 0.08, 0.5, centre=(sx * (length - 0.12), sy * (width - 0.12), -0.5))
            for sx, sy in itertools.product((-1, 1), repeat=2)]
    return union(box(length, width, 0.07), *legs)


CUBE_CORNERS = list(itertools.product((-1, 1), repeat=3))
GOLDEN = (1 + np.sqrt(5)) / 2
ICOSAHEDRON_CORNERS = [np.roll([0, a, b * GOLDEN], turn)
                       for a, b in itertools.product((-1, 1), repeat=2) for turn in range(3)]
# New ones go to the end: the random turns of the others stay as they are.
SOLIDS = {
    "box 1 : 1.5 : 2": box(0.5, 0.75, 1.0),
    "square bar 1 : 1 : 4": box(0.3, 0.3, 1.2),
    "cube": box(0.7, 0.7, 0.7),
    "triangular prism": prism(3, 0.45, 0.6),
    "hexagonal prism": prism(6, 0.6, 0.9),
    "octahedron": halfspaces(CUBE_CORNERS, 0.7),
    "tetrahedron": halfspaces([c for c in CUBE_CORNERS if np.prod(c) > 0], 0.4),
    "table": legged(1.1, 0.7),
    "square table": legged(0.8, 0.8),
    "star of 3 arms": star(3),
    "star of 4 arms": star(4),
    "star of 5 arms": star(5),
    "star of 6 arms": star(6),
    "bent star of 4 arms": star(4, 1.0),
    "pinwheel of 2 arms": pinwheel(2),
    "pinwheel of 3 arms": pinwheel(3),
    "pinwheel of 4 arms": pinwheel(4),
    "pinwheel of 5 arms": pinwheel(5),
    "pinwheel of 6 arms": pinwheel(6),
    "pinwheel of 8 arms": pinwheel(8),
    "pinwheel of 12 arms": pinwheel(12),
    "star of 8 arms": star(8),
    "dodecahedron": halfspaces(ICOSAHEDRON_CORNERS, 0.7),
}


@functools.cache
def orthogonal_matrices() -> list[np.ndarray]:
    """The isometries of the cube, of the dodecahedron and of the prisms of 3 to 6, 8 and 12 sides."""
    fifth = Rotation.from_rotvec(2 * np.pi / 5 * np.array([0, 1, GOLDEN]) / np.hypot(1, GOLDEN)).as_matrix()
    third = np.roll(np.eye(3), 1, axis=0)
    signed = [np.eye(3)[list(order)] * np.array(signs)[:, None]
              for order in itertools.permutations(range(3)) for signs in itertools.product((-1, 1), repeat=3)]
    turns = []
    for angle in {2 * np.pi * part / sides for sides in (3, 4, 5, 6, 8, 12) for part in range(sides)}:
        turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        turns += [turn * [1, y, z] for y, z in itertools.product((-1, 1), repeat=2)]
    found: list[np.ndarray] = []

    def add(matrices):
        for matrix in matrices:
            if not any(np.allclose(matrix, other) for other in found):
                found.append(matrix)

    add([-np.eye(3), fifth, third])
    for matrix in found:  # which grows on the way, to all products
        add([matrix @ fifth, matrix @ third, -matrix])
    add(signed + turns)
    return found


def isometries(solid: Distance) -> list[np.ndarray]:
    """Those that leave the solid as it is."""
    points = np.random.default_rng(0).uniform(-1.3, 1.3, (4000, 3))
    return [m for m in orthogonal_matrices() if np.abs(solid(points @ m.T) - solid(points)).max() < 1e-9]


def kind(matrix: np.ndarray) -> str:
    """As the program names it; "" for what it does not look for, and the identity."""
    if np.allclose(matrix, np.eye(3)) or not np.allclose(matrix @ matrix, np.eye(3)):
        return ""
    return "reflection" if np.linalg.det(matrix) < 0 else "half_turn"


def meshed(solid: Distance, turn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Marching cubes on a turned grid, decimated; (vertices in the solid's own frame, faces)."""
    axis = np.linspace(-1.6, 1.6, RESOLUTION)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1)
    vertices, faces, _, _ = marching_cubes(solid(grid @ turn), 0.0)
    vertices = (axis[0] + vertices * (axis[1] - axis[0])) @ turn
    return fast_simplification.simplify(vertices.astype(np.float32), faces, target_count=FACES)


@dataclass
class Listed:
    """What the program listed of one solid."""

    # Different isometries of the solid, by kind.
    true: dict[str, int]
    # Maps near to one that another map was nearest to already.
    repeated: int
    # Maps of no isometry of the solid of the kind that they are listed with.
    other: int


def area(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Of a triangle mesh."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


@dataclass
class Map:
    """One symmetry as the program lists it."""

    kind: str
    # Of each vertex.
    partners: np.ndarray


def judge(vertices, faces, maps: list[Map], group: list[np.ndarray]) -> Listed:
    """Compares `maps` with the isometries of the solid."""
    unit, met, listed = np.sqrt(area(vertices, faces)), set(), Listed({}, 0, 0)
    for found in maps:
        errors = [np.linalg.norm(vertices[found.partners] - vertices @ m.T, axis=1).mean() / unit for m in group]
        best = int(np.argmin(errors))
        if errors[best] > RIGHT or kind(group[best]) != found.kind:
            listed.other += 1
        elif best in met:
            listed.repeated += 1
        else:
            met.add(best)
            listed.true[found.kind] = listed.true.get(found.kind, 0) + 1
    return listed


def listed_maps(path: Path) -> list[Map]:
    """The symmetries in the program's PLY and the report beside it."""
    data, report = ply_vertices(path), json.loads(path.with_suffix(".json").read_text())
    columns = [data[name].astype(int) for name in data.dtype.names if name.startswith("sym_vertex")]
    return [Map(one["kind"], partners) for one, partners in zip(report["symmetries"], columns)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--program", default="target/release/intrinsym")
    parser.add_argument("--symmetries", type=int, default=32)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    turns = Rotation.random(len(SOLIDS), rng=np.random.default_rng(arguments.seed)).as_matrix()
    meshes, paths = {}, []
    for (name, solid), turn in zip(SOLIDS.items(), turns):
        meshes[name] = meshed(solid, turn)
        paths.append(arguments.work / f"{name.replace(' ', '-').replace(':', '')}.ply")
        write_ply(paths[-1], *meshes[name])
    answers = arguments.work / "answers"
    options = ["--symmetries", str(arguments.symmetries)]
    seconds = detect(arguments.program, paths, answers, options, write="ply,json")
    rows = []
    for path, (name, solid) in zip(paths, SOLIDS.items()):
        group, (vertices, faces) = isometries(solid), meshes[name]
        answer = answers / path.name
        listed = judge(vertices, faces, listed_maps(answer) if answer.exists() else [], group)
        kinds = [kind(matrix) for matrix in group]
        numbers = [f"{listed.true.get(of, 0)} of {kinds.count(of)}" for of in ("reflection", "half_turn")]
        rows.append([name, f"{len(vertices):,}", *numbers, listed.repeated, listed.other])
    print(table(["solid", "vertices", "reflections", "half turns", "repeated", "not the solid's"], rows))
    print(f"{seconds / len(SOLIDS):.2f} s of CPU a mesh")


if __name__ == "__main__":
    main()
