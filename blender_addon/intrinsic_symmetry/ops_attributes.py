# SPDX-License-Identifier: GPL-3.0-or-later
"""Mirror any attribute: colours, masks, creases, custom ones, on vertices, edges, faces and face corners."""

import bpy
import numpy as np
from intrinsym import Merge

from . import mesh_data, stored_map
from .elements import corner_partners, edge_partners, face_partners
from .mirroring import MirrorProperties, blend
from .operator_base import MapOperator

_NUMBERS = {"FLOAT", "FLOAT_VECTOR", "FLOAT2", "FLOAT_COLOR", "BYTE_COLOR"}
#: Attributes that other operators mirror, or that make no sense mirrored.
_REFUSED = {"position": "Symmetrize Positions does that"}


def _can_be_mirrored(attribute):
    own = attribute.name in stored_map.KINDS or attribute.name.startswith(".") and attribute.name[1:2] == "_"
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
        attribute = self._attribute(mesh)
        values = mesh_data.read_attribute(attribute)
        share = self.shares(symmetry) * self.may_change(object, mode, symmetry)
        if self.as_vector:
            new = self._vectors(symmetry, object, attribute, values, share)
        else:
            new = _MIRROR[attribute.domain](symmetry, mesh, attribute, values, share)
        mesh_data.update_attribute(mesh.attributes[attribute.name], new)
        mesh.update()
        changed = (new != values).reshape(len(values), -1).any(axis=1).sum()
        return f"{attribute.name}: {int(changed)} of {len(values)} values changed"

    def _attribute(self, mesh):
        attribute = mesh.attributes.get(self.name) if self.name else mesh.attributes.active
        if attribute is None:
            text = f'There is no attribute "{self.name}"' if self.name else "No attribute is active"
            raise mesh_data.MeshProblem(text)
        if not _can_be_mirrored(attribute):
            reason = _REFUSED.get(attribute.name, f"{attribute.data_type} on {attribute.domain} cannot be mirrored")
            raise mesh_data.MeshProblem(f'"{attribute.name}": {reason}')
        return attribute

    def _vectors(self, symmetry, object, attribute, values, share):
        if (attribute.domain, attribute.data_type) != ("POINT", "FLOAT_VECTOR"):
            raise mesh_data.MeshProblem(f'"{attribute.name}" does not hold vectors on vertices')
        positions = mesh_data.positions(object.data)
        return blend(values, symmetry.carry_displacement(positions, values, Merge.SWAP), share)


def _blend(attribute, own, image, share):
    """Numbers are blended; whole numbers, flags and names are taken from the side that weighs more."""
    if attribute.data_type in _NUMBERS:
        return blend(own, image, share)
    return blend(own, image, (share >= 0.5).astype(float))


def _points(symmetry, _mesh, attribute, values, share):
    if attribute.data_type in _NUMBERS:
        image = symmetry.mirror_values(values, Merge.SWAP)
    else:
        image = values[np.where(symmetry.partner < 0, np.arange(len(values)), symmetry.partner)]
    return _blend(attribute, values, image, share)


def _elements(attribute, values, partners, share):
    """Edges or faces: those without a partner keep their value."""
    share = np.where(partners < 0, 0, share)
    return _blend(attribute, values, values[np.where(partners < 0, 0, partners)], share)


def _edges(symmetry, mesh, attribute, values, share):
    share = share[mesh_data.edges(mesh)].min(axis=1)
    return _elements(attribute, values, edge_partners(mesh, symmetry.partner), share)


def _faces(symmetry, mesh, attribute, values, share):
    offsets, corners = mesh_data.polygons(mesh)
    share = np.minimum.reduceat(share[corners], offsets[:-1])
    return _elements(attribute, values, face_partners(mesh, symmetry), share)


def _corners(symmetry, mesh, attribute, values, share):
    """A corner takes that of its face's partner at its vertex' partner; elsewhere the mean over the image."""
    _, corners = mesh_data.polygons(mesh)
    source = corner_partners(mesh, symmetry.partner, face_partners(mesh, symmetry))
    image = values[np.where(source < 0, np.arange(len(values)), source)]
    if attribute.data_type in _NUMBERS:
        means = symmetry.mirror_values(_vertex_means(values, corners, len(mesh.vertices)), Merge.SWAP)
        lone = source < 0
        image = image.astype(float)
        image[lone] = means[corners[lone]]
    return _blend(attribute, values, image, share[corners])


def _vertex_means(values, corners, count):
    """(vertices, ...) mean over the corners of each vertex."""
    sums = np.zeros((count, *values.shape[1:]))
    np.add.at(sums, corners, values)
    uses = np.maximum(np.bincount(corners, minlength=count), 1)
    return sums / uses.reshape(-1, *[1] * (values.ndim - 1))


_MIRROR = {"POINT": _points, "EDGE": _edges, "FACE": _faces, "CORNER": _corners}

register, unregister = bpy.utils.register_classes_factory((INTRINSIC_SYMMETRY_OT_mirror_attribute,))
