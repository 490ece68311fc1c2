"""Ground truth: the exact mirror map, carried as the nearest point to the mirrored rest position."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from .skeleton import MIRROR

NO_PARTNER = -1
EXACT = 1e-4  # a vertex this near (in mean edges) to the mirrored position is the partner, whatever its normal


def vertex_normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Area-weighted unit normals (n, 3)."""
    corner = vertices[faces]
    face_normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normals = np.zeros_like(vertices)
    for column in range(3):
        np.add.at(normals, faces[:, column], face_normal)
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-20)


def mean_edge(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Mean length of the triangles' sides."""
    return float(np.linalg.norm(vertices[faces] - vertices[np.roll(faces, 1, axis=1)], axis=2).mean())


def mirror_map(rest: np.ndarray, faces: np.ndarray, tolerance: float = 2.0) -> np.ndarray:
    """For each vertex the vertex nearest to its mirror image in the rest pose, or -1.

    The distance also counts normals (times the mean edge), so that two thin sheets are not confused.
    A partner further away than `tolerance` mean edges does not exist (holes, cut limbs, bridges).
    """
    edge = mean_edge(rest, faces)
    normals = vertex_normals(rest, faces)
    tree = cKDTree(np.c_[rest, normals * edge])
    distance, partner = tree.query(np.c_[rest * MIRROR, normals * MIRROR * edge])
    exact_distance, exact = cKDTree(rest).query(rest * MIRROR)
    partner = np.where(exact_distance <= EXACT * edge, exact, partner)
    return np.where(distance <= tolerance * edge, partner, NO_PARTNER)
