# SPDX-License-Identifier: GPL-3.0-or-later
"""The halves of a mesh whose left and right have the same faces, apart from what an edit did.

Vertices that are each other's images are twins. What an edit has made is on the side of the old vertices that its faces
touch; of what touches both sides, and of the line, the places decide. A face that lies on both sides without being its own
mirror image is cut. Where the twins around an edit are mirrored about one plane, so are the images of the edit.
"""

import functools
from collections import Counter

import numpy as np
from intrinsym import Merge
from mathutils.kdtree import KDTree

from . import edit_moves, half_faces, local_frames, mesh_data, rigid_pieces, seams, stored_map, vertex_map
from .asymmetry import fitted_plane
from .half_labels import LINE, LOSES, STAYS, WINS, Halves, not_through, split_on_line
from .half_map import mirrored_points
from .neighbour_means import longest_edges
from .regions import components, mirrored, parts

#: Share of the vertices that no edit has touched whose faces are mirrored: where the whole half is replaced, and where what
#: was edited is.
_SHARED = 0.9, 0.5
#: A vertex is on the line if it is nearer than this share of its longest edge, or of the size of the mesh.
_ON, _AT = 1e-3, 1e-6
#: A twin is mirrored about the plane if it is off by less than this share of its longest edge; and the twins around an edit
#: are if this share of them is.
_OFF, _MOST = 0.05, 0.9
#: Rings of vertices around an edit that say whether the plane is its own.
_RINGS = 2
#: A part has one form on both sides if it is off by less than this share of its size.
_ALIKE = 0.05
#: What was moved on both sides stays where it is if it is off by less than this share of the way; and so a part is a rigid
#: copy.
_BOTH = 0.1


def twins(mesh, symmetry, labels, edited_only):
    """(vertices,) the twin of each vertex, -1 for none, itself on the line; or nothing where left and right do not share
    their faces. `edited_only`: of what differed before the edit, too."""
    partner = symmetry.partner.astype(np.int64)
    itself = partner == np.arange(len(partner))
    old, on_line = stored_map.read_edit(mesh) != stored_map.MADE, symmetry.side == 0
    point = seams.welded(mesh)
    across = ~(on_line | on_line[partner]) | split_on_line(symmetry, point)
    across &= labels * labels[partner] == WINS * LOSES
    fits = np.where(itself, on_line & old, across)
    exact = vertex_map.pairs(symmetry, point)
    exact &= ~_chance(mesh, exact, partner)
    twin = np.where(exact & exact[partner] & (labels != STAYS) & fits, partner, -1)
    offsets, corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
    touched = stored_map.is_touched(mesh, partner)
    alike, used = mirrored(offsets, corners, twin), np.bincount(corners, minlength=len(partner)) > 0
    counted = ~touched & (partner >= 0) & used & (labels != STAYS)
    alike |= mirrored_points(offsets, corners, twin, point)
    if not counted.any() or alike[counted].mean() < _SHARED[edited_only]:
        return None
    return np.where(alike | touched | itself | edited_only, twin, -1)


def _chance(mesh, exact, partner):
    """(vertices,) bool: pairs, of which one is as it was, and the most of its neighbours are neither `exact`, (vertices,) bool,
    nor made or lost: a map between other faces has some."""
    ends, edit = mesh_data.edges(mesh).astype(np.int64), stored_map.read_edit(mesh)
    ends = np.vstack([ends, ends[:, ::-1]])
    lone = ~exact & (edit != stored_map.MADE) & (edit != stored_map.LOST)
    count = len(lone)
    alone = 2 * np.bincount(ends[:, 0], lone[ends[:, 1]], count) > np.bincount(ends[:, 0], minlength=count)
    alone &= edit == 0
    return alone | alone[partner]


def halves(bm, mesh, symmetry, labels, twin, winner, edited_only):
    """The Halves of a mesh with the labels of its shells, and twins, of which the side `winner`, 1 or -1, stays; what differed
    before the edit stays on both sides, if `edited_only`. Raises MeshProblem."""
    touched = stored_map.is_touched(mesh, symmetry.partner.astype(np.int64)) | (not edited_only)
    return _Pairs(mesh, symmetry, labels, twin, winner).halves(bm, touched)


