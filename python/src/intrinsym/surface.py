"""Points and lines on the surface of a mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays

#: Entry of unsigned index arrays that stands for "none".
NONE = 2**32 - 1


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """The exact mirror image of each vertex, a point of the surface."""

    #: (vertices,) uint32: the face of the input that holds the image; 2**32 - 1 without partner.
    faces: NDArray[np.uint32]
    #: (vertices, 3) uint32: three vertices of that face; 2**32 - 1 without partner.
    corners: NDArray[np.uint32]
    #: (vertices, 3) float32: weights of the corners, 0..1, summing to 1; 0 without partner.
    barycentrics: NDArray[np.float32]

    def positions(self, vertices: ArrayLike) -> NDArray[np.float64]:
        """(vertices, 3) positions of the images, for (vertices, 3) positions; NaN without partner."""
        points = _arrays.plain(vertices, "vertices").astype(np.float64)
        found = np.not_equal(self.faces, NONE)
        images: NDArray[np.float64] = np.full((len(self.faces), 3), np.nan)
        weights, corners = self.barycentrics[found], self.corners[found]
        images[found] = np.einsum("vk,vkx->vx", weights, points[corners])
        return images


@dataclass(frozen=True, eq=False)
class CurveLine:
    """One line of the fixed curve, where the symmetry leaves the surface in place."""

    #: (points, 2) uint32: each point lies on the segment between these two vertices ...
    edges: NDArray[np.uint32]
    #: (points,) float32: ... at (1 - t) * first + t * second.
    parameters: NDArray[np.float32]
    #: Whether the last point joins the first.
    closed: bool

    def positions(self, vertices: ArrayLike) -> NDArray[np.float64]:
        """(points, 3) positions, for (vertices, 3) positions of the mesh."""
        ends: NDArray[np.float64] = _arrays.plain(vertices, "vertices").astype(np.float64)[self.edges]
        t: NDArray[np.float64] = self.parameters[:, None].astype(np.float64)
        return np.add((1 - t) * ends[:, 0], t * ends[:, 1])
