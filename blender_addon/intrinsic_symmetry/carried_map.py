# SPDX-License-Identifier: GPL-3.0-or-later
"""The map of an edited mesh, from what is left of the old one.

Old vertices keep their images, as long as the vertices around these are there. Else the image is where the surface is
nearest to its old place; if that is farther away than half an edge, what held it is gone, and so is the image.
What an edit has made or moved has its images where the one rigid motion of all that is around it brings it, if there is one
(`rigid_pieces`). Else duplicates, as an extrusion makes them, have the images of their originals, and other new vertices
have theirs where the surface was that they were made on (`image_surface`), or where a rigid piece that fits around them
has it. Where both sides got the same edit, new vertices are paired (`carried_walk`). Duplicated shells have their images
among themselves (`carried_shells`).
"""

import intrinsym
import numpy as np
from mathutils.kdtree import KDTree

from . import carried_shells, edit_moves, mesh_data, rigid_pieces, stored_map, vertex_map
from .carried_walk import pairs
from .image_surface import CLOSE, ON, ImageSurface
from .neighbour_means import between, filled, longest_edges, shortest_edges
from .regions import around, components, holding, mirrored, parts
from .surface import Mix, Surface

#: By how much the confidence of what is carried is lowered.
_LOWERED = 0.5
#: Distance below which a vertex is at an image, as a share of the size.
_SAME = 1e-5
#: A mean of sides below this is on the line.
_BETWEEN = 0.1
#: Orientation of images.
_SIGN = {intrinsym.SymmetryKind.REFLECTION: -1, intrinsym.SymmetryKind.HALF_TURN: 1}
#: New vertices are paired if one is nearer to the other's image than this share of its shortest edge.
_SHORT = 0.5
#: Edges are as long as others up to this ratio, and so many of them have to be.
_LONGER, _MOST = 1.5, 0.9
#: A vertex that others were merged into has at least this share of edges that its image does not have.
_APART = 0.5
#: Where more than this share of the vertices has not moved since the map was stored, the others were moved by the edit.
_STILL = 0.5
#: An image is gone if the surface is farther from its old place than this share of the vertex' longest edge.
_NEAR = 0.5