class _Pairs:
    """Arrays have one row a vertex."""

    def __init__(self, mesh, symmetry, labels, twin, winner):
        self._mesh, self._symmetry, self._twin, self._point = mesh, symmetry, twin, seams.welded(mesh)
        self._ends, self._places = mesh_data.edges(mesh).astype(np.int64), mesh_data.positions(mesh).astype(float)
        self._offsets, self._corners = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
        self._labels = np.where(twin == np.arange(len(twin)), LINE, labels)
        self._made = stored_map.read_edit(mesh) == stored_map.MADE
        self._free = (twin < 0) & (labels != STAYS) & self._made
        self._moved = edit_moves.after_carry(mesh)
        self._before = self._places - self._moved
        self._reach = longest_edges(self._ends, self._places)
        self._was_moved = self._moved.any(axis=1)
        replaced = stored_map.edits(mesh)[winner > 0] > 0  # what was edited on the losing side
        self._replaced = replaced & (twin >= 0) & (self._was_moved | self._made)[np.maximum(twin, 0)]
        still = (twin >= 0) & ~stored_map.is_changed(mesh, symmetry.partner) & ~self._was_moved
        self._still = still & ~self._was_moved[np.maximum(twin, 0)]
        self._images, self._at_rest, self._height, self._sideways = self._mirror()
        astray = (twin < 0) & ~self._made & self._at_rest & (self._labels * self._height < -self._least())
        self._labels = np.where(astray & (labels != STAYS), -self._labels, self._labels)

    def _mirror(self):
        """Images of vertices; whether they are those about the plane; and how far vertices are from the middle, on the
        winning side; and, at rest, how far they were moved so."""
        images = self._symmetry.surface_points.positions(self._places)
        pairs = np.flatnonzero(self._still)
        images, _ = rigid_pieces.exact(images, self._places, ~self._still, self._still, self._ends, sign=-1)
        side = np.where(self._symmetry.side == 0, 0, np.where(self._labels == LOSES, -1, 1))
        height = side * np.linalg.norm(np.nan_to_num(images) - self._places, axis=1) / 2
        at_rest, self._reflection = np.zeros(len(images), bool), np.eye(3)
        if len(pairs) < 3 or not (self._labels[pairs] == WINS).any():
            return images, at_rest, height, 0 * height
        plane = fitted_plane(self._places[pairs], self._places[self._twin[pairs]], np.ones(len(pairs)))
        mirror, self._reflection = plane.reflect(self._places), np.eye(3) - 2 * np.outer(plane.normal, plane.normal)
        off = np.linalg.norm(mirror - self._places[self._twin], axis=1)
        at_rest = self._agreed(self._still & (off <= _OFF * self._reach))
        way = self._places @ plane.normal - plane.offset
        way *= np.sign(way[pairs] @ self._labels[pairs])
        sideways = np.where(at_rest, self._moved @ plane.normal, 0)
        return np.where(at_rest[:, None], mirror, images), at_rest, np.where(at_rest, way, height), sideways

    def _agreed(self, agrees):
        """(vertices,) bool: those whose surroundings agree, (vertices,) bool, with the plane. What is apart from all that
        is still was at those that are nearest to where it was."""
        found, pieces = agrees.copy(), self._pieces()
        tree = None if all(len(around) for _, around in pieces) else _tree(self._places, self._still)
        for piece, around in pieces:
            if not len(around):
                around = [tree.find(place)[1] for place in self._before[piece].tolist()]
            found[piece] = agrees[around].mean() >= _MOST
        return found

    def _pieces(self):
        """Of each connected piece that is not still: its vertices, and the still ones around it."""
        inside = ~self._still & (self._labels != STAYS)
        near = rigid_pieces.grown(inside, self._ends, _RINGS) & (self._still | inside)
        return [(piece[inside[piece]], piece[self._still[piece]]) for piece in parts(near, self._ends)]

    def halves(self, bm, touched):
        self._refuse_off_line()
        self._label()
        bm.verts.ensure_lookup_table()
        twin = np.where(self._labels == LINE, np.arange(len(self._twin)), self._twin)
        lone, apart = half_faces.lone(self._offsets, self._corners, twin, self._point, touched)
        winning, losing, shares, edges = self._crossed(bm, lone)
        wins = np.isin(self._labels, (WINS, LINE))[:, None]
        images, below = (np.where(wins, each, np.nan) for each in self._images_of_changed())
        edited = stored_map.read_edit(self._mesh) > 0
        return Halves(
            self._labels, edges, winning, losing, shares, twin, apart, images, below, self._at_rest, self._reflection,
            self._partners(), edited, self._point,
        )

    def _refuse_off_line(self):
        """Raises MeshProblem where vertices of the line were moved off the plane."""
        if count := np.count_nonzero((self._labels == LINE) & (np.abs(self._sideways) > self._least())):
            raise mesh_data.MeshProblem(
                f"{count:,} vertices of the line between left and right were moved off it: move them back. Nothing is changed"
            )

    def _least(self):
        """(vertices,) how far from the middle a vertex is on the line."""
        return np.maximum(_ON * self._reach, _AT * np.ptp(self._places, axis=0).max())

    def _label(self):
        """Gives what an edit has made its labels."""
        on_plane = self._free & (np.abs(self._height) <= self._least())
        region = components(len(self._free), self._ends[(self._free & ~on_plane)[self._ends].all(axis=1)])
        fixed = np.where(self._free, STAYS, self._labels)
        wins, loses = (self._touched(fixed == label, region) for label in (WINS, LOSES))
        by_place = np.where(self._height < 0, LOSES, WINS)
        label = np.select([wins & ~loses, loses & ~wins, wins & loses], [WINS, LOSES, by_place], self._labels)
        labels = np.where(self._free & ~on_plane, label, fixed)
        wins, loses = (self._touched(labels == each, np.arange(len(labels))) for each in (WINS, LOSES))
        shell = components(len(labels), self._ends)
        whole = on_plane & ~np.isin(shell, shell[~on_plane])
        line = on_plane & self._joined(on_plane, (labels == LINE) | on_plane & wins & loses | whole)
        labels[on_plane] = np.where(loses & ~wins, LOSES, WINS)[on_plane]
        labels[line] = LINE
        labels[self._doubled(labels) & line] = WINS
        self._labels = labels

    def _doubled(self, labels):
        """(vertices,) bool: ends of edges on the line with two faces that would be copied: these would have four."""
        twin = np.where(labels == LINE, np.arange(len(labels)), self._twin)
        rows = np.flatnonzero(np.add.reduceat(labels[self._corners] == LINE, self._offsets[:-1], dtype=int) > 1)
        faces = [self._corners[self._offsets[row] : self._offsets[row + 1]].tolist() for row in rows]
        lone = [faces[number] for number in half_faces.without_images(faces, twin.tolist(), self._point.tolist())]
        copied = [face for face in lone if (labels[face] == WINS).any()]
        count = Counter(frozenset(ends) for face in copied for ends in zip(face, face[1:] + face[:1]))
        doubled = [list(ends) for ends, faces in count.items() if faces > 1 and (labels[list(ends)] == LINE).all()]
        return np.isin(np.arange(len(labels)), doubled)

    def _touched(self, flags, region):
        """(vertices,) bool: those of whose region a face has one of the flags, (vertices,) bool."""
        found = np.zeros(len(flags), bool)
        if len(self._corners):
            faces = np.logical_or.reduceat(flags[self._corners], self._offsets[:-1])
            found[region[self._corners[np.repeat(faces, np.diff(self._offsets))]]] = True
        return found[region]

    def _joined(self, chosen, seeds):
        """(vertices,) bool: the chosen ones that edges between them join to seeds, both (vertices,) bool."""
        group = components(len(chosen), self._ends[(chosen | seeds)[self._ends].all(axis=1)])
        return chosen & np.isin(group, group[seeds])

    def _crossed(self, bm, faces):
        """Winning ends, losing ends, shares and numbers of the edges at which faces are cut. Where an edge is not its own
        image, the cut parts its other faces from their images: these are cut, too."""
        found, faces = {}, list(faces)
        for corners in faces:
            for pair in zip(corners, corners[1:] + corners[:1]):
                edge = bm.edges.get([bm.verts[vertex] for vertex in pair])
                if sorted(self._labels[list(pair)]) == [LOSES, WINS] and edge.index not in found:
                    found[edge.index] = sorted(pair, key=lambda vertex: -self._labels[vertex])
                    if self._twin[pair[0]] != pair[1]:
                        faces += [[vertex.index for vertex in face.verts] for face in edge.link_faces]
        winning, losing = np.array(list(found.values()), np.int64).reshape(-1, 2).T
        ahead, behind = self._height[winning], -self._height[losing]
        if count := np.count_nonzero((ahead <= 0) | (behind <= 0)):
            raise mesh_data.MeshProblem(f"{count:,} edges lie on one side alone, but join both: {not_through(self._mesh)}")
        return winning, losing, ahead / np.maximum(ahead + behind, 1e-30), np.array(list(found), np.int64)

    def _at_originals(self):
        """(vertices,) bool: duplicates that were not moved, and are where their originals are."""
        partner = self._symmetry.partner.astype(np.int64)
        original = np.where(vertex_map.whole(self._symmetry), self._twin[partner], -1)
        away = np.linalg.norm(self._places - self._places[original], axis=1)
        return (original >= 0) & (away <= self._least()) & ~self._was_moved

    def _partners(self):
        """(vertices,) the partners, also of duplicates; of those of the line that were split off it, where they were."""
        partner = np.where(vertex_map.whole(self._symmetry), self._symmetry.partner.astype(np.int64), -1)
        tree, least = _tree(self._before, (self._labels == LINE) & ~self._made), self._least()
        for vertex in np.flatnonzero((partner == np.arange(len(partner))) & self._free).tolist():
            _, there, away = tree.find(self._before[vertex])
            partner[vertex] = there if there is not None and away <= least[vertex] else -1
        return partner

    def _images_of_changed(self):
        """(vertices, 3) images of what was made or moved, or has no twin, and of what became part of the line; of duplicates
        at their originals, the partners of these. And images of the surface below them. NaN where they are not known."""
        changed = self._made | self._was_moved | self._replaced | (self._twin < 0)
        images = np.where((self._at_rest & changed)[:, None], self._images, np.nan)
        on_line = self._labels == LINE
        images[on_line] = np.where(self._free[on_line, None], (images + self._places)[on_line] / 2, np.nan)
        still = self._free & (self._labels == WINS) & self._at_originals()
        images[still] = self._places[self._symmetry.partner[still].astype(np.int64)]
        return (images, images) if self._at_rest[changed & (self._labels == WINS)].all() else self._in_pose(images)

    def _in_pose(self, images):
        """Images with those in a pose, and of the surface below: of moved vertices, and of what was split off and moved, in
        their local frames. What is so on both sides already stays."""
        rows, below, stands = self._carried(images)
        own, twin = rows[~stands], self._twin[rows[~stands]]
        images[own] = below[own]
        were = self._symmetry.surface_points.positions(self._places)
        were[own] = self._before[twin]
        turns = functools.cache(lambda: local_frames.turns(self._symmetry, self._before))
        for piece, around in self._pieces():
            piece = piece[(self._labels[piece] == WINS) & ~self._at_rest[piece] & np.isfinite(were[piece]).all(axis=1)]
            if not len(around) and len(piece) > 2:
                turn = turns()[self._symmetry.partner[piece].astype(np.int64)]
                form = were[piece] + np.einsum("vxy,vy->vx", turn, self._moved[piece])
                images[piece] = self._whole(piece, self._between(piece, form))
        off = np.linalg.norm(images[own] - self._places[twin], axis=1)
        there = self._was_moved[twin] & (off <= _BOTH * np.linalg.norm(self._moved[own], axis=1))
        images[own[there]] = self._places[twin[there]]
        return images, np.where(np.isfinite(images), images, below)

    def _carried(self, images):
        """Winning vertices that have twins, and were moved or are enclosed by what was; (vertices, 3) where the surface below
        them has its image, `images` for others; and which ones stand off that surface. What has not moved stays."""
        lift, below, moved = stored_map.read_lift(self._mesh), images.copy(), self._was_moved | self._replaced
        lift = np.where((moved | ~self._was_moved.any())[:, None], lift, 0)
        chosen = moved | (stored_map.read_lift(self._mesh) != 0).any(axis=1)
        rows = np.flatnonzero(chosen & (self._twin >= 0) & (self._labels == WINS) & ~self._at_rest)
        if len(rows):
            shift = np.where((self._labels == WINS)[:, None], self._moved - lift, 0)
            there = self._before + self._symmetry.carry_displacement(self._before, shift, Merge.SWAP)
            below[rows] = there[self._twin[rows]]
        return rows, below, lift[rows].any(axis=1)

    def _between(self, piece, form):
        """The form of a part, of which what lies between duplicates takes its own from that of these."""
        places, fitted = self._places[piece], vertex_map.whole(self._symmetry)[piece]
        if fitted.all() or np.count_nonzero(fitted) < 3:
            return form
        number = np.full(len(self._places), -1)
        number[piece] = np.arange(len(piece))
        ends = number[self._ends]
        return rigid_pieces.moved(form, places, ~fitted, fitted, ends[(ends >= 0).all(axis=1)], sign=-1)

    def _whole(self, piece, form):
        """Images of a part that is apart from all that is still: the other side's, if it has that form already; else the
        `form`, as a rigid copy if it is nearly one."""
        places, twin = self._places[piece], self._twin[piece]
        off, least = np.inf, _ALIKE * np.ptp(places, axis=0).max()
        if (twin >= 0).all() and self._made[twin].all():
            rigid = rigid_pieces.brought(places, self._places[twin], places, -1)
            off = np.linalg.norm(rigid - self._places[twin], axis=1).max()
        if off <= least:
            return self._places[twin]
        rigid = rigid_pieces.brought(places, form, places, -1)
        least = min(least, _BOTH * np.linalg.norm(self._moved[piece], axis=1).mean())
        return rigid if np.linalg.norm(rigid - form, axis=1).max() <= least else form


def _tree(places, chosen):
    """The chosen ones, (vertices,) bool, at (vertices, 3) places."""
    tree = KDTree(len(places))
    for vertex in np.flatnonzero(chosen).tolist():
        tree.insert(places[vertex], vertex)
    tree.balance()
    return tree
