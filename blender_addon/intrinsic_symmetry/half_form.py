# SPDX-License-Identifier: GPL-3.0-or-later
"""Places a copied half where the surface that was there cannot say it alone.

What an edit has made is moved by the one rigid motion that moves all that is around it, if there is one. Else, what stands a
little off the surface, as a bevel, stands as far off its image; what stands off farther, as an extrusion,
is moved as a rigid mirrored piece to where the copied vertices around it are. Regions that are folded, since the map's
images of neighbouring vertices change places or fall together, are drawn smooth on the surface; or moved as a piece,
too, where that leaves more folds, or little of the region, as of a fingertip.
"""

import numpy as np

from . import mesh_data, rigid_pieces
from .neighbour_means import filled, longest_edges
from .regions import components, parts
from .surface import Surface

#: What is farther off the surface than this share of its longest edge is moved as a piece.
_FAR = 0.5
#: And so is what is beside its place by more than this share.
_BESIDE = 0.1
#: An edge is creased if the cosine between the normals of its faces is below the first, and that of its model is above
#: the second.
_CREASED, _SMOOTH = -0.3, 0.3
#: A face has fallen together if it has less than this share of its model's area.
_TINY = 1e-2
#: A region that is drawn smooth has at least this share of its models' area, and at most this share of its folds left
#: (or no more than as a piece).
_KEPT, _LEFT = 0.5, 0.5
#: Rounds of unfolding, each in wider regions.
_ROUNDS = 6
#: A change that ends the drawing smooth, as a share of the largest value.
_STILL = 1e-4


class Form:
    """A mesh of which copies, (vertices,) bool, are like their models, (vertices, 3), and lie on the `surface` as `mix`
    says. `fitted` are the copies and the line; `whole`, (vertices,) bool, lie at old vertices, and what is creased
    between them was so; `kept`, (vertices,) bool, are those of them that are exact, and stay there; `added`,
    (vertices,) bool, are copies of shells without images, which go with what is nearest."""

    def __init__(self, mesh, surface, mix, models, copies, fitted, whole, kept, added):
        self._mesh, self._surface, self._mix, self._models = mesh, surface, mix, models
        self._copies, self._fitted, self._kept, self._added = copies, fitted, kept, added
        self._ends = mesh_data.edges(mesh).astype(np.int64)
        self._faces = _Faces(mesh, whole, models)

    def placed(self, images, lift, beside, without, made):
        """(vertices, 3) the places of all vertices: `images`, (vertices, 3), if they are numbers; off the surface by `lift`, (vertices, 3). Otherwise where an edit has
        `made` it, (vertices,) bool, that is far, or its foot is not at the place that the mix says, but `beside` it,
        (vertices,), where the models have no images, `without`, (vertices,) bool, or where they are folded. Of those that
        are drawn smooth the mix is changed."""
        reach = longest_edges(self._ends, self._models)
        far = (np.linalg.norm(lift, axis=1) > _FAR * reach) | lift.any(axis=1) & (beside > _BESIDE * reach)
        places = self._mix.of(self._surface.positions) + np.where((self._copies & far)[:, None], 0, lift)
        places = np.where(np.isfinite(images), images, places)
        made = (made | without | lift.any(axis=1)) & self._copies & ~self._added
        places, exact = rigid_pieces.exact(places, self._models, made, self._kept, self._ends, sign=-1)
        free = self._copies & ~(self._kept | self._added | exact)
        inside = (far | without) & free
        if inside.any():
            places = self._as_pieces(places, inside)
        for rings in range(1, _ROUNDS + 1):
            folded = np.zeros(len(places), bool)
            folded[self._faces.corners_of(self._faces.folded(places))] = True
            if not (folded & free).any():
                break
            places = self._unfolded(places, rigid_pieces.grown(folded & free, self._ends, rings) & free)
        return self._with_added(places)

    def _with_added(self, places):
        """Places of which each shell that was added is moved by one rigid motion, that of what is nearest to it."""
        if not self._added.any():
            return places
        others = self._fitted & ~self._added
        surface = Surface(self._mesh, self._models, others)
        for shell in parts(self._added, self._ends):
            places[shell] = rigid_pieces.beside(shell, places, self._models, surface, others, self._ends, sign=-1)
        return places

    def _unfolded(self, places, inside):
        """Places whose regions, `inside`, are drawn smooth or have the form of their models."""
        region = components(len(places), self._ends[inside[self._ends].all(axis=1)])
        smooth, mix = self._smooth(places, inside)
        piece = self._as_pieces(places, inside)
        folds, areas = zip(*(self._faces.judged(each, region, inside) for each in (places, smooth, piece)))
        better = (folds[1] <= _LEFT * folds[0]) | (folds[1] <= folds[2])
        takes = inside & (better & (areas[1] >= _KEPT))[region]
        chosen = takes[np.flatnonzero(inside)]
        self._mix.rows[takes], self._mix.weights[takes] = mix.rows[chosen], mix.weights[chosen]
        return np.where(takes[:, None], smooth, piece)

    def _smooth(self, places, inside):
        """Places of which those inside are on the surface between those around, and their Mix."""
        near = rigid_pieces.grown(inside, self._ends, 1)
        ends = self._ends[near[self._ends].all(axis=1)]
        between = filled(np.where(inside[:, None], np.nan, places), ends, self._models, _STILL)
        between = np.where(np.isnan(between), places, between)
        mix = self._surface.vertex_mix(between[inside])
        between[inside] = mix.of(self._surface.positions)
        return between, mix

    def _as_pieces(self, places, inside):
        """Places whose regions, `inside`, have the form of the models."""
        return rigid_pieces.moved(places, self._models, inside, self._fitted, self._ends, sign=-1, still=_STILL)


