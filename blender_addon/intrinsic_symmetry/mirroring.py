# SPDX-License-Identifier: GPL-3.0-or-later
"""What all mirror operators share: which way values go, how far each vertex is changed, and which may change."""

import bpy
import numpy as np
from intrinsym import Merge, SymmetryKind

from . import mesh_data, side_names, stored_map
from .counterparts import listed
from .places import Places, gathered

DIRECTIONS = (
    ("LEFT_TO_RIGHT", "Left to Right", "The left side stays, the right one becomes its mirror image", Merge.POSITIVE_WINS),
    ("RIGHT_TO_LEFT", "Right to Left", "The right side stays, the left one becomes its mirror image", Merge.NEGATIVE_WINS),
    ("AVERAGE", "Average", "Both sides take the mean", Merge.AVERAGE),
    ("SWAP", "Exchange", "Both sides take the other's", Merge.SWAP),
)
MERGE = {identifier: merge for identifier, _, _, merge in DIRECTIONS}


class ConfidenceProperties:
    """Which vertices are trusted. Mix in before bpy.types.Operator."""

    minimum_confidence: bpy.props.FloatProperty(
        name="Minimum Confidence",
        description="Leave vertices alone whose mirror image is less certain than this",
        min=0.0, max=1.0, default=0.0, subtype="FACTOR",
    )
    soft: bpy.props.BoolProperty(
        name="Soft by Confidence",
        description="Change each vertex only by the share of its confidence",
        default=False,
    )

    def how(self):
        """Keywords of the library's mirror tools."""
        return {"minimum_confidence": self.minimum_confidence, "weight_by_confidence": self.soft}

    def may_change(self, object, mode, _symmetry):
        """(vertices,) 0..1 how far each vertex may be changed: not if hidden, masked or outside a paint selection."""
        return mesh_data.changeable(object.data, mode)


_DIRECTION = {
    "name": "Direction",
    "description": "Which side takes the values of the other",
    "items": [entry[:3] for entry in DIRECTIONS],
    "default": "LEFT_TO_RIGHT",
}


class MirrorProperties(ConfidenceProperties):
    """Properties of an operator that mirrors. Mix in before bpy.types.Operator."""

    direction: bpy.props.EnumProperty(**_DIRECTION)
    selected_only: bpy.props.BoolProperty(
        name="Selected Only",
        description="In edit mode with a selection, change only the selected vertices and their mirror images",
        default=True,
    )

    @property
    def merge(self):
        return MERGE[self.direction]

    def shares(self, symmetry):
        """(vertices,) how much of the mirrored value each vertex takes, as the library's tools do."""
        return shares(symmetry, self.merge, **self.how())

    def trust(self, symmetry):
        """(vertices,) how much of the mirrored value each vertex would take, whatever its side."""
        return shares(symmetry, Merge.SWAP, **self.how())

    def with_line(self, symmetry, trust):
        """The shares of the direction, where each vertex that it changes takes `trust`: a vertex on the line belongs to
        both sides, and takes the mean."""
        if self.merge == Merge.SWAP:
            return trust
        return trust * np.where(symmetry.side == 0, 0.5, shares(symmetry, self.merge))

    def may_change(self, object, mode, symmetry):
        """Of what may be changed, the selection and its mirror image, or all."""
        free = super().may_change(object, mode, symmetry)
        if not self.selected_only or mode != "EDIT":
            return free
        if not any(mesh_data.selected_vertices(each.data).any() for each in self.objects):
            return free
        selected = mesh_data.selected_vertices(object.data)
        return free * (selected | symmetry.mirror_selection(selected))

    def held(self, mesh, symmetry, free):
        """The map and the keywords of `symmetrize_positions`, with which what is not free, (vertices,) 0..1, holds the
        border, so that no step appears there."""
        how = self.how()
        if free.all():
            return symmetry, how
        how["minimum_confidence"] = max(how["minimum_confidence"], stored_map.LEAST)
        return stored_map.load(mesh, only=free > 0), how


class NamedMirrorProperties(MirrorProperties):
    """Of an operator that mirrors what has a name: the active one's side wins, unless the user chooses a direction.
    That is not kept for the next call, which may be about another name."""

    direction: bpy.props.EnumProperty(**_DIRECTION, options={"SKIP_SAVE"})

    def let_win(self, name, names):
        """Sets the direction, where none was chosen, to carry what is on the side that one of the names says."""
        side = side_names.side(name, names)
        if side and not self.properties.is_property_set("direction"):
            self.direction = "LEFT_TO_RIGHT" if side > 0 else "RIGHT_TO_LEFT"

    def with_made(self, said, before, names):
        """The sentence for the user, with those of the names that were not there before."""
        made = [name for name in names if name not in before]
        if twice := side_names.written_otherwise(made, before):
            self.warn(f"Made, though it is there in other letters: {listed(twice)}. Write a pair alike, but for the side")
        return f"{said}. Made: {listed(made)}" if made else said

    def without_too_long(self, names, every):
        """The names but those whose twin's is too long, which are left alone."""
        long = [name for name in names if side_names.is_too_long(side_names.counterpart(name, every))]
        self.leave(long, "the name of the other side is too long for Blender: shorten it")
        return [name for name in names if name not in long]


def shares(symmetry, merge, *, minimum_confidence=0.0, weight_by_confidence=False):
    """(vertices,) share of the mirrored value in the new one, 0..1: what `intrinsym.Symmetry.mirror_values` does
    inside, needed where names are exchanged on the way. A test holds the two together."""
    if merge in (Merge.POSITIVE_WINS, Merge.NEGATIVE_WINS):
        if symmetry.kind == SymmetryKind.HALF_TURN:
            raise mesh_data.MeshProblem("A half turn has no left and right: choose Average or Exchange")
        taken = (symmetry.side == (-1 if merge == Merge.POSITIVE_WINS else 1)).astype(float)
    else:
        taken = np.full(len(symmetry.side), 0.5 if merge == Merge.AVERAGE else 1.0)
    if weight_by_confidence:
        taken *= symmetry.confidence
    taken[(symmetry.partner < 0) | (symmetry.confidence < minimum_confidence)] = 0.0
    return taken


def blend(own, image, share):
    """Own values where the share is 0, the mirror image's where it is 1; rows are vertices."""
    share = share.reshape(-1, *[1] * (own.ndim - 1))
    return np.where(share >= 1, image, (1 - share) * own + share * image)


def carried_together(symmetry, positions, displacement, merge, **how):
    """(vertices, 3) `carry_displacement`, but vertices at one place, as of shells that touch, go to one place if they did and
    so did their mirror images: each shell has local frames of its own."""
    carried = symmetry.carry_displacement(positions, displacement, merge, **how)
    places = Places(positions)
    taken = shares(symmetry, merge, **how) > 0
    pairs = places.pairs[taken[places.pairs].all(axis=1)]
    for moves in (displacement, displacement[symmetry.partner]):
        pairs = pairs[places.alike(moves, pairs)]
    return gathered(carried, pairs)
