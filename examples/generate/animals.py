"""A quadruped in stride, and a blob without any symmetry: both procedural, both CC0."""

import numpy as np
from scipy.spatial import cKDTree

from .implicit import Capsules, mesh
from .rig import Rig, rotation

X, Y, Z = np.eye(3)
# Joints of the right half (x >= 0) and the middle: name -> (parent, rest position), x right, y forward, z up.
MIDDLE = {
    "hips": (None, (0, -0.55, 0.90)), "chest": ("hips", (0, 0.35, 0.92)), "neck": ("chest", (0, 0.62, 1.10)),
    "head": ("neck", (0, 0.86, 1.42)), "nose": ("head", (0, 1.22, 1.30)), "tail": ("hips", (0, -0.80, 0.98)),
    "tail_tip": ("tail", (0, -1.25, 0.62)),
}
SIDE = {
    "shoulder": ("chest", (0.17, 0.42, 0.76)), "elbow": ("shoulder", (0.19, 0.34, 0.44)),
    "fore_foot": ("elbow", (0.19, 0.38, 0.05)), "thigh": ("hips", (0.16, -0.58, 0.76)),
    "knee": ("thigh", (0.18, -0.46, 0.45)), "hind_foot": ("knee", (0.18, -0.60, 0.05)),
    "ear": ("head", (0.07, 0.84, 1.50)), "ear_tip": ("ear", (0.19, 0.79, 1.66)),
}
# Bones as (joint, joint, radius, radius); names of SIDE stand for both sides.
BONES = [
    ("hips", "chest", 0.21, 0.24), ("chest", "neck", 0.21, 0.15), ("neck", "head", 0.13, 0.12),
    ("head", "nose", 0.12, 0.07), ("tail", "tail_tip", 0.055, 0.045), ("hips", "tail", 0.10, 0.05),
    ("shoulder", "elbow", 0.11, 0.075), ("elbow", "fore_foot", 0.07, 0.055), ("thigh", "knee", 0.13, 0.08),
    ("knee", "hind_foot", 0.07, 0.055), ("ear", "ear_tip", 0.055, 0.05),
]
POSE = {
    "shoulder.R": [(X, 16)], "elbow.R": [(X, -19)], "shoulder.L": [(X, -12)], "elbow.L": [(X, -5)],
    "thigh.R": [(X, -13)], "knee.R": [(X, -6)], "thigh.L": [(X, 12)], "knee.L": [(X, -10)],
    "neck": [(Z, -7)], "head": [(Z, -11), (X, -4)], "hips": [], "chest": [(Z, -5)],
    "tail": [(Z, 19), (X, -10)], "ear.L": [(Y, -9)],
}


def both_sides(name):
    """The names that a joint of MIDDLE or SIDE stands for."""
    return [name] if name in MIDDLE else [name + ".R", name + ".L"]


def skeleton():
    """Rest position and parent of every joint, the left half mirrored from the right."""
    heads = {name: np.array(place) for name, (_, place) in MIDDLE.items()}
    parents = {name: parent for name, (parent, _) in MIDDLE.items()}
    for name, (parent, place) in SIDE.items():
        for suffix, sign in ((".R", 1), (".L", -1)):
            heads[name + suffix] = np.array(place) * [sign, 1, 1]
            parents[name + suffix] = parent + suffix if parent in SIDE else parent
    return heads, parents


def quadruped(spacing=0.044):
    """Positions, faces and mirror table of a quadruped in stride.

    The rest shape is symmetric about x = 0 while its mesh is not; the partner of a vertex is the vertex
    nearest to its mirror image at rest."""
    heads, parents = skeleton()
    cones, owners = [], []
    for start, end, r0, r1 in BONES:
        for a, b in zip(both_sides(start) * 2, both_sides(end)):
            cones.append((heads[a], heads[b], r0, r1))
            owners.append(a)
    surface = Capsules(cones, blend=0.035)
    turn = rotation((0.3, 1, 0.5), 27)
    rest, faces = mesh(surface, (-0.6, -1.5, -0.2), (0.6, 1.5, 2.0), spacing, turn)
    partners = cKDTree(rest).query(rest * [-1, 1, 1])[1]
    nearness = np.exp(-np.maximum(surface.cone_distances(rest), -0.02) / 0.045)
    weights = {}
    for owner, column in zip(owners, nearness.T):
        weights[owner] = weights.get(owner, 0) + column
    return Rig(heads, parents).skin(rest, weights, POSE), faces, partners


def blob(spacing=0.085, seed=5):
    """Positions and faces of a lump with seven arms of unlike length and girth in unlike directions."""
    random = np.random.default_rng(seed)
    directions = random.normal(size=(7, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    lengths, girths = np.linspace(0.75, 2.0, 7), random.permutation(np.linspace(0.14, 0.36, 7))
    cones = [((0, 0, 0), direction * length, 0.45, girth)
             for direction, length, girth in zip(directions, lengths, girths)]
    surface = Capsules(cones, blend=0.08)
    return mesh(surface, (-2.5,) * 3, (2.5,) * 3, spacing, rotation((1, 2, 3), 40))
