# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences: the options of a detection, as the library's table lists them, and a sign network of one's own."""

import bpy
import intrinsym


#: The options that are shown: no tool of the add-on takes a rotation.
SPECS = [spec for spec in intrinsym.option_specs() if spec.name != "rotations"]


def _property_of(spec):
    about = {
        "name": spec.name.replace("_", " ").title(),
        "description": spec.help.rstrip("."),  # Blender adds the full stop
    }
    if spec.choices:
        items = [(choice, choice.title(), "") for choice in spec.choices]
        return bpy.props.EnumProperty(items=items, default=spec.choices[spec.default], **about)
    return bpy.props.IntProperty(default=spec.default, min=min(spec.default, spec.minimum), max=spec.maximum, **about)


class IntrinsicSymmetryPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    __annotations__ = {spec.name: _property_of(spec) for spec in SPECS}
    __annotations__["model"] = bpy.props.StringProperty(
        name="Sign Network",
        description="File of a sign network of your own (ONNX) instead of the built-in one. Use only a file you trust",
        subtype="FILE_PATH",
    )

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        column = layout.column()
        for spec in sorted(SPECS, key=lambda spec: spec.is_expert):
            column.prop(self, spec.name)
        column.prop(self, "model")
        layout.label(text=f"Intrinsym {intrinsym.library_version()}")


def detect_arguments(context):
    """Keywords for `intrinsym.Mesh.detect`; the library's defaults where the add-on is not enabled as usual."""
    addon = context.preferences.addons.get(__package__)
    if addon is None or addon.preferences is None:
        return {}
    preferences = addon.preferences
    arguments = {spec.name: getattr(preferences, spec.name) for spec in SPECS}
    if preferences.model:
        arguments["model"] = bpy.path.abspath(preferences.model)
    return arguments


register, unregister = bpy.utils.register_classes_factory((IntrinsicSymmetryPreferences,))
