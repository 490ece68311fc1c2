"""Parts of generated assemblies: bodies turned on a lathe and sheets, triangulated in three styles.

Lengths are in units of about one body height; x = 0 is the mirror plane, y points to the front, z up.
"""

from __future__ import annotations

from dataclasses import dataclass

import fast_simplification
import numpy as np
from scipy.spatial import cKDTree

from training.skeleton import MIRROR, unit

X, Y, Z = np.eye(3)
FRONT = Y
STYLES = ("same", "recut", "remeshed")
# A remeshed part is simplified from this many times its triangles.
DENSER = 2.5


@dataclass
class Cut:
    """How parts are triangulated: `same` gives twins one connectivity, `recut` cuts each quad along a random diagonal,
    `remeshed` gives each part vertices of its own."""

    style: str
    rng: np.random.Generator
    detail: float = 1.0

    def counts(self, rings: int, columns: int, even: bool) -> tuple[int, int]:
        """Size of the grid that a part is sampled on."""
        scale = self.detail
        if self.style == "remeshed":
            scale *= np.sqrt(DENSER) * self.rng.uniform(0.9, 1.15)
        rings, columns = max(round(rings * scale), 3), max(round(columns * scale), 4 if even else 2)
        return rings, columns + (columns % 2 if even else 0)

    def phase(self) -> float:
        """Where the first column starts, in columns."""
        return float(self.rng.uniform()) if self.style == "remeshed" else 0.0

    def triangles(self, quads: np.ndarray, columns: int) -> np.ndarray:
        """Two triangles for each quad (n, 4) of a grid with so many quads a row."""
        first_half = np.arange(len(quads)) % columns < columns / 2
        along = first_half if self.style == "same" else self.rng.random(len(quads)) < 0.5
        a, b, c, d = quads.T
        one = np.where(along[:, None], np.c_[a, b, c], np.c_[a, b, d])
        other = np.where(along[:, None], np.c_[a, c, d], np.c_[b, c, d])
        return np.concatenate([one, other])

    def finished(self, vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The part as it is written."""
        if self.style != "remeshed":
            return vertices, faces
        points, faces = fast_simplification.simplify(
            vertices.astype(np.float32), faces.astype(np.int32), target_count=max(round(len(faces) / DENSER), 8)
        )
        return points.astype(float), faces.astype(np.int64)


def along_path(path: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points and unit tangents at `t` in 0..1 of a line of points."""
    knots = np.r_[0, np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))]
    knots = knots / knots[-1]
    at = lambda s: np.stack([np.interp(np.clip(s, 0, 1), knots, path[:, k]) for k in range(3)], 1)
    tangent = at(t + 0.03) - at(t - 0.03)
    return at(t), tangent / np.linalg.norm(tangent, axis=1, keepdims=True)


@dataclass
class Lathe:
    """A closed body around `path`. `radii` at equal steps: one number or (side, front). `ends`: 2 is an ellipsoid, 12 a
    cylinder. `section`: 2 is round, 6 nearly square. `bulge`: how much further the front reaches than the back."""

    path: np.ndarray
    radii: np.ndarray
    rings: int = 12
    sectors: int = 16
    ends: float = 3.0
    section: float = 2.0
    bulge: float = 0.12
    front: np.ndarray = None

    def made(self, cut: Cut) -> tuple[np.ndarray, np.ndarray]:
        """Vertices and triangles; the two poles lie at the ends of the path."""
        rings, sectors = cut.counts(self.rings, self.sectors, True)
        t = (1 - np.cos(np.pi * np.arange(1, rings + 1) / (rings + 1))) / 2
        path = np.asarray(self.path, float)
        centre, tangent = along_path(path, t)
        front = np.asarray(FRONT if self.front is None else self.front, float)
        front = front - (tangent @ front)[:, None] * tangent
        front /= np.linalg.norm(front, axis=1, keepdims=True)
        side = np.cross(tangent, front)
        radii = np.asarray(self.radii, float)
        radii = radii if radii.ndim == 2 else np.c_[radii, radii]
        steps = np.linspace(0, 1, len(radii))
        closing = (1 - np.abs(2 * t - 1) ** self.ends) ** (1 / self.ends)
        wide, deep = (np.interp(t, steps, radii[:, k]) * closing for k in (0, 1))
        angle = 2 * np.pi * (np.arange(sectors) + cut.phase()) / sectors
        power = lambda wave: np.sign(wave) * np.abs(wave) ** (2 / self.section)
        ahead, aside = power(np.cos(angle)), power(np.sin(angle))
        ahead = ahead * (1 + self.bulge * ahead)
        ring = centre[:, None] + deep[:, None, None] * ahead[None, :, None] * front[:, None]
        ring = ring + wide[:, None, None] * aside[None, :, None] * side[:, None]
        vertices = np.concatenate([ring.reshape(-1, 3), path[:1], path[-1:]])
        return cut.finished(vertices, _lathe_faces(cut, rings, sectors))


