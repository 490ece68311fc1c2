# SPDX-License-Identifier: GPL-3.0-or-later
"""Select, and count, what has no mirror image, and what differs from its mirror image."""

import bpy
import numpy as np
from intrinsym import Merge

from . import asymmetry, mesh_data, side_names
from .operator_base import MapOperator
from .ops_select import write_selection
from .weights import read_weights

#: So many groups are named in a report.
_MOST_NAMES = 3


class INTRINSIC_SYMMETRY_OT_select_unmatched(MapOperator, bpy.types.Operator):
    """Select the vertices that have no mirror image, or one that is too uncertain: no tool changes the other side
    from them"""

    bl_idname = "intrinsic_symmetry.select_unmatched"
    bl_label = "Select Without Mirror Image"

    least: bpy.props.FloatProperty(
        name="Confidence Below",
        description="Select also vertices whose mirror image is less certain than this",
        min=0.0, max=1.0, default=0.0, subtype="FACTOR",
    )

    def run_with(self, symmetry, context, object, _mode):
        missing = symmetry.partner < 0
        unsure = ~missing & (symmetry.confidence < self.least)
        chosen = missing | unsure
        selected = _selected(write_selection(context, object.data, chosen), chosen)
        areas = asymmetry.vertex_areas(object.data)
        share = areas[chosen].sum() / max(areas.sum(), 1e-30)
        also = f", {unsure.sum():,} an uncertain one" if self.least > 0 else ""
        return f"{missing.sum():,} of {len(missing):,} vertices have no mirror image{also}: {share:.1%} of the surface{selected}"


class INTRINSIC_SYMMETRY_OT_select_asymmetric(MapOperator, bpy.types.Operator):
    """Select what differs from its mirror image by more than a threshold, and say how much; nothing is changed"""

    bl_idname = "intrinsic_symmetry.select_asymmetric"
    bl_label = "Select Asymmetric"

    what: bpy.props.EnumProperty(
        name="What",
        description="What is compared with the other side",
        items=(
            ("POSITIONS", "Positions", "Places of the vertices, about the mirror plane or in the pose"),
            ("WEIGHTS", "Weights", "Weights of all vertex groups, each with the group of the other side"),
            ("KEY", "Shape Key", "The active shape key, with the key of the other side if there is one"),
        ),
    )
    threshold: bpy.props.FloatProperty(
        name="Threshold",
        description="Least difference that counts: a share of the object's size, or a weight",
        min=0.0, max=1.0, soft_max=0.1, default=0.005, precision=4,
    )
    about: bpy.props.EnumProperty(
        name="About", description="What positions are mirrored about", items=asymmetry.ABOUT
    )

    def draw(self, _context):
        self.layout.use_property_split = True
        for name in ("what", "threshold") + (("about",) if self.what == "POSITIONS" else ()):
            self.layout.prop(self, name)

    def run_with(self, symmetry, context, object, _mode):
        differences, of_what = _DIFFERENCES[self.what](self, symmetry, object)
        differences[symmetry.partner < 0] = 0  # Select Without Mirror Image says these
        chosen = (differences > self.threshold).reshape(len(differences), -1)
        selected = _selected(write_selection(context, object.data, chosen.any(axis=1)), chosen.any(axis=1))
        scale = "{:.3f}" if self.what == "WEIGHTS" else "{:.2%} of the size"
        largest = scale.format(differences.max(initial=0))
        counts = f"{chosen.any(axis=1).sum():,} of {len(chosen):,} vertices"
        return f"{counts} {of_what(chosen.sum(axis=0))}; at most {largest}{selected}"

    def _positions(self, symmetry, object):
        points = mesh_data.shown_positions(object).astype(float)
        reference = asymmetry.reference(self.about, symmetry, object.data, points)
        return reference.asymmetry(symmetry, points), lambda _: f"are asymmetric {reference.in_words()}"

    def _weights(self, symmetry, object):
        names = [group.name for group in object.vertex_groups]
        if not names:
            raise mesh_data.MeshProblem("The object has no vertex groups")
        weights = read_weights(object)
        of_nothing = np.column_stack([weights, np.zeros(len(weights))])
        images = symmetry.mirror_values(of_nothing[:, side_names.counterpart_columns(names)], Merge.SWAP)
        differences = np.abs(weights - images)
        return differences, lambda counts: f"have other weights ({_largest(names, counts)})"

    def _key(self, symmetry, object):
        keys, key = object.data.shape_keys, object.active_shape_key
        if key is None or key == keys.reference_key:
            raise mesh_data.MeshProblem("Choose a shape key that is not the basis")
        other = keys.key_blocks.get(side_names.counterpart(key.name, keys.key_blocks.keys())) or key
        base = mesh_data.key_positions(keys.reference_key).astype(float)
        ends = ((mesh_data.key_positions(one), mesh_data.key_positions(one.relative_key)) for one in (key, other))
        moved, image = (there - rest for there, rest in ends)
        mesh_data.refuse_nowhere(np.hstack([base, moved, image]))
        differences = np.linalg.norm(moved - symmetry.carry_displacement(base, image, Merge.SWAP), axis=1)
        than = f"by {other.name}" if other != key else "their mirror images"
        return differences / asymmetry.size(base), lambda _: f"are moved otherwise by {key.name} than {than}"


def _selected(count, chosen):
    """How many of the chosen vertices are selected, in words, where not all are: hidden ones, or those of no whole face."""
    return f"; {count:,} of these are selected" if count != chosen.sum() else ""


def _largest(names, counts):
    """The groups with the largest counts."""
    order = [group for group in np.argsort(-counts, kind="stable")[:_MOST_NAMES] if counts[group]]
    return ", ".join(f"{names[group]}: {counts[group]:,}" for group in order) or "none"


_DIFFERENCES = {
    "POSITIONS": INTRINSIC_SYMMETRY_OT_select_asymmetric._positions,
    "WEIGHTS": INTRINSIC_SYMMETRY_OT_select_asymmetric._weights,
    "KEY": INTRINSIC_SYMMETRY_OT_select_asymmetric._key,
}

register, unregister = bpy.utils.register_classes_factory(
    (INTRINSIC_SYMMETRY_OT_select_unmatched, INTRINSIC_SYMMETRY_OT_select_asymmetric)
)
