"""Skeleton to rest mesh: smooth union of tapered capsules, then marching cubes.

Smooth union by log-sum-exp; marching cubes after Lewiner, Lopes, Vieira and Tavares, "Efficient
Implementation of Marching Cubes' Cases with Topological Guarantees" (2003), in scikit-image.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from skimage.measure import marching_cubes

from .skeleton import Skeleton

BAND = 6.0  # capsules further than this many blending widths contribute nothing


def capsule_distance(points: np.ndarray, skeleton: Skeleton, bone: int, thinner: float = 1.0) -> np.ndarray:
    """Approximate signed distance of `points` (..., 3) to one bone, its radius scaled by `thinner`."""
    start, axis = skeleton.start[bone], skeleton.end[bone] - skeleton.start[bone]
    along = np.clip(((points - start) @ axis) / (axis @ axis + 1e-12), 0, 1)
    radius = skeleton.start_radius[bone] + along * (skeleton.end_radius[bone] - skeleton.start_radius[bone])
    return np.linalg.norm(points - start - along[..., None] * axis, axis=-1) - radius * thinner


def bounds(skeleton: Skeleton) -> tuple[np.ndarray, np.ndarray]:
    """Corners of a box that holds the shape."""
    ends = np.array(skeleton.start + skeleton.end)
    radius = max(skeleton.start_radius + skeleton.end_radius) * 1.3
    return ends.min(0) - radius, ends.max(0) + radius


def field_on_grid(skeleton: Skeleton, axes: list[np.ndarray], blend: float) -> np.ndarray:
    """The smooth union on a grid given by its three coordinate axes; negative inside."""
    total = np.zeros([len(axis) for axis in axes], np.float32)
    for bone in range(len(skeleton.start)):
        reach = max(skeleton.start_radius[bone], skeleton.end_radius[bone]) + BAND * blend
        low = np.minimum(skeleton.start[bone], skeleton.end[bone]) - reach
        high = np.maximum(skeleton.start[bone], skeleton.end[bone]) + reach
        window = tuple(slice(*np.searchsorted(axis, (a, b))) for axis, a, b in zip(axes, low, high))
        points = np.stack(np.meshgrid(*(axis[part] for axis, part in zip(axes, window)), indexing="ij"), -1)
        distance = capsule_distance(points.astype(np.float32), skeleton, bone)
        total[window] += np.exp(np.clip(-distance / blend, -30, 30)).astype(np.float32)
    return -blend * np.log(total + 1e-30)


def rest_mesh(skeleton: Skeleton, cell: float, blend: float, shared_connectivity: bool, rng):
    """Vertices (n, 3) and triangles (m, 3) of the rest shape, the largest piece only.

    With `shared_connectivity` the grid is symmetric about x = 0, so every vertex has an exact partner;
    without, the grid is shifted at random and the two sides are triangulated independently.
    """
    low, high = bounds(skeleton)
    if shared_connectivity:
        half = int(np.ceil(max(-low[0], high[0]) / cell)) + 1
        x_axis = np.arange(-half, half + 1) * cell
    else:
        x_axis = np.arange(low[0] - rng.uniform(0.2, 0.8) * cell, high[0] + 2 * cell, cell)
    axes = [x_axis] + [np.arange(low[k] - rng.uniform() * cell, high[k] + 2 * cell, cell) for k in (1, 2)]
    values = field_on_grid(skeleton, axes, blend)
    if shared_connectivity:
        values = np.minimum(values, values[::-1])
    vertices, faces, _, _ = marching_cubes(values, 0.0)
    vertices = vertices * cell + [axis[0] for axis in axes]
    return largest_piece(vertices, faces.astype(np.int64))


def largest_piece(vertices: np.ndarray, faces: np.ndarray):
    """The connected component with the most vertices, unused vertices dropped."""
    rows, columns = faces.ravel(), np.roll(faces, 1, axis=1).ravel()
    graph = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(len(vertices),) * 2)
    _, piece = connected_components(graph, directed=False)
    used = np.bincount(piece[faces[:, 0]], minlength=piece.max() + 1)
    return keep_faces(vertices, faces, piece[faces[:, 0]] == used.argmax())[:2]


def keep_faces(vertices: np.ndarray, faces: np.ndarray, keep: np.ndarray):
    """The mesh of the faces marked in `keep`; returns (vertices, faces, old index of each vertex)."""
    kept = np.unique(faces[keep])
    renumber = np.full(len(vertices), -1)
    renumber[kept] = np.arange(len(kept))
    return vertices[kept], renumber[faces[keep]], kept
