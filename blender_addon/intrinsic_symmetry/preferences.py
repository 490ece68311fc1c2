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
    __annotations__["left_word"] = bpy.props.StringProperty(
        name="Left in Names",
        description="What stands for left in names of your own rigs, as in _izq; the usual conventions are known",
    )
    __annotations__["right_word"] = bpy.props.StringProperty(
        name="Right in Names", description="What stands for right in the same place, as in _der"
    )

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        column = layout.column()
        for spec in sorted(SPECS, key=lambda spec: spec.is_expert):
            column.prop(self, spec.name)
        column.prop(self, "model")
        column.prop(self, "left_word")
        column.prop(self, "right_word")
        layout.label(text=f"Intrinsym {intrinsym.library_version()}")


def _of_addon(context):
    """The preferences; nothing where the add-on is not enabled as usual."""
    addon = context.preferences.addons.get(__package__)
    return addon and addon.preferences


def detect_arguments(context):
    """Keywords for `intrinsym.Mesh.detect`; the library's defaults where there are no preferences."""
    preferences = _of_addon(context)
    if preferences is None:
        return {}
    arguments = {spec.name: getattr(preferences, spec.name) for spec in SPECS}
    if preferences.model:
        arguments["model"] = bpy.path.abspath(preferences.model)
    return arguments


def own_side_words():
    """The user's own words for left and right in names; empty where there are none."""
    preferences = _of_addon(bpy.context)
    return (preferences.left_word, preferences.right_word) if preferences else ("", "")


register, unregister = bpy.utils.register_classes_factory((IntrinsicSymmetryPreferences,))
