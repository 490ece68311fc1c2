# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror any attribute: colours, masks, creases, custom ones, on vertices, edges, faces and face corners."""

from typing import NamedTuple

import bpy
import numpy as np
from intrinsym import Merge

from . import assembly, local_frames, mesh_data, stored_map
from .counterparts import WINNER
from .elements import corner_partners, edge_partners, face_partners
from .mirroring import MirrorProperties, blend, shares
from .operator_base import MapOperator, stay

_NUMBERS = {"FLOAT", "FLOAT_VECTOR", "FLOAT2", "FLOAT_COLOR", "BYTE_COLOR"}
#: Custom normals: Blender keeps them as angles from the automatic ones.
_NORMALS = "custom_normal"
#: The sculpt mask: how far sculpting leaves a vertex alone.
_MASK = ".sculpt_mask"
#: Whole numbers that are names.
_NAMES = {".sculpt_face_set", "material_index"}
#: Attributes that other operators mirror, or that make no sense mirrored.
_REFUSED = {"position": "Symmetrize Positions does that"}


def _can_be_mirrored(attribute):
    own = stored_map.is_own(attribute.name) or attribute.name.startswith("._")
    topology = attribute.name in (".edge_verts", ".corner_vert", ".corner_edge", "position")
    return attribute.data_type in mesh_data.LAYOUTS and not own and not topology


class INTRINSIC_SYMMETRY_OT_mirror_attribute(MirrorProperties, MapOperator, bpy.types.Operator):
    """Mirror an attribute across the symmetry: a color, a mask, a crease, face sets, or your own. The losing side's
    values are replaced by those at their mirror images"""

    bl_idname = "intrinsic_symmetry.mirror_attribute"
    bl_label = "Mirror Attribute"

    name: bpy.props.StringProperty(name="Attribute", description="Name of the attribute; none for the active one")
    as_vector: bpy.props.BoolProperty(
        name="Directions in Space",
        description="The attribute holds vectors in space on vertices: turn them with the surface",
        default=False,
    )

    def run_with(self, symmetry, _context, object, mode):
        mesh = object.data
        free = self.may_change(object, mode, symmetry)
        how_far = _HowFar(shares(symmetry, self.merge), self.trust(symmetry) * free, self.merge)
        if mesh.has_custom_normals and self._name(mesh) == _NORMALS:
            return _mirror_normals(symmetry, mesh, how_far, _around_whole(mesh, mesh_data.open_elements(mesh, mode, "CORNER")))
        attribute = self._attribute(mesh)
        values = mesh_data.read_attribute(attribute)
        if self.as_vector:
            new = self._vectors(symmetry, object, attribute, values, self.shares(symmetry) * free)
        else:
            new = _MIRROR[attribute.domain](symmetry, mesh, attribute, values, how_far)
        fixed = ~mesh_data.open_elements(mesh, mode, attribute.domain)
        new[fixed] = values[fixed]
        mesh_data.update_attribute(mesh.attributes[attribute.name], new)
        mesh.update()
        changed = (new != values).reshape(len(values), -1).any(axis=1)
        changed &= assembly.shown(object, self.members, mesh.attributes[attribute.name].domain)
        name = "Mask" if attribute.name == _MASK else attribute.name
        said = [f"{name}: {changed.sum()} of {len(values)} values changed"]
        if not changed.any() and (how_far.taken * how_far.trust).any():
            said.append("Both sides are alike where they may change")
        if attribute.name == _MASK:
            said.append(f"{np.count_nonzero(new)} vertices are masked now, {np.count_nonzero(values)} before")
        return ". ".join(said)

    def may_change(self, object, mode, symmetry):
        """Of the mask itself, all that is not hidden."""
        if self._is_mask(object, mode):
            return mesh_data.open_elements(object.data, mode, "POINT").astype(float)
        return super().may_change(object, mode, symmetry)

    def staying(self, object, mode):
        if self._is_mask(object, mode):
            return stay(self.may_change(object, mode, None), "hidden")
        return super().staying(object, mode)

    def _is_mask(self, object, mode):
        return mode == "SCULPT" and self._name(object.data) == _MASK

    def _name(self, mesh):
        active = getattr(mesh.attributes.active, "name", "")
        return self.name or ("" if stored_map.is_own(active) else active)

    def _attribute(self, mesh):
        name = self._name(mesh)
        attribute = mesh.attributes.get(name)
        if name == _MASK and not (attribute and mesh_data.read_attribute(attribute).any()):
            raise mesh_data.MeshProblem("Nothing is masked: mask something first")
        if attribute is None:
            text = f'There is no attribute "{self.name}"' if self.name else "No attribute is active: choose one"
            raise mesh_data.MeshProblem(text)
        if not _can_be_mirrored(attribute):
            reason = _REFUSED.get(attribute.name, f"{attribute.data_type} on {attribute.domain} cannot be mirrored")
            raise mesh_data.MeshProblem(f'"{attribute.name}": {reason}')
        if self.merge == Merge.AVERAGE and (attribute.data_type == "BOOLEAN" or attribute.name in _NAMES):
            what = "on and off" if attribute.data_type == "BOOLEAN" else "face sets and materials"
            raise mesh_data.MeshProblem(f'"{attribute.name}": {what} have no mean. Choose another direction')
        return attribute

    def _vectors(self, symmetry, object, attribute, values, share):
        if (attribute.domain, attribute.data_type) != ("POINT", "FLOAT_VECTOR"):
            raise mesh_data.MeshProblem(f'"{attribute.name}" does not hold vectors on vertices')
        positions = mesh_data.positions(object.data)
        return blend(values, symmetry.carry_displacement(positions, values, Merge.SWAP), share)


