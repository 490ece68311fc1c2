# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface that was there before an edit, as its mirror images show it.

Images of the vertices of one side lie on the other side. So the faces of the side that was not edited, drawn at the
images of their vertices, are the surface that was edited. The nearest point of it says where the image of a new vertex
is, and how far the vertex stands off the surface.
"""

from dataclasses import dataclass

import numpy as np

from . import mesh_data
from .neighbour_means import filled
from .surface import Mix, Surface

#: A vertex lies on the surface if it is nearer than this share of its longest edge.
ON = 1e-3
#: A vertex that is nearer than this share of its longest edge is likely made on the surface.
CLOSE = 0.1
#: A weight below this is none.
_LEAST = 1e-6


@dataclass(frozen=True)
class Feet:
    """Nearest points of the surface: their faces, the Mix of the vertices whose images they are between, how far they are
    from the points, whether they are below them, and not at a border that the edit has left, and whether nothing that
    the edit took away can have been nearer."""

    faces: np.ndarray
    mix: Mix
    away: np.ndarray
    below: np.ndarray
    sure: np.ndarray


class ImageSurface:
    """Of the vertices `there`, (vertices,) bool, with `images`, (vertices, 3), of when the map was stored, which have
    `moved`, (vertices, 3), since; NaN where that is not known."""

    def __init__(self, mesh, images, moved, there):
        self._mesh, self._there, self.before = mesh, there, images
        moved = filled(np.where(there[:, None], moved, np.nan), mesh_data.edges(mesh).astype(np.int64), images)
        self.images = images + np.nan_to_num(moved)
        offsets, corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
        edited = ~np.logical_and.reduceat(there[corners], offsets[:-1])
        self._inner = there.copy()
        self._inner[corners[np.repeat(edited, np.diff(offsets))]] = False

    def feet(self, points, reach):
        """The Feet of (n, 3) points, or nothing; those farther away than `reach`, (n,), need not be the nearest."""
        margin = reach.max(initial=0)
        near = (self.images > points.min(axis=0) - margin) & (self.images < points.max(axis=0) + margin)
        surface = Surface(self._mesh, self.images, self._there & near.all(axis=1), np.all)
        if not len(surface.faces):
            return None
        triangle, weights = surface.feet(points)
        mix = Mix(surface.vertices[triangle], weights)
        away = np.linalg.norm(mix.of(self.images) - points, axis=1)
        used, inner = weights > _LEAST, self._inner[mix.rows]
        within, on = used.all(axis=1), away <= ON * reach
        below = within | (used & inner).any(axis=1) | on
        sure = (inner | ~used).all(axis=1) | within & (away <= CLOSE * reach) | on
        return Feet(surface.faces[triangle], mix, away, below, sure)
