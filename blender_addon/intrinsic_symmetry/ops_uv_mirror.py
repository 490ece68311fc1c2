# SPDX-License-Identifier: GPL-3.0-or-later
"""Lay out one side's UVs as the mirror image of the other's: on top of them, or each island in its place."""

import bpy
import numpy as np
from intrinsym import Merge
from mathutils.bvhtree import BVHTree

from . import left_side, mesh_data
from .elements import barycentric, corner_partners, face_partners
from .mirroring import DIRECTIONS, MirrorProperties
from .operator_base import MapOperator
from .regions import SAME_UV, uv_islands

#: A mirror image is a vertex if its weight is more than this.
_WHOLE = 0.999
#: Faces of which it is seen whether they lie over others.
_ENOUGH = 10_000


class INTRINSIC_SYMMETRY_OT_mirror_uvs(MirrorProperties, MapOperator, bpy.types.Operator):
    """Give the UVs of one side the layout of the other. The winning side stays; the other side's islands are laid on
    top of it, or take its mirrored form at the place where they are"""

    bl_idname = "intrinsic_symmetry.mirror_uvs"
    bl_label = "Mirror UV Islands"

    direction: bpy.props.EnumProperty(
        name="Direction",
        description="Which side takes the layout of the other",
        items=[entry[:3] for entry in DIRECTIONS[:2]],
    )
    placement: bpy.props.EnumProperty(
        name="Placement",
        description="Where the islands of the losing side go",
        items=(
            ("BESIDE", "In Place", "Mirrored, each at its old centre; joined where it joins the other side"),
            ("OVERLAP", "Overlap", "On top of the winning side's: both sides share one texture"),
        ),
    )

    @classmethod
    def lacks(cls, context, object):
        missing = None if object.data.uv_layers else "The mesh has no UV map"
        return super().lacks(context, object) or missing

    def run_with(self, symmetry, _context, object, mode):
        symmetry = left_side.agreed(self, object, symmetry)
        mesh = object.data
        attribute = mesh.attributes[mesh.uv_layers.active.name]
        uvs = mesh_data.read_attribute(attribute).astype(float)
        layout = _Layout(mesh, symmetry, uvs)
        may_change, loser = self.may_change(object, mode, symmetry) > 0, -1 if self.merge == Merge.POSITIVE_WINS else 1
        corners, source = layout.sources((self.shares(symmetry) > 0) & may_change, may_change, loser)
        free = mesh_data.open_elements(mesh, mode, "CORNER")[corners]
        corners, source = corners[free], source[free]
        if not len(corners):
            raise mesh_data.MeshProblem("No UVs of the losing side have a mirror image")
        if self.placement == "BESIDE":
            source = layout.in_place(corners, source)
        free = ~_pinned(mesh, attribute.name)[corners]
        if not free.all():
            self.warn(f"{(~free).sum():,} pinned UVs stay")
        corners, uvs = corners[free], uvs.copy()
        uvs[corners] = source[free]
        if self.placement == "BESIDE":
            self._say_where_they_do_not_fit(layout, corners, uvs)
        mesh_data.update_attribute(mesh.attributes[attribute.name], uvs)
        mesh.update()
        changed = corners[np.abs(uvs - layout.uvs).max(axis=1)[corners] > SAME_UV]
        return f"{len(changed):,} UVs in {len(np.unique(layout.island[changed])):,} islands laid out anew"

    def _say_where_they_do_not_fit(self, layout, corners, uvs):
        """What has left its tile, or lies over another island now."""
        left = np.count_nonzero((layout.beyond(uvs) & ~layout.beyond(layout.uvs))[corners])
        covered = (layout.covered(corners, uvs) & ~layout.covered(corners, layout.uvs)).any()
        problems = [f"{left:,} UVs have left their tile"] * (left > 0) + ["Islands lie over others"] * bool(covered)
        if problems:
            self.warn(f"{'. '.join(problems)}: pack the islands")


def _pinned(mesh, name):
    """(corners,) bool: those that are pinned in a UV map."""
    pins = mesh.attributes.get(f".pn.{name}")
    return np.zeros(len(mesh.loops), bool) if pins is None else mesh_data.read_attribute(pins)


