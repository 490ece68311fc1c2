# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the mirror image of each vertex should be: about a plane in a rest pose, in local frames in any other.

The plane is the one whose reflection brings the images nearest to their vertices. Its normal is an eigenvector of the
covariance between the two (B. K. P. Horn, "Closed-form solution of absolute orientation using unit quaternions",
1987, for a reflection). Distances are summed, not squared, by reweighting, so that a wide dent does not turn it.
"""

from dataclasses import dataclass

import numpy as np
from intrinsym import Merge, SymmetryKind

from . import mesh_data

ABOUT = (
    ("AUTO", "Automatic", "The fitted plane in a rest pose, the surface itself in any other"),
    ("PLANE", "Fitted Plane", "Rest pose: mirrored about the plane that fits best"),
    ("X", "Own X Axis", "Rest pose: mirrored about the plane X = 0 of the object, as X-mirror has it"),
    ("POSE", "Pose", "Any pose: each side keeps its pose and takes the other's shape in local frames"),
)
#: A body is posed if more than this share of its surface is farther from its place than this share of its size.
_POSED_SHARE, _POSED_DISTANCE = 0.05, 0.05
#: The pairs are not those of a plane if it brings the images elsewhere than the one that fits by this share of the size.
_BESIDE = 0.05
#: A vertex has a mirrored one if that is off by less than this share of the size, as numbers in files are.
_EXACT = 1e-5
_ROUNDS = 20


@dataclass(frozen=True)
class Plane:
    """Points x with normal . x = offset."""

    normal: np.ndarray
    offset: float

    def reflect(self, points):
        return points - 2 * np.outer(points @ self.normal - self.offset, self.normal)


@dataclass(frozen=True)
class Reference:
    """What a shape is mirrored about: a plane, or nothing in a pose."""

    plane: Plane | None
    name: str = "its mirror plane"

    def images(self, symmetry, positions):
        """(vertices, 3) where each vertex should be, by its mirror image; its own place where it has none."""
        if self.plane is None:
            return symmetry.symmetrize_positions(positions, Merge.SWAP)
        found = self.plane.reflect(symmetry.surface_points.positions(positions))
        found = np.where(self.exact(symmetry, positions)[:, None], self._partners(symmetry, positions), found)
        return np.where(np.isfinite(found), found, positions)

    def exact(self, symmetry, positions):
        """(vertices,) bool: those at the mirrored places of their partners. What the map says of the surface beside these
        is not as near; in a pose there are none."""
        if self.plane is None:
            return np.zeros(len(positions), bool)
        off = np.linalg.norm(self._partners(symmetry, positions) - positions, axis=1)
        return (symmetry.partner >= 0) & (off <= _EXACT * size(positions))

    def _partners(self, symmetry, positions):
        """(vertices, 3) the mirrored places of the partners."""
        return self.plane.reflect(positions[symmetry.partner.astype(np.int64)])

    def asymmetry(self, symmetry, positions):
        """(vertices,) how far each vertex is from there, in the size of the object."""
        return np.linalg.norm(self.images(symmetry, positions) - positions, axis=1) / size(positions)

    def in_words(self):
        return "in its pose" if self.plane is None else f"about {self.name}"


def size(positions):
    """The longest side of the bounding box."""
    return max(float(np.ptp(positions, axis=0).max(initial=0)), 1e-38)


def reference(about, symmetry, mesh, positions):
    """The Reference that one of ABOUT names. Raises MeshProblem."""
    mesh_data.refuse_far(positions)
    if about == "POSE" or about == "AUTO" and symmetry.kind == SymmetryKind.HALF_TURN:
        return Reference(None)
    if symmetry.kind == SymmetryKind.HALF_TURN:
        raise mesh_data.MeshProblem("A half turn has no mirror plane: choose Pose")
    if about == "X":
        return Reference(Plane(np.array((1.0, 0.0, 0.0)), 0.0), "its own plane X = 0")
    points, images, areas = _paired(symmetry, mesh, positions)
    plane = fitted_plane(points, images, areas)
    far = np.linalg.norm(points - plane.reflect(images), axis=1) > _POSED_DISTANCE * size(positions)
    posed = areas[far].sum() > _POSED_SHARE * areas.sum()
    return Reference(None if about == "AUTO" and posed else plane)


def refuse_beside_x(symmetry, mesh, positions):
    """Raises MeshProblem where the pairs are those of another plane than X = 0: about that, half of the shape would land
    elsewhere."""
    points, images, areas = _paired(symmetry, mesh, positions)
    plane, x = fitted_plane(points, images, areas), Plane(np.array((1.0, 0.0, 0.0)), 0.0)
    away = np.linalg.norm(x.reflect(images) - plane.reflect(images), axis=1)
    if np.average(away, weights=areas) <= _BESIDE * size(positions):
        return
    turn = np.degrees(np.arccos(min(abs(plane.normal[0]), 1)))
    middle = abs(np.average(points + images, axis=0, weights=areas)[0]) / 2 / size(positions)
    raise mesh_data.MeshProblem(
        f"The mirror plane of the pairs is not own X = 0: it is turned by {turn:.0f}\N{DEGREE SIGN}, and {middle:.0%} of the size "
        "away. Choose Automatic, Fitted Plane or another symmetry, or set the object's origin in that plane, with X across it"
    )


def _paired(symmetry, mesh, positions):
    """Positions, images and areas of the vertices that have all of them."""
    images, areas = symmetry.surface_points.positions(positions), vertex_areas(mesh)
    paired = np.isfinite(images).all(axis=1) & (areas > 0)
    if not paired.any():
        raise mesh_data.MeshProblem("No vertex has a mirror image")
    return positions[paired].astype(float), images[paired], areas[paired]


def fitted_plane(points, images, weights):
    """The Plane whose reflection brings (n, 3) images nearest to (n, 3) points."""
    least, now = 1e-6 * size(points), weights
    for _ in range(_ROUNDS):
        middle = np.average(0.5 * (points + images), axis=0, weights=now)
        covariance = ((points - middle) * now[:, None]).T @ (images - middle)
        normal = np.linalg.eigh(covariance + covariance.T)[1][:, 0]
        plane = Plane(normal, float(normal @ middle))
        now = weights / np.maximum(np.linalg.norm(points - plane.reflect(images), axis=1), least)
    return plane


def vertex_areas(mesh):
    """(vertices,) the surface's area, each triangle's spread over its corners."""
    corners = mesh_data.triangles(mesh)
    first, second, third = mesh_data.positions(mesh).astype(float)[corners.T]
    areas = np.linalg.norm(np.cross(second - first, third - first), axis=1) / 6
    return np.bincount(corners.ravel(), np.repeat(areas, 3), len(mesh.vertices))