def of_elements(symmetry, mesh, attribute, merge):
    """Old and new values of an attribute of edges or faces, all of which the mirroring may change."""
    values = mesh_data.read_attribute(attribute)
    return values, _MIRROR[attribute.domain](symmetry, mesh, attribute, values, _all(symmetry, merge))


def mirror_normals(symmetry, mesh, merge, faces):
    """Mirrors the custom normals of some faces, (faces,) bool; in words, how many changed."""
    chosen = np.repeat(faces, np.diff(mesh_data.polygons(mesh)[0]))
    return _mirror_normals(symmetry, mesh, _all(symmetry, merge), chosen)


def _all(symmetry, merge):
    """The _HowFar of all that has a mirror image."""
    return _HowFar(shares(symmetry, merge), shares(symmetry, Merge.SWAP), merge)


def _blend(attribute, own, image, share, merge):
    """Numbers are blended; whole numbers, flags and names are taken from the side that weighs more. The mean of whole
    numbers is rounded."""
    if attribute.data_type in _NUMBERS:
        return blend(own, image, share)
    if merge == Merge.AVERAGE:
        return np.rint(blend(own, image, share)).astype(own.dtype)
    return blend(own, image, (share >= 0.5).astype(float))


class _HowFar(NamedTuple):
    """How far elements take the values of their images, from their vertices."""

    taken: np.ndarray  # (vertices,) what the direction says
    trust: np.ndarray  # (vertices,) how far each may change
    merge: Merge

    def takes(self, members, starts, partners):
        """(elements,) what the direction says: an element loses as soon as one of its vertices does. But one that lies
        across the line stays if its image does so, too: neither is of the side that wins."""
        most, least = (reduce.reduceat(self.taken[members], starts) for reduce in (np.maximum, np.minimum))
        return np.where((self.merge in WINNER) & (least == 0) & (most[partners] > 0), 0, most)

    def shares(self, members, starts, partners):
        """(elements,) of edges or faces, whose vertices are `members` from `starts` on."""
        return self.takes(members, starts, partners) * np.minimum.reduceat(self.trust[members], starts)


def _points(symmetry, _mesh, attribute, values, how_far):
    if attribute.data_type in _NUMBERS:
        image = symmetry.mirror_values(values, Merge.SWAP)
    else:
        image = values[np.where(symmetry.partner < 0, np.arange(len(values)), symmetry.partner)]
    return _blend(attribute, values, image, how_far.taken * how_far.trust, how_far.merge)


