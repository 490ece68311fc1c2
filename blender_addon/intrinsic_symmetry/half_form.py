# SPDX-License-Identifier: GPL-3.0-or-later
"""Gives regions of a copied half the form of the winning half: what was extruded there, and what is folded, where the
map's images of neighbouring vertices change places or fall together.

A region is moved as a rigid mirrored piece to where the copied vertices around it are (B. K. P. Horn, "Closed-form
solution of absolute orientation using orthonormal matrices", 1988), and bent to meet them.
"""

import numpy as np

from . import mesh_data
from .elements import components
from .neighbour_means import filled

#: An edge is creased if the cosine between the normals of its faces is below the first, and that of its model is above
#: the second.
_CREASED, _SMOOTH = -0.3, 0.3
#: A face has fallen together if it has less than this share of its model's area.
_TINY = 1e-2
#: Rounds of unfolding, each in wider regions; rings of vertices around a region that it is fitted to.
_ROUNDS, _AROUND = 6, 2


class Form:
    """A mesh of which copies, (vertices,) bool, are to have the form of their models, (vertices, 3). `fitted` are the
    copies and the line; `whole`, (vertices,) bool, lie at old vertices, and what is creased between them was so."""

    def __init__(self, mesh, models, copies, fitted, whole):
        self._models, self._copies, self._fitted = models, copies, fitted
        self._ends = mesh_data.edges(mesh).astype(np.int64)
        self._faces = _Faces(mesh, whole)

    def placed(self, places, extruded):
        """(vertices, 3) places, changed where the models are `extruded`, (vertices,) bool, or the copies folded."""
        inside = extruded & self._copies
        if inside.any():
            places = self._moved(places, inside)
        for rings in range(1, _ROUNDS + 1):
            folded = np.zeros(len(places), bool)
            folded[self._faces.corners_of(self._faces.folded(places, self._models))] = True
            if not (folded & self._copies).any():
                break
            places = self._moved(places, self._grown(folded & self._copies, rings) & self._copies)
        return places

    def _grown(self, inside, rings):
        inside = inside.copy()
        for _ in range(rings):
            inside[self._ends[inside[self._ends].any(axis=1)]] = True
        return inside

    def _moved(self, places, inside):
        """Places whose regions, `inside`, have the form of the models."""
        near = self._grown(inside, _AROUND) & self._fitted
        ends = self._ends[near[self._ends].all(axis=1)]
        region, rows = components(len(places), ends), np.flatnonzero(near)
        order = rows[np.argsort(region[rows], kind="stable")]
        there = places.copy()
        for mine in np.split(order, np.flatnonzero(np.diff(region[order])) + 1):
            border = mine[~inside[mine]]
            if len(border) > 2:
                there[mine] = _mirrored(self._models[border], places[border], self._models[mine])
        missing = np.where(inside[:, None], np.nan, places - there)
        missing[~near] = 0
        return np.where(inside[:, None], there + np.nan_to_num(filled(missing, ends, self._models)), places)


def _mirrored(points, places, moved):
    """Moved points, as the reflection and rotation moves them that brings points, (n, 3), nearest to places."""
    middle, centre = points.mean(axis=0), places.mean(axis=0)
    left, _, right = np.linalg.svd((points - middle).T @ (places - centre))
    right[-1] *= -np.sign(np.linalg.det(left @ right))
    return (moved - middle) @ (left @ right) + centre


class _Faces:
    """The faces of a mesh and the edges between two of them."""

    def __init__(self, mesh, whole):
        self._offsets, self._corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
        self._sizes = np.diff(self._offsets)
        self._of = np.repeat(np.arange(len(self._sizes)), self._sizes)
        edge = mesh_data.read_attribute(mesh.attributes[".corner_edge"])
        order = np.argsort(edge, kind="stable")
        shared = np.flatnonzero(np.bincount(edge, minlength=len(mesh.edges)) == 2)
        first = np.searchsorted(edge[order], shared)
        pairs = self._of[np.stack([order[first], order[first + 1]], axis=1)]
        was = np.logical_and.reduceat(whole[self._corners], self._offsets[:-1])
        self._pairs = pairs[~was[pairs].all(axis=1)]

    def _normals(self, places):
        """(faces, 3) as long as twice the area."""
        step = np.arange(len(self._corners)) - self._offsets[self._of]
        following = self._corners[self._offsets[self._of] + (step + 1) % self._sizes[self._of]]
        first = places[self._corners[self._offsets[self._of]]]
        turned = np.cross(places[self._corners] - first, places[following] - first)
        return np.add.reduceat(turned, self._offsets[:-1])

    def folded(self, places, models):
        """Numbers of the faces at places that are folded where the models are not."""
        now, wanted = self._normals(places), self._normals(models)
        areas, least = (np.linalg.norm(normals, axis=1) for normals in (now, wanted))
        cosines = [_cosines(normals, self._pairs) for normals in (now, wanted)]
        creased = self._pairs[(cosines[0] < _CREASED) & (cosines[1] > _SMOOTH)]
        return np.union1d(creased.ravel(), np.flatnonzero(areas < _TINY * least))

    def corners_of(self, faces):
        chosen = np.zeros(len(self._sizes), bool)
        chosen[faces] = True
        return self._corners[chosen[self._of]]


def _cosines(normals, pairs):
    one, two = normals[pairs[:, 0]], normals[pairs[:, 1]]
    lengths = np.linalg.norm(one, axis=1) * np.linalg.norm(two, axis=1)
    return np.einsum("px,px->p", one, two) / np.maximum(lengths, 1e-30)
