"""What a map of vertices is worth: against landmarks, and by itself.

The correspondence rate and the mesh rate are those of V. Kim, Y. Lipman, X. Chen, T. Funkhouser, "Mobius Transformations
for Global Intrinsic Symmetry Analysis", 2010, which the literature reports. Their threshold is loose: a map that hardly
moves anything can pass, so the mean error and the area turned over stand beside them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .surface import Surface

# A landmark is right if its image lies within this many sqrt(area) of the true one.
THRESHOLD = 1 / np.sqrt(20)
# A mesh is right if this share of its landmarks is.
MESH_RIGHT = 0.75
# Landmarks whose distance is this near to the threshold (relatively) are measured exactly.
CLOSE_CALL = 0.02
CYCLE_SAMPLES = 1000


@dataclass
class MapMetrics:
    """Distances in sqrt(area), shares in 0..=1; NaN where nothing was answered."""

    # Share of landmarks whose image is within THRESHOLD of the true one; no answer counts as wrong.
    correspondence_rate: float
    # Mean distance between image and true image over the landmarks that have an answer.
    mean_error: float
    # Share of landmarks that hit the true vertex.
    exact_share: float
    # Share of the mesh's vertices that are the image of some vertex: 1 for a bijection.
    bijectivity: float
    # Mean distance of a vertex from the image of its image.
    cycle_error: float
    # Share of the area whose triangles the map turns over: near 1 for a reflection, 0 for a rotation.
    turned_share: float
    # Share of vertices that are their own image: 1 for the identity.
    fixed_share: float

    @property
    def mesh_right(self) -> bool:
        """Whether the mesh counts for the mesh rate."""
        return self.correspondence_rate >= MESH_RIGHT


def measure(surface: Surface, partners: np.ndarray, points: np.ndarray, images: np.ndarray) -> MapMetrics:
    """Judges `partners` (-1: no answer) by landmarks: the mirror image of vertex `points[i]` is vertex `images[i]`."""
    answered = partners[points]
    distance = landmark_distances(surface, answered, images)
    return MapMetrics(
        correspondence_rate=float((distance <= THRESHOLD).mean()),
        mean_error=_finite_mean(distance),
        exact_share=float((answered == images).mean()),
        bijectivity=len(np.unique(partners[partners >= 0])) / len(partners),
        cycle_error=cycle_error(surface, partners),
        turned_share=turned_share(surface, partners),
        fixed_share=float((partners == np.arange(len(partners))).mean()),
    )


def landmark_distances(surface: Surface, answered: np.ndarray, images: np.ndarray) -> np.ndarray:
    """Distance of each answer from its true image, infinite where there is none; close calls are settled exactly."""
    distance = np.full(len(images), np.inf)
    some = answered >= 0
    distance[some] = surface.distances(answered[some], images[some])
    for index in np.flatnonzero(np.abs(distance / THRESHOLD - 1) < CLOSE_CALL):
        distance[index] = min(distance[index], surface.exact_distance(answered[index], images[index]))
    return distance


def cycle_error(surface: Surface, partners: np.ndarray) -> float:
    """Mean distance of a vertex from the image of its image, over a fixed random sample."""
    vertices = np.flatnonzero(partners >= 0)
    if len(vertices) > CYCLE_SAMPLES:
        vertices = np.random.default_rng(0).choice(vertices, CYCLE_SAMPLES, replace=False)
    back = partners[partners[vertices]]
    return _finite_mean(surface.distances(back[back >= 0], vertices[back >= 0]))


def turned_share(surface: Surface, partners: np.ndarray) -> float:
    """Share of the area that the map turns over, triangles that it collapses left out."""
    images = partners[surface.triangles]
    mapped = (images >= 0).all(axis=1)
    images = images[mapped]
    corners = surface.vertices[images]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = (normals * surface.vertex_normals[images].sum(axis=1)).sum(axis=1)
    kept = np.linalg.norm(normals, axis=1) > 1e-9 * surface.area
    areas = np.linalg.norm(surface.normals[mapped], axis=1) * kept
    return float(areas[facing < 0].sum() / areas.sum()) if areas.sum() > 0 else float("nan")


def _finite_mean(values: np.ndarray) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if len(finite) else float("nan")
