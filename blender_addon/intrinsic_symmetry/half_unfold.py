# SPDX-License-Identifier: GPL-3.0-or-later
"""Unfolds a copied half, where the map's images of neighbouring vertices change places or fall together.

Around each edge that is creased and whose model is not, the copy takes the winning half's form, held by what is around
it; if creases are left, in a wider region.
"""

import numpy as np
from intrinsym import Merge

from . import mesh_data, stored_map

#: An edge is creased if the cosine between the normals of its faces is below the first, and that of its model is above
#: the second.
_CREASED, _SMOOTH = -0.3, 0.3
#: A face has fallen together if it has less than this share of its model's area.
_TINY = 1e-2
_ROUNDS = 6


def unfolded(mesh, core_mesh, symmetry, places, models, copies):
    """(vertices, 3) places of which the copies, (vertices,) bool, are not folded more than the `models` are. `symmetry`
    is the map of the new mesh."""
    faces, ends = _Faces(mesh), mesh_data.edges(mesh)
    merge = Merge.POSITIVE_WINS if symmetry.side[copies].max(initial=-1) < 0 else Merge.NEGATIVE_WINS
    for rings in range(1, _ROUNDS + 1):
        inside = np.zeros(len(places), bool)
        inside[faces.corners_of(faces.folded(places, models))] = True
        inside &= copies
        if not inside.any():
            break
        for _ in range(rings):
            inside[ends[inside[ends].any(axis=1)]] = True
        inside &= copies
        held = core_mesh.restore(symmetry.kind, symmetry.partner, inside.astype(float), symmetry.side, symmetry.surface_points)
        new = held.symmetrize_positions(places, merge, minimum_confidence=stored_map.LEAST)
        places = np.where(inside[:, None], new, places)
    return places


class _Faces:
    """The faces of a mesh and the edges between two of them."""

    def __init__(self, mesh):
        self._offsets, self._corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
        self._sizes = np.diff(self._offsets)
        self._of = np.repeat(np.arange(len(self._sizes)), self._sizes)
        edge = mesh_data.read_attribute(mesh.attributes[".corner_edge"])
        order = np.argsort(edge, kind="stable")
        shared = np.flatnonzero(np.bincount(edge, minlength=len(mesh.edges)) == 2)
        first = np.searchsorted(edge[order], shared)
        self._pairs = self._of[np.stack([order[first], order[first + 1]], axis=1)]

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