def _elements(attribute, values, partners, share, merge):
    """Edges or faces: those without a partner keep their value."""
    share = np.where(partners < 0, 0, share)
    return _blend(attribute, values, values[np.where(partners < 0, 0, partners)], share, merge)


def _edges(symmetry, mesh, attribute, values, how_far):
    ends, partners = mesh_data.edges(mesh), edge_partners(mesh, symmetry.partner)
    share = how_far.shares(ends.ravel(), 2 * np.arange(len(ends)), partners)
    return _elements(attribute, values, partners, share, how_far.merge)


def _faces(symmetry, mesh, attribute, values, how_far):
    offsets, corners = mesh_data.polygons(mesh)
    partners = face_partners(mesh, symmetry)
    return _elements(attribute, values, partners, how_far.shares(corners, offsets[:-1], partners), how_far.merge)


def _corners(symmetry, mesh, attribute, values, how_far):
    is_number = attribute.data_type in _NUMBERS
    return _blend(attribute, values, *_corner_images(symmetry, mesh, values, how_far, is_number), how_far.merge)


def normals(mesh):
    """(corners, 3) float32."""
    values = np.empty((len(mesh.loops), 3), np.float32)
    mesh.corner_normals.foreach_get("vector", values.reshape(-1))
    return values


def _around_whole(mesh, may_change):
    """Those of the corners that may change, (corners,) bool, around whose vertices all may: Blender keeps one normal there
    for all corners of a smooth surface."""
    vertex = mesh_data.polygons(mesh).corners
    return np.bincount(vertex, ~may_change)[vertex] == 0


def _mirror_normals(symmetry, mesh, how_far, may_change):
    """Those of face corners that may change, (corners,) bool, turned with the surface."""
    own, vertex = normals(mesh), mesh_data.polygons(mesh).corners
    image, share = _corner_images(symmetry, mesh, own, how_far, True)
    turns = local_frames.turns(symmetry, mesh_data.positions(mesh))
    turn = np.linalg.inv(turns).transpose(0, 2, 1)[vertex]  # what is stretched keeps its normals
    new = blend(own, np.einsum("nij,nj->ni", turn, image), share * may_change)
    new /= np.maximum(np.linalg.norm(new, axis=1, keepdims=True), 1e-12)
    mesh.normals_split_custom_set(new.tolist())
    mesh.update()
    changed = (np.linalg.norm(new - own, axis=1) > 1e-4).sum()
    return f"Custom normals: {int(changed)} of {len(own)} changed"


def _corner_images(symmetry, mesh, values, how_far, are_numbers):
    """What each corner takes: the value of its face's partner at its vertex' partner; elsewhere the mean over the
    image. And how far; on the line its face says whether it loses."""
    offsets, corners = mesh_data.polygons(mesh)
    faces = face_partners(mesh, symmetry)
    source = corner_partners(mesh, symmetry.partner, faces)
    image = values[np.where(source < 0, np.arange(len(values)), source)]
    if are_numbers:
        means = symmetry.mirror_values(_vertex_means(values, corners, len(mesh.vertices)), Merge.SWAP)
        lone = source < 0
        image = image.astype(float)
        image[lone] = means[corners[lone]]
    of_faces = np.repeat(how_far.takes(corners, offsets[:-1], faces), np.diff(offsets))
    taken = np.where(symmetry.side[corners] == 0, of_faces, how_far.taken[corners])
    return image, taken * how_far.trust[corners]


def _vertex_means(values, corners, count):
    """(vertices, ...) mean over the corners of each vertex."""
    sums = np.zeros((count, *values.shape[1:]))
    np.add.at(sums, corners, values)
    uses = np.maximum(np.bincount(corners, minlength=count), 1)
    return sums / uses.reshape(-1, *[1] * (values.ndim - 1))


_MIRROR = {"POINT": _points, "EDGE": _edges, "FACE": _faces, "CORNER": _corners}

register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_mirror_attribute,))