def _lathe_faces(cut: Cut, rings: int, sectors: int) -> np.ndarray:
    row, column = (part.ravel() for part in np.mgrid[: rings - 1, :sectors])
    next_column = (column + 1) % sectors
    quads = np.c_[row * sectors + column, row * sectors + next_column, (row + 1) * sectors + next_column, (row + 1) * sectors + column]
    around = np.arange(sectors)
    beyond, last = (around + 1) % sectors, (rings - 1) * sectors
    first_pole, last_pole = rings * sectors, rings * sectors + 1
    lids = [np.c_[beyond, around, np.full(sectors, first_pole)], np.c_[last + around, last + beyond, np.full(sectors, last_pole)]]
    return np.concatenate([cut.triangles(quads, sectors), *lids])


@dataclass
class Sheet:
    """An open strip along `path`, `width` wide at equal steps, facing `normal`, cupped by `cup` widths."""

    path: np.ndarray
    width: np.ndarray
    normal: np.ndarray
    rings: int = 8
    columns: int = 3
    cup: float = 0.15

    def made(self, cut: Cut) -> tuple[np.ndarray, np.ndarray]:
        """Vertices and triangles."""
        rings, columns = cut.counts(self.rings, self.columns, False)
        t, u = np.linspace(0, 1, rings), np.linspace(-1, 1, columns + 1)
        centre, tangent = along_path(np.asarray(self.path, float), t)
        across = np.cross(tangent, self.normal)
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        upward = np.cross(across, tangent)
        half = np.interp(t, np.linspace(0, 1, len(self.width)), self.width)[:, None, None] / 2
        grid = centre[:, None] + half * (u[None, :, None] * across[:, None] - 2 * self.cup * u[None, :, None] ** 2 * upward[:, None])
        row, column = (part.ravel() for part in np.mgrid[: rings - 1, :columns])
        corner = row * (columns + 1) + column
        quads = np.c_[corner, corner + 1, corner + columns + 2, corner + columns + 1]
        return cut.finished(grid.reshape(-1, 3), cut.triangles(quads, columns))


def ball(centre, radius, rings: int = 7, sectors: int = 12, axis=(0, 0, 1), bulge: float = 0.0) -> Lathe:
    """An ellipsoid; `radius` one number or (side, front, along the axis)."""
    side, front, along = np.broadcast_to(radius, 3)
    centre, axis = np.asarray(centre, float), unit(np.asarray(axis, float)) * along
    return Lathe(np.array([centre - axis, centre + axis]), np.array([[side, front]] * 2), rings, sectors, 2.0, 2.0, bulge, _ahead(axis))


def block(centre, half, rings: int = 7, sectors: int = 12, bulge: float = 0.0) -> Lathe:
    """A rounded box with half sides (x, y, z)."""
    centre, up = np.asarray(centre, float), np.array([0, 0, half[2]])
    return Lathe(np.array([centre - up, centre + up]), np.array([half[:2]] * 2), rings, sectors, 10.0, 6.0, bulge)


def disc(centre, axis, radius: float, half_width: float, sectors: int = 18) -> Lathe:
    """A wheel around `axis`."""
    centre, axis = np.asarray(centre, float), unit(np.asarray(axis, float)) * half_width
    return Lathe(np.array([centre - axis, centre + axis]), np.array([radius, radius]), 6, sectors, 6.0, 2.0, 0.0, _ahead(axis))


def _ahead(axis: np.ndarray) -> np.ndarray:
    return FRONT if abs(axis[1]) < 0.8 * np.linalg.norm(axis) else np.array([0.0, 0.0, 1.0])


def mirrored(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The mirror image in x = 0, facing outwards."""
    return vertices * MIRROR, faces[:, ::-1]


def fused(body, prop) -> tuple[np.ndarray, np.ndarray]:
    """One surface of two: the nearest two triangles give way to a tube between them. The body's vertices come first."""
    (vertices, faces), (others, other_faces) = body, prop
    distance, nearest = cKDTree(vertices[faces].mean(1)).query(others[other_faces].mean(1))
    there = int(distance.argmin())
    here, offset = int(nearest[there]), len(vertices)
    all_vertices, moved = np.concatenate([vertices, others]), other_faces + offset
    a, b = faces[here], moved[there][::-1]
    apart = lambda k: np.linalg.norm(all_vertices[a] - all_vertices[np.roll(b, k)], axis=1).sum()
    c = np.roll(b, min(range(3), key=apart))
    a_next, c_next = np.roll(a, -1), np.roll(c, -1)
    tube = np.concatenate([np.c_[a, a_next, c_next], np.c_[a, c_next, c]])
    return all_vertices, np.concatenate([np.delete(faces, here, 0), np.delete(moved, there, 0), tube])