class _Layout:
    """The UV map of a mesh. Arrays have one row a face corner."""

    def __init__(self, mesh, symmetry, uvs):
        self.mesh, self.symmetry, self.uvs = mesh, symmetry, uvs
        self.offsets, self.vertex = (np.asarray(part).astype(np.int64) for part in mesh_data.polygons(mesh))
        self.face = np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets))
        self.island = uv_islands(self.offsets, self.vertex, uvs)
        self.island_of_face = self.island[self.offsets[:-1]]

    def sources(self, losing, may_change, loser):
        """Corners of the losing side, and the UV at the mirror image of each: at the corner there, or else inside the
        face that holds it. `losing` and `may_change`: (vertices,) bool; `loser` is the side of the former. On the line,
        corners of the losing side's faces lose, too."""
        faces = face_partners(self.mesh, self.symmetry)
        side = self.symmetry.side[self.vertex]
        wholly = self._any(losing[self.vertex]) & ~self._any(side == -loser)
        on_line = (side == 0) & ((self.symmetry.partner >= 0) & may_change)[self.vertex]
        corners = np.flatnonzero((losing[self.vertex] | (on_line & wholly)) & (faces[self.face] >= 0))
        exact = corner_partners(self.mesh, self.symmetry.partner, faces)[corners]
        source = self.uvs[np.maximum(exact, 0)]
        at_vertex = self.symmetry.surface_points.barycentrics.max(axis=1) > _WHOLE
        lone = (exact < 0) | ~at_vertex[self.vertex[corners]]
        source[lone] = self._inside(corners[lone], faces)
        return corners, source

    def _any(self, flags):
        """(corners,) bool: whether any corner of the same face has the flag."""
        return np.logical_or.reduceat(flags, self.offsets[:-1])[self.face]

    def _inside(self, corners, faces):
        """(corners, 2) UVs at the images of the vertices, in the faces that hold them if these are in the island of
        the partner of the corner's face, and else in that face, extended."""
        partner, holding = faces[self.face[corners]], self.symmetry.surface_points.faces[self.vertex[corners]]
        holding = np.where(holding == 2**32 - 1, partner, holding).astype(np.int64)
        same = self.island_of_face[holding] == self.island_of_face[partner]
        triangle = self.offsets[np.where(same, holding, partner)][:, None] + np.arange(3)
        positions = mesh_data.positions(self.mesh).astype(float)
        images = self.symmetry.surface_points.positions(positions)[self.vertex[corners]]
        weights = barycentric(images, positions[self.vertex[triangle]])
        return np.einsum("ck,cku->cu", weights, self.uvs[triangle])

    def in_place(self, corners, source):
        """The sources mirrored, each island about the line that it shares with the other side or at its old centre."""
        placed, islands = source.copy(), self.island[corners]
        order = np.argsort(islands, kind="stable")
        for mine in np.split(order, np.flatnonzero(np.diff(islands[order])) + 1):
            old, new = self.uvs[corners[mine]], source[mine]
            fixed = (self.symmetry.side[self.vertex[corners[mine]]] == 0) & (np.abs(old - new).max(axis=1) < SAME_UV)
            placed[mine] = _about_line(new, new[fixed]) if fixed.sum() > 1 else _about_centre(new, old)
            placed[mine[fixed]] = new[fixed]
        return placed


    def beyond(self, uvs):
        """(corners,) bool: UVs outside of the tile that the middle of their island is in."""
        count = np.bincount(self.island, minlength=len(uvs))
        sums = np.stack([np.bincount(self.island, column, len(uvs)) for column in self.uvs.T], axis=1)
        tile = np.floor(sums / np.maximum(count, 1)[:, None])[self.island]
        return (np.abs(uvs - tile - 0.5) > 0.5 + SAME_UV).any(axis=1)

    def covered(self, corners, uvs):
        """(faces,) bool: of the faces of some corners, or of enough of them, those whose middle lies in a face of another
        island, where all have some UVs. The islands are laid above each other, and seen from above and from below."""
        sizes, rank = np.diff(self.offsets), np.unique(self.island_of_face, return_inverse=True)[1]
        tree = BVHTree.FromPolygons(
            np.column_stack([uvs, rank[self.face]]).tolist(),
            [range(start, end) for start, end in zip(self.offsets[:-1].tolist(), self.offsets[1:].tolist())],
        )
        middle = np.add.reduceat(uvs, self.offsets[:-1]) / sizes[:, None]
        found, far = np.zeros(len(sizes), bool), rank.max(initial=0) + 1.0
        chosen = np.unique(self.face[corners])
        for face in chosen[:: 1 + len(chosen) // _ENOUGH].tolist():
            for start, way in ((far, -1), (-1, 1)):
                hit = tree.ray_cast((*middle[face].tolist(), start), (0, 0, way))[2]
                found[face] |= hit is not None and rank[hit] != rank[face]
        return found


def _about_line(points, line):
    """Points reflected about the straight line that fits best through some."""
    middle = line.mean(axis=0)
    normal = np.linalg.eigh((line - middle).T @ (line - middle))[1][:, 0]
    return points - 2 * np.outer((points - middle) @ normal, normal)


def _about_centre(points, old):
    """Points with U turned round, and the centre of the bounding box where the old points have it."""
    mirrored = points * (-1, 1)
    centre, wanted = (0.5 * (one.min(axis=0) + one.max(axis=0)) for one in (mirrored, old))
    return mirrored + wanted - centre


register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_mirror_uvs,))
