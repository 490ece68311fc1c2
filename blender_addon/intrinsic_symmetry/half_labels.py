# SPDX-License-Identifier: GPL-3.0-or-later
"""What a vertex is in a mesh whose half is rebuilt: labels, shell by shell, and what the two ways to find the line
between the halves (`half_pairs`, `half_line`) answer."""

from dataclasses import dataclass

import numpy as np

from . import mesh_data, seams, stored_map
from .regions import components

#: Labels of vertices: of the half that stays, of the half that is replaced, on the line between them, and of shells
#: that stay as they are.
WINS, LOSES, LINE, STAYS = 1, -1, 0, 2


@dataclass(frozen=True)
class Halves:
    """Labels of the vertices, and where the line crosses an edge: its winning end, its losing end, and the share of the
    way from one to the other. A losing vertex with a twin stays, and so do faces whose mirror images are there; the twin
    of a vertex on the line is itself. Winning vertices may have known images, and so may those on the line, which go there."""

    labels: np.ndarray  # (vertices,) int
    edges: np.ndarray  # (crossed edges,) numbers of the edges
    winning: np.ndarray
    losing: np.ndarray
    shares: np.ndarray
    twin: np.ndarray  # (vertices,) int, -1 for none
    apart: np.ndarray  # (vertices,) bool: each face without a mirror image has one of them
    images: np.ndarray  # (vertices, 3), NaN where they are not known
    below: np.ndarray  # (vertices, 3) images of the surface that they stand on, NaN where these are not known
    at_rest: np.ndarray  # (vertices,) bool: those that are mirrored about the plane
    reflection: np.ndarray  # (3, 3) about that plane
    partner: np.ndarray  # (vertices,) int, also of duplicates; -1 where the copies of faces keep nothing of what was there
    edited: np.ndarray  # (vertices,) bool: edges without faces at these are copied, too
    point: np.ndarray  # (vertices,) the least vertex with which each is one point

    def models(self, source):
        """Numbers of the old vertices, or of the cuts, that those with the sources that `half_copy` writes are the mirror
        images of, and of the others themselves."""
        cuts = len(self.shares)
        own = np.where(source < 0, -1 - source, source)
        labels, twin = np.append(self.labels, np.full(cuts, LINE)), np.append(self.twin, np.full(cuts, -1))
        return np.where((source >= 0) & (labels[own] == LOSES) & (twin[own] >= 0), twin[own], own)

    def on_line(self, source):
        """(n,) bool: those with the sources that `half_copy` writes that are on the line, as the cuts are."""
        return np.append(self.labels, np.full(len(self.shares), LINE))[np.where(source < 0, -1 - source, source)] == LINE

    def carried(self, places):
        """(vertices, 3) places of the surface that was there, moved as that below the twins."""
        images = np.where(self.twin[:, None] < 0, np.nan, self.below[self.twin])
        return np.where(np.isfinite(images), images, places)

    def were(self, source):
        """Numbers of the old vertices whose places the new ones have taken, as those of a part that was split off; -1 where
        that is not known."""
        partner = np.append(self.partner, np.full(len(self.shares), -1))
        return np.where(source < 0, partner[np.where(source < 0, -1 - source, source)], source)

    def images_of(self, models):
        """(n, 3) the images of `models`."""
        return np.vstack([self.images, np.full((len(self.shares), 3), np.nan)])[models]


def of_shells(mesh, symmetry, winner, edges):
    """(vertices,) what the map says, shell by shell."""
    partner, side = symmetry.partner.astype(np.int64), symmetry.side.astype(int) * winner
    point = seams.welded(mesh)
    shell = components(len(partner), np.vstack([edges, np.stack([np.arange(len(point)), point], axis=1)]))
    number, shell = np.unique(shell, return_inverse=True)
    found, count = partner >= 0, len(number)
    others = found & (partner != np.arange(len(partner)))  # on the line what was split off is its own image
    image = _most(shell[others], shell[partner[others]], count)
    balance = np.bincount(shell, side, count) / np.bincount(shell, minlength=count)
    whole = image == np.arange(count)
    paired = (image >= 0) & ~whole & (image[image] == np.arange(count))
    both = [np.bincount(shell[side * sign > 0], minlength=count) > 0 for sign in (1, -1)]
    crossed = whole & both[0] & both[1]
    apart = np.where(balance >= balance[image], WINS, LOSES)
    apart = np.where((balance == balance[image]) & (np.arange(count) > image), LOSES, apart)
    of_shell = np.where(paired, apart, STAYS)
    of_shell[(image < 0) & (balance == 1)] = WINS  # it was added, or its image was deleted
    deserted = np.bincount(shell, stored_map.read_edit(mesh) == stored_map.LOST, count) > 0
    of_shell[(image < 0) & (balance == -1) & deserted] = LOSES
    split = (image >= 0) & ~whole & ~paired  # off a shell that has a mirror image, or is its own
    of_shell[split & crossed[image]] = np.where(balance > 0, WINS, LOSES)[split & crossed[image]]
    of_shell[split & paired[image]] = -of_shell[image[split & paired[image]]]
    beside = np.where(split_on_line(symmetry, point), _beside(mesh, side), side)
    return np.where(crossed[shell], np.where(beside < 0, LOSES, WINS), of_shell[shell])


def split_on_line(symmetry, point):
    """(vertices,) bool: those on the line whose partner is another one of the same point, (vertices,): left and right are apart
    there."""
    partner, at_line = symmetry.partner.astype(np.int64), symmetry.side == 0
    return at_line & at_line[partner] & (partner >= 0) & (partner != np.arange(len(partner))) & (point[partner] == point)


def _beside(mesh, side):
    """(vertices,) on which side the most vertices of the faces of each are."""
    offsets, corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
    of_faces = np.repeat(np.add.reduceat(side[corners], offsets[:-1]), np.diff(offsets))
    return np.sign(np.bincount(corners, of_faces, len(side))).astype(int)


def not_through(mesh):
    """Why a half cannot be rebuilt, in words."""
    if not stored_map.read_edit(mesh).any():
        return "the line between left and right cannot go through the faces. Nothing is changed. Are some of them turned over?"
    return (
        "the line between left and right cannot go through the edit. Nothing is changed. Make the edit in smaller steps, or on "
        "both sides"
    )


def _most(rows, columns, count):
    """(count,) the most frequent column of each row, -1 where it has none."""
    pairs, votes = np.unique(rows * count + columns, return_counts=True)
    found = np.full(count, -1)
    order = np.argsort(votes, kind="stable")
    found[pairs[order] // count] = pairs[order] % count
    return found


def refuse_holes(mesh, symmetry, halves):
    """Raises MeshProblem where a shell has a mirror image, but vertices of it that are not mirrored have neither image nor
    side."""
    loose = np.bincount(np.asarray(mesh_data.polygons(mesh)[1]), minlength=len(halves.labels)) == 0
    known = (symmetry.partner >= 0) | (symmetry.side != 0) | loose | (stored_map.read_edit(mesh) == stored_map.MADE)
    if without := np.count_nonzero(~known & halves.apart & (halves.labels != STAYS)):
        raise mesh_data.MeshProblem(
            f"{without:,} of {len(mesh.vertices):,} vertices have no mirror image: "
            "Select Without Mirror Image shows where"
        )