class _Faces:
    """The faces of a mesh and the edges between two of them."""

    def __init__(self, mesh, whole, models):
        self._offsets, self._corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
        self._sizes = np.diff(self._offsets)
        self._of = np.repeat(np.arange(len(self._sizes)), self._sizes)
        step = np.arange(len(self._corners)) - self._offsets[self._of]
        self._following = self._corners[self._offsets[self._of] + (step + 1) % self._sizes[self._of]]
        edge = mesh_data.read_attribute(mesh.attributes[".corner_edge"])
        order = np.argsort(edge, kind="stable")
        shared = np.flatnonzero(np.bincount(edge, minlength=len(mesh.edges)) == 2)
        first = np.searchsorted(edge[order], shared)
        pairs = self._of[np.stack([order[first], order[first + 1]], axis=1)]
        was = np.logical_and.reduceat(whole[self._corners], self._offsets[:-1])
        self._pairs = pairs[~was[pairs].all(axis=1)]
        wanted = self._normals(models)
        self._areas, self._smooth = np.linalg.norm(wanted, axis=1), _cosines(wanted, self._pairs) > _SMOOTH

    def _normals(self, places):
        """(faces, 3) as long as twice the area."""
        first = places[self._corners[self._offsets[self._of]]]
        turned = np.cross(places[self._corners] - first, places[self._following] - first)
        return np.add.reduceat(turned, self._offsets[:-1])

    def folded(self, places):
        """Numbers of the faces at places that are folded where the models are not."""
        return self._folded(self._normals(places))

    def _folded(self, normals):
        creased = self._pairs[self._smooth & (_cosines(normals, self._pairs) < _CREASED)]
        return np.union1d(creased.ravel(), np.flatnonzero(np.linalg.norm(normals, axis=1) < _TINY * self._areas))

    def judged(self, places, region, inside):
        """(vertices,) number of folded faces, and the area as a share of the models', of the regions of the vertices
        inside: at the number of each region."""
        normals, folded = self._normals(places), np.zeros(len(self._sizes))
        folded[self._folded(normals)] = 1
        sums = [self._sums(each, region, inside) for each in (folded, np.linalg.norm(normals, axis=1), self._areas)]
        return sums[0], sums[1] / np.maximum(sums[2], 1e-30)

    def _sums(self, values, region, inside):
        there = inside[self._corners]
        return np.bincount(region[self._corners[there]], values[self._of[there]], len(region))

    def corners_of(self, faces):
        chosen = np.zeros(len(self._sizes), bool)
        chosen[faces] = True
        return self._corners[chosen[self._of]]


def _cosines(normals, pairs):
    one, two = normals[pairs[:, 0]], normals[pairs[:, 1]]
    lengths = np.linalg.norm(one, axis=1) * np.linalg.norm(two, axis=1)
    return np.einsum("px,px->p", one, two) / np.maximum(lengths, 1e-30)