class CarriedMap:
    """Arrays have one row a vertex of the edited mesh; `new_of`, `original` and `ours` as `carry` finds them."""

    def __init__(self, mesh, core_mesh, new_of, original, ours):
        self._mesh, self._core_mesh, self._new_of = mesh, core_mesh, new_of
        self._offsets, self._used = (np.asarray(part).astype(np.int64) for part in core_mesh.polygons)
        self._places, self._ends = mesh_data.positions(mesh).astype(float), mesh_data.edges(mesh).astype(np.int64)
        self._reach = longest_edges(self._ends, self._places)
        self._read(original)
        if (merged := self._merged() | self._off_line(original)).any():
            self._new_of = np.where(np.isin(np.arange(len(new_of)), original[merged]), -1, new_of)
            original = np.where(merged, -1, original)
            self._read(original)
        self._shell = components(len(self.new), self._ends)
        self._added = ~np.isin(self._shell, self._shell[~self.new])
        self._placed = self._added & ~np.isin(self._shell, self._shell[self._known])  # have the side where they are
        self._apart = self._pair_shells(original)
        self._lift, self._cuts = np.zeros_like(self._places), self.new
        if self.new.any():
            self._lay()
        off = np.linalg.norm(self._lift, axis=1) > ON * self._reach
        self._inside = self._enclosed(self.new & self._cuts)
        self._off = off & (self.new | self._inside)
        self._edited = self._with_other_faces(original)
        self._made = self.new | self._off | self._edited & ~self._still
        self._relocate(self._known, ours)

    def _read(self, original):
        """What the old vertices and their duplicates have."""
        self._known = known = original >= 0
        self.new = ~known
        self.new[known] = self._new_of[original[known]] != np.flatnonzero(known)
        values = {name: mesh_data.read_attribute(self._mesh.attributes[name]) for name in stored_map.KINDS}
        has_face = np.bincount(self._used, minlength=len(known)) > 0
        partner = self._renumbered(values[stored_map.PARTNER])
        self.partner = np.where(known & (partner >= 0) & has_face[partner], partner, -1)
        self._corners = self._renumbered(np.stack([values[name] for name in stored_map.CORNERS], axis=1))
        self._weights = _shares(values[stored_map.BARY].astype(float))
        there = known & (self._corners >= 0).all(axis=1)
        self._exact = ~self.new & (self.partner >= 0) & (self._weights.max(axis=1) > vertex_map.WHOLE)
        self._faces = np.where(there & ~self.new, holding(self._offsets, self._used, self._corners, there), -1)
        images = np.einsum("vk,vkx->vx", self._weights, self._places[self._corners])
        self._target = np.where(there[:, None], images, np.nan)
        self._target[self._exact] = self._places[self.partner[self._exact]]
        self._kept = self._exact | (self._faces >= 0)
        self._confidence = np.where(known, values[stored_map.CONFIDENCE], np.nan)
        self._side = np.where(known, values[stored_map.SIDE], np.nan)
        self._duplicates = known & self.new
        self._had = values[stored_map.PARTNER] >= 0
        self._found, self._gone = known.copy(), np.zeros(len(known), bool)
        self._were, self._images = (
            mesh_data.read_attribute(self._mesh.attributes[name]).astype(float)
            for name in (stored_map.PLACE, stored_map.IMAGE)
        )
        still = known & (np.linalg.norm(self._were - self._places, axis=1) <= ON * self._reach)
        self._still = still if still.mean() > _STILL else known

    def _merged(self):
        """(vertices,) bool: old ones that others were merged into: half of their edges or more lead to vertices whose images
        are in no face with theirs, and beside these are images of vertices that are gone."""
        count, ends = len(self.new), np.vstack([self._ends, self._ends[:, ::-1]])
        lost = self._had & self._known & (self.partner < 0)
        beside = np.bincount(ends[:, 0], lost[ends[:, 1]], count) > 0
        own, other = ends[self._exact[ends].all(axis=1) & beside[self.partner[ends[:, 0]]]].T
        images, others = self.partner[own], self.partner[other]
        near, together = np.isin(self._used, images), set()
        face = np.repeat(np.arange(len(self._offsets) - 1), np.diff(self._offsets))
        for number in np.unique(face[near]).tolist():
            corners = self._used[self._offsets[number] : self._offsets[number + 1]].tolist()
            together.update((one, another) for one in corners for another in corners)
        apart = [pair not in together for pair in zip(images.tolist(), others.tolist())]
        edges = np.bincount(own, minlength=count)
        return (edges > 0) & (np.bincount(own, apart, count) >= _APART * edges)

    def _off_line(self, original):
        """(vertices,) bool: those on the line that the edit has moved, and given other faces, and that are no extrusion."""
        alone = self._known & (np.bincount(original[self._known], minlength=len(self._new_of))[original] == 1)
        itself = self._exact & (self.partner == np.arange(len(original)))
        return itself & alone & ~self._still & self._with_other_faces(original)

    def _pair_shells(self, original):
        """Pairs the vertices of duplicated shells; (vertices,) bool: those of shells that are paired, or lie on both sides
        without a pair. Their images are not where those of their originals are."""
        copies = self._added & self._duplicates & (self.partner >= 0)
        shells = [shell for shell in parts(self._added, self._ends) if copies[shell].any()]
        if not shells:
            return np.zeros(len(self.new), bool)
        base = np.where(copies, self._new_of[original], -1)
        height = np.einsum("vx,vx->v", self._places - self._places[base], mesh_data.normals(self._mesh)[base])
        twins = carried_shells.pairs(shells, base, self.partner, height)
        apart = np.zeros(len(self.new), bool)
        for shell in shells:
            sides, paired = self._side[shell[copies[shell]]], np.isin(shell, list(twins)).any()
            across = (sides > 0).any() and (sides < 0).any()
            apart[shell], self._placed[shell] = paired or across, across and not paired
        lying = copies & (np.linalg.norm(self._places - self._places[base], axis=1) <= ON * self._reach)
        apart &= ~lying | np.isin(np.arange(len(apart)), list(twins))  # as where edges are split
        self.partner[apart], self._corners[apart], self._faces[apart], self._target[apart] = -1, -1, -1, np.nan
        self._exact, self._kept, self._found = self._exact & ~apart, self._kept & ~apart, self._found & ~apart
        if twins:
            self._pair(twins)
        return apart

    def _lay(self):
        """Gives new vertices their images on the surface that they were made on, and notes how far they, and what they
        enclose, stand off it."""
        of_known = np.isin(self._shell, self._shell[self._known])
        rows = np.flatnonzero(self.new & ~self._known & ~self._apart & of_known)
        surface, feet = self._surface_that_was(rows)
        numbered = ((self._corners >= 0) | (self._weights == 0)).all(axis=1) & self._known & self._had
        own = np.einsum("vk,vkx->vx", self._weights, surface.images[self._corners])
        self._lift[numbered] = (self._places - own)[numbered]
        if feet is None:
            return
        self._lift[rows[feet.below]] = (self._places[rows] - feet.mix.of(surface.images))[feet.below]
        self._were[rows[feet.below]] = feet.mix.of(surface.before)[feet.below]
        there = feet.sure & (feet.away <= self._reach[feet.mix.rows].max(axis=1))
        there &= ~between(self._ends, self._places, self._exact)[rows]
        rows, mix = rows[there], feet.mix.at(there)
        self._faces[rows], self._corners[rows], self._weights[rows] = feet.faces[there], mix.rows, mix.weights
        self._target[rows], self._found[rows] = mix.of(self._places), True
        on_line = np.linalg.norm(self._target - self._places, axis=1)[rows] <= ON * self._reach[rows]
        self._side[rows] = np.where(on_line, 0, -np.sign(mix.of(self._side)))

    def _surface_that_was(self, rows):
        """The ImageSurface and the feet of new vertices, `rows`, on it. What the edit encloses was moved with it, as the
        inside of an extrusion; or it was there before, as a hand beyond a loop cut, if far more new vertices lie on it so."""
        there, best, most = ~self.new & self._had, None, -1
        for cuts in (self.new, self._duplicates) if len(rows) else (self.new,):
            enclosed = self._enclosed(cuts)
            held = np.where(self._exact, enclosed[self.partner], enclosed[self._corners].any(axis=1))
            moved = np.where((self._kept & ~held)[:, None], self._target - self._images, np.nan)
            surface = ImageSurface(self._mesh, self._images, moved, there)
            feet = surface.feet(self._places[rows], self._reach[rows]) if len(rows) else None
            count = 0 if feet is None else np.count_nonzero(feet.away <= CLOSE * self._reach[rows])
            if count > 2 * most:
                best, most, self._cuts = (surface, feet), count, cuts
        return best

    def _relocate(self, known, ours):
        """Puts images whose faces are gone onto the surface, all as it was when the map was stored; not those of a
        shell all of whose images were deleted."""
        places, images = self._were, self._images
        self._gone = known & ~self._had
        rows = np.flatnonzero(known & self._had & ~self._exact & (self._faces < 0))
        self._gone[rows] = True
        surface = Surface(self._mesh, places, ours) if len(rows) else None
        if surface is None or not len(surface.faces):
            return
        triangle, weights = surface.feet(images[rows])
        mix = Mix(surface.vertices[triangle], weights)
        away, reach = np.linalg.norm(mix.of(places) - images[rows], axis=1), longest_edges(self._ends, places)[rows]
        alone = ~np.isin(self._shell, self._shell[known & (self._corners >= 0).any(axis=1)])
        self._gone[rows] = (away > _NEAR * reach) | alone[rows]
        there = ~(self._gone | self.new)[rows]
        rows, triangle, mix = rows[there], triangle[there], mix.at(there)
        self._faces[rows], self._corners[rows], self._weights[rows] = surface.faces[triangle], mix.rows, mix.weights
        self._target[rows] = mix.of(self._places)

    def _with_other_faces(self, original):
        """(vertices,) bool: new ones, and those with other faces than when the map was stored."""
        number = np.where(self.new, -1, original)
        were = mesh_data.read_attribute(self._mesh.attributes[stored_map.AROUND])
        return self.new | (around(self._offsets, self._used, number) != were)

    def _renumbered(self, old):
        """New numbers of old ones; -1 for none."""
        fits = (old >= 0) & (old < len(self._new_of))
        return np.where(fits, self._new_of[np.where(fits, old, 0)], -1)

    def found(self, kind):
        """The `intrinsym.Symmetry`."""
        self._mirror(kind)
        self._fill(kind)
        self._walk()
        self._meet()
        self._match_added(_SIGN[kind])
        self._land()
        self._confidence *= np.where(self._kept | self._exact, 1, _LOWERED)
        exact, has = vertex_map.at_vertices(self._core_mesh, self.partner), self.partner >= 0
        points = intrinsym.SurfacePoints(
            np.where(self._exact, exact.faces, vertex_map.unsigned(self._faces)),
            np.where(self._exact[:, None], exact.corners, vertex_map.unsigned(self._corners)),
            np.where(self._exact[:, None], exact.barycentrics, self._weights),
        )
        confidence = np.where(has, np.nan_to_num(self._confidence), 0)
        side = np.nan_to_num(self._side)
        at_line = self._exact & (self.partner != np.arange(len(side))) & (side == 0)  # with an image of their own, on one side
        side = np.sign(np.nan_to_num(filled(np.where(at_line, np.nan, side)[:, None], self._ends, self._places)[:, 0]))
        return self._core_mesh.restore(kind, self.partner, np.clip(confidence, 0, 1), side.astype(np.int8), points)

    @property
    def lost(self):
        """How many old vertices have no image any more. After `found`."""
        return np.count_nonzero(self._had & ~self.new & (self.partner < 0))

    @property
    def edits(self):
        """How many vertices on the left and on the right were edited, or were images and are gone, apart from what was
        done on both sides alike. After `found`."""
        alike = mirrored(self._offsets, self._used, np.where(self._exact, self.partner, -1))
        edited, lost = self._edited & ~alike, ~self.new & ~self._kept & self._had
        return [np.count_nonzero(edited & (self._side == at) | lost & (self._side == -at)) for at in (1, -1)]

    def lifted(self):
        """(vertices, 3) how far new vertices without a partner of their own, and what they enclose, stand off the surface
        that was there; and what stood off it before. After `found`."""
        lift, before = np.where(self._off[:, None], self._lift, 0), self._mesh.attributes.get(stored_map.LIFT)
        if before is not None:
            values = np.where(self.new[:, None], np.nan, mesh_data.read_attribute(before))
            lift += np.nan_to_num(filled(values, self._ends, self._places))
        return lift

    def edit(self):
        """(vertices,) what this edit, or one before, did: `stored_map.MADE`, or moved, `LOST` or `REFACED`; what it encloses may
        have moved in shape keys alone. After `found`."""
        before = np.where(self.new, 0, stored_map.read_edit(self._mesh))
        lost = self._had & ~self.new & (self.partner < 0)
        faces = (self._edited | self._inside) & (before == 0)
        return np.select([lost, self._made, faces], [stored_map.LOST, stored_map.MADE, stored_map.REFACED], before)

    def moved(self):
        """(vertices, 3) how far old vertices were moved, and duplicates from their originals."""
        return edit_moves.before_carry(self._mesh, self._known, self._known & ~self.new)

    def _mirror(self, kind):
        """Gives what was made or moved its images and its sides where all that is around it has one rigid motion."""
        fitted = self._exact & ~self._made & self._still & self._still[self.partner]
        target, found = rigid_pieces.exact(
            self._target, self._places, self._made, fitted, self._ends, sign=_SIGN[kind]
        )
        self._target, self._found, self._mirrored = target, self._found | found, found
        self._side[found & self._made & ~self._duplicates] = np.nan

    def _fill(self, kind):
        """Gives the vertices without images those of a piece of the surface that fits around, and the other values the
        means of their neighbours'."""
        lacks = np.isnan(self._target).any(axis=1)
        self._target = rigid_pieces.moved(
            self._target, self._places, lacks, ~lacks, self._ends, sign=_SIGN[kind], along_lines=True
        )
        across = self._places - self._target
        gone = np.where(self._found, self._gone, np.nan)
        values = np.column_stack([self._confidence, gone, self._side[:, None] * across])
        values = filled(values, self._ends, self._places, along_lines=True)
        self._confidence, self._gone = values[:, 0], values[:, 1] > 0.5
        way = np.einsum("vx,vx->v", values[:, 2:], across)
        least = np.where(self._mirrored, ON, _BETWEEN) * self._reach * np.linalg.norm(values[:, 2:], axis=1)
        side = np.where(np.abs(way) <= least, 0, np.sign(way))
        self._side = np.where(np.isnan(self._side), side, self._side)
        self._target[self._gone] = np.nan
        self._take_sides()

    def _take_sides(self):
        """Gives shells that are new all over, and no duplicates, or duplicates of both sides without a pair, the side of the
        surface nearest to them."""
        surface = Surface(self._mesh, self._places, ~self._added, np.all) if self._added.any() else None
        if surface is not None and len(surface.faces):
            rows = np.flatnonzero(self._placed)
            self._side[rows] = np.sign(surface.vertex_mix(self._places[rows]).of(self._side)) if len(rows) else 0

    def _match_added(self, sign):
        """Pairs shells that were added on both sides, as far as one is nearly where the other has its mirror image."""
        added = [shell for shell in parts(self._added, self._ends) if not self._exact[shell].any()]
        mine, others = ([each for each in added if (self._side[each] == at).all()] for at in (1, -1))
        if not mine or not others:
            return
        surface = Surface(self._mesh, self._places, ~self._added, np.all)
        fitted = ~self._added & ~np.isnan(self._target).any(axis=1)
        tree, near = KDTree(len(self.new)), _SHORT * shortest_edges(self._ends, self._places)
        for vertex in np.concatenate(others).tolist():
            tree.insert(self._places[vertex], vertex)
        tree.balance()
        for shell in mine:
            there = rigid_pieces.beside(shell, self._target, self._places, surface, fitted, self._ends, sign=sign)
            if np.isnan(there).any():
                continue
            twins, away = zip(*(tree.find(place)[1:] for place in there.tolist()))
            is_other = any(np.array_equal(np.sort(twins), other) for other in others)
            if is_other and not self._exact[list(twins)].any() and (np.array(away) <= near[shell]).all():
                self._pair({**dict(zip(shell.tolist(), twins)), **dict(zip(twins, shell.tolist()))})
                self._confidence[[*shell, *twins]] = 1

    def _walk(self):
        """Pairs new vertices where both sides got the same edit: as a patch, on extrusions, or where an image is expected."""
        near = _SHORT * shortest_edges(self._ends, self._places)

        def may_be(one, other):
            return one != other or self._side[one] == 0

        def may_pair(one, other):
            off = self._places[other] - self._target[one]
            return may_be(one, other) and (self._duplicates[[one, other]].all() or off @ off <= near[other] ** 2)

        self._pair(self._alike(self._paired(may_be)))
        self._pair(self._paired(may_pair))

    def _paired(self, may_pair):
        partner = np.where(self._exact, self.partner, -1)
        return pairs(self._offsets, self._used, partner, self.new & ~self._exact, may_pair)

    def _alike(self, twins):
        """Those of patches of new vertices that all have twins, and nearly all of whose edges are about as long there: in a
        pose no image need be near."""
        new, count, partner = self.new & ~self._exact, len(self.new), np.where(self._exact, self.partner, -1)
        partner[list(twins)] = list(twins.values())
        patch = components(count, self._ends[new[self._ends].all(axis=1)])
        ends = self._ends[new[self._ends].any(axis=1) & (partner[self._ends] >= 0).all(axis=1)]
        own, there = (np.linalg.norm(np.diff(self._places[at], axis=1)[:, 0], axis=1) for at in (ends, partner[ends]))
        is_kept = (own <= _LONGER * there) & (there <= _LONGER * own)
        at = patch[np.where(new[ends[:, 0]], ends[:, 0], ends[:, 1])]
        lacks = np.bincount(patch, new & (partner < 0), count) > 0
        fits = (~lacks & (np.bincount(at, is_kept, count) >= _MOST * np.bincount(at, minlength=count)))[patch]
        return {one: other for one, other in twins.items() if fits[one] and fits[other]}

    def _pair(self, twins):
        vertices, partners = (np.fromiter(part, np.int64, len(twins)) for part in (twins.keys(), twins.values()))
        self.partner[vertices], self._exact[vertices] = partners, True
        self._target[vertices], self._gone[vertices] = self._places[partners], False

    def _enclosed(self, new):
        """(vertices,) bool: what new vertices cut off from the most of its shell, as the inside of what was extruded."""
        region = components(len(new), self._ends[~new[self._ends].any(axis=1)])
        size = np.bincount(region, minlength=len(new))
        size[new] = 0
        largest = np.zeros(len(new), int)
        np.maximum.at(largest, self._shell, size[region])
        return ~new & (size[region] < largest[self._shell])

    def _land(self):
        """Puts images that are in no face onto the nearest one. Vertices that no face uses have none."""
        found = ~np.isnan(self._target).any(axis=1) & (np.bincount(self._used, minlength=len(self.new)) > 0)
        mine = self._duplicates & (self._corners >= 0).all(axis=1)
        self._faces[mine] = holding(self._offsets, self._used, self._corners, mine)[mine]
        loose = np.flatnonzero(found & ~self._exact & (self._faces < 0))
        if len(loose):
            surface = Surface(self._mesh, self._places, np.ones(len(found), bool))
            triangle, self._weights[loose] = surface.feet(self._target[loose])
            self._faces[loose], self._corners[loose] = surface.faces[triangle], surface.vertices[triangle]
        nearest = self._corners[np.arange(len(found)), self._weights.argmax(axis=1)]
        self._exact &= found
        keeps = self._exact | found & (self.partner >= 0) & ~self.new
        self.partner = np.where(keeps, self.partner, np.where(found, nearest, -1))
        self._faces[~found], self._corners[~found] = -1, -1
        self._weights[~found] = 0

    def _meet(self):
        """Pairs new vertices that are at each other's images, and those around them."""
        rows = np.flatnonzero(self.new & ~self._exact & ~np.isnan(self._target).any(axis=1))
        tree, near = KDTree(len(rows)), _SAME * np.ptp(self._places, axis=0).max(initial=0)
        for row in rows.tolist():
            tree.insert(self._places[row], row)
        tree.balance()
        found = {row: tree.find(self._target[row]) for row in rows.tolist()}
        there = {row: number for row, (_, number, distance) in found.items() if distance <= near}
        met = {row: number for row, number in there.items() if there.get(number) == row}
        if met:
            self._pair(met)
            self._walk()


def _shares(weights):
    """(vertices, 3) weights that are at least 0, and sum to 1 where there are any: Blender mixes some vertices with themselves,
    and rounds."""
    weights = np.maximum(weights, 0)
    return weights / np.maximum(weights.sum(axis=1, keepdims=True), 1e-30)
