# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences: the options of a detection, as the library's table lists them, and a sign network of one's own."""

import bpy
import intrinsym

SPECS = intrinsym.option_specs()
#: What a choice is called where its own word says too little.
_CHOICES = {"default": "Balanced"}


def _property_of(spec, **more):
    about = {
        "name": spec.name.replace("_", " ").title(),
        "description": spec.help.rstrip("."),  # Blender adds the full stop
        **more,
    }
    if spec.choices:
        items = [(choice, _CHOICES.get(choice, choice.title()), "") for choice in spec.choices]
        return bpy.props.EnumProperty(items=items, default=spec.choices[spec.default], **about)
    return bpy.props.IntProperty(default=spec.default, min=min(spec.default, spec.minimum), max=spec.maximum, **about)


def _network(**more):
    return bpy.props.StringProperty(
        name="Sign Network",
        description="File of a sign network of your own (ONNX) instead of the built-in one. Use only a file you trust",
        subtype="FILE_PATH", **more,
    )


def _properties(**more):
    return {spec.name: _property_of(spec, **more) for spec in SPECS} | {"model": _network(**more)}


class DetectOptions:
    """The options as properties of an operator, which begins with the preferences. Mix in before bpy.types.Operator."""

    __annotations__ = _properties(options={"SKIP_SAVE"})

    def arguments(self, context):
        """Keywords for `intrinsym.Mesh.detect`; what was not set is taken from the preferences."""
        preferences = of(context)
        for name in DetectOptions.__annotations__:
            if preferences is not None and not self.properties.is_property_set(name):
                setattr(self, name, getattr(preferences, name))
        return _arguments(self)


class IntrinsicSymmetryPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    __annotations__ = _properties()
    __annotations__["left_word"] = bpy.props.StringProperty(
        name="Left in Names",
        description="What stands for left in names of your own rigs, as in _izq; the usual conventions are known",
    )
    __annotations__["right_word"] = bpy.props.StringProperty(
        name="Right in Names", description="What stands for right in the same place, as in _der"
    )

    def draw(self, _context):
        layout = self.layout
        draw_options(layout, self)
        layout.prop(self, "left_word")
        layout.prop(self, "right_word")
        layout.operator("wm.call_menu_pie", text="Pie Menu").name = "INTRINSIC_SYMMETRY_MT_pie"
        layout.label(text="The pie menu has no key: right-click the button, Assign Shortcut")
        layout.label(text=f"Intrinsym {intrinsym.library_version()}")


def draw_options(layout, holder):
    """The options of the preferences or of an operator; those for experts are folded away."""
    layout.use_property_split = True
    experts, others = ([spec for spec in SPECS if spec.is_expert is expert] for expert in (True, False))
    column = layout.column()
    for spec in others:
        column.row().prop(holder, spec.name, expand=bool(spec.choices))
    header, body = layout.panel("intrinsic_symmetry_expert", default_closed=True)
    header.label(text="Expert")
    if body is not None:
        for name in (*(spec.name for spec in experts), "model"):
            body.prop(holder, name)


def of(context):
    """The add-on's preferences; nothing where it is not enabled as usual."""
    addon = context.preferences.addons.get(__package__)
    return None if addon is None else addon.preferences


def detect_arguments(context):
    """Keywords for `intrinsym.Mesh.detect`; the library's defaults without preferences."""
    preferences = of(context)
    return {} if preferences is None else _arguments(preferences)


def own_side_words():
    """The user's own words for left and right in names; empty where there are none."""
    preferences = of(bpy.context)
    return (preferences.left_word, preferences.right_word) if preferences else ("", "")


def _arguments(holder):
    arguments = {spec.name: getattr(holder, spec.name) for spec in SPECS}
    if holder.model:
        arguments["model"] = bpy.path.abspath(holder.model)
    return arguments


register, unregister = bpy.utils.register_classes_factory((IntrinsicSymmetryPreferences,))
