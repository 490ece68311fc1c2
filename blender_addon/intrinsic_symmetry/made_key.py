# SPDX-License-Identifier: GPL-3.0-or-later
"""A shape key that is made as the mirror image of another has its settings too: range, value, mute, relative key,
vertex group and drivers, with left and right exchanged in names."""

import re

import bpy
import numpy as np
from intrinsym import Merge

from . import counterparts, mesh_data, side_names, undo
from .weights import read_weights, write_weights

#: Channels that Blender negates in a mirrored pose; as types of driver variables, and as the ends of paths.
_NEGATED = {"LOC_X", "ROT_Y", "ROT_Z"}
_NEGATED_PATH = re.compile(r"(^|\.)(location(\[0\]|\.x)|rotation_(euler(\[[12]\]|\.[yz])|quaternion(\[[23]\]|\.[yz])))$")
_BONE = re.compile(r'pose\.bones\["([^"]+)"\]')
#: How far the axes of an armature may be off those of the world.
_STRAIGHT = 1e-4
_NAMED = re.compile(r'(?<=\[")[^"]+(?="\])')


def make(object, symmetry, name, like):
    """Makes the key at rest, with the settings of `like`. What has to be checked of its drivers, in words."""
    group = _group(object, symmetry, like.vertex_group, side_names.side(name))
    key = object.shape_key_add(name=name, from_mix=False)
    undo.note_made(object, key)
    keys = object.data.shape_keys
    base = side_names.counterpart(like.relative_key.name, keys.key_blocks.keys())
    key.relative_key = keys.key_blocks.get(base, like.relative_key)
    _copy_numbers(key, like)
    key.vertex_group = group
    mesh_data.set_key_positions(key, mesh_data.key_positions(key.relative_key))
    return _copy_drivers(keys, like, key)


def like_another(object, like, moved, objects):
    """A key with the settings of a key of another object, that moves each vertex by `moved`. Its drivers are those of
    its mirror image in the first of the objects that has it."""
    key = object.shape_key_add(name=like.name, from_mix=False)
    undo.note_made(object, key)
    blocks = object.data.shape_keys.key_blocks
    key.relative_key = blocks.get(like.relative_key.name, object.data.shape_keys.reference_key)
    _copy_numbers(key, like)
    key.vertex_group = like.vertex_group
    mesh_data.set_key_positions(key, mesh_data.key_positions(key.relative_key) + moved)
    for keys in (each.data.shape_keys for each in objects if each.data.shape_keys):
        other = side_names.counterpart(like.name, keys.key_blocks.keys())
        if other != like.name and other in keys.key_blocks:
            _copy_drivers(keys, keys.key_blocks[other], key)
            return


def _copy_numbers(key, like):
    key.slider_max = like.slider_max
    key.slider_min = like.slider_min
    key.slider_max = like.slider_max  # again: the range never turns over
    key.value, key.mute, key.interpolation = like.value, like.mute, like.interpolation


def _group(object, symmetry, name, side):
    """Name of the mirror image of a group, which is made if there is none. A group without a side in its name that lies
    on one side alone is that of the other one, and its image gets the `side` as an ending."""
    groups = object.vertex_groups
    if name not in groups:
        return name
    before = read_weights(object)
    column = before[:, [groups[name].index]]
    other = side_names.counterpart(name, groups.keys())
    if other == name and counterparts.is_on_one_side(column, symmetry.side):
        other = name + (".L" if side > 0 else ".R")
    if other in groups:
        return other
    side_names.refuse_too_long([other])
    active = groups.active_index
    groups.new(name=other)
    groups.active_index = active
    before = np.pad(before, ((0, 0), (0, 1)))
    after = before.copy()
    after[:, groups[other].index] = symmetry.mirror_values(column, Merge.SWAP)[:, 0] * (symmetry.partner >= 0)
    write_weights(object, before, after)
    return other


def _copy_drivers(keys, like, key):
    """What has to be checked, in words: signs that cannot be told, and names of the model's side that are read still."""
    data, owner, unsure, staying = keys.animation_data, key.id_data, [], []
    old, new = (f'key_blocks["{bpy.utils.escape_identifier(block.name)}"].' for block in (like, key))
    for curve in [curve for curve in data.drivers if curve.data_path.startswith(old)] if data else []:
        made = (owner.animation_data or owner.animation_data_create()).drivers.from_existing(src_driver=curve)
        made.data_path = curve.data_path.replace(old, new, 1)
        negated = {variable.name: _flip_all(variable) for variable in made.driver.variables}
        unsure += [name for name, is_so in negated.items() if is_so is None]
        if any(negated.values()):
            _negate(made.driver, [name for name, is_so in negated.items() if is_so])
        staying += _read_by_both(curve.driver, made.driver)
    said = (unsure, "the sign of {} cannot be told"), (staying, "it still reads {}: there is no counterpart")
    return [words.format(counterparts.listed(names)) for names, words in said if names]


def _read_by_both(model, made):
    """Names with a side that a driver reads in the same places as its model."""
    names = []
    for variable, own in zip(model.variables, made.variables):
        for other, target in zip(variable.targets, own.targets):
            names += _names(own.type, target) if _place(other) == _place(target) else []
    return [name for name in dict.fromkeys(names) if side_names.side(name)]


def _place(target):
    return target.id, target.bone_target, target.data_path


def _names(kind, target):
    """What the target of a kind of variable reads: the properties and bones of a path, or a bone; and without a bone the object."""
    names = _NAMED.findall(target.data_path) if kind == "SINGLE_PROP" else [target.bone_target]
    return names if _bone(target) or not isinstance(target.id, bpy.types.Object) else [*names, target.id.name]


def _flip_all(variable):
    """Turns the targets of a driver's variable to the other side. Whether it has the other sign there, in the mirrored
    pose; None where that cannot be told."""
    target = variable.targets[0]
    before = _place(target)
    for each in variable.targets:
        _flip(each)
    if before == _place(target) and not _is_central(target):
        return False
    if variable.type == "SINGLE_PROP":
        negated = bool(_NEGATED_PATH.search(target.data_path))
    elif variable.type == "TRANSFORMS" and not target.transform_type.startswith("SCALE"):
        negated = target.transform_type in _NEGATED
        if target.transform_space == "WORLD_SPACE" and _bone(target) and not _mirrors_world_x(target.id):
            return None
    else:
        return False
    return negated if _bone(target) or not negated else None  # nothing says how the axes of other objects lie


def _mirrors_world_x(object):
    """Whether the mirror plane of an armature, its own X = 0, is that of the world."""
    matrix = np.array(object.matrix_world)
    return not (np.abs([*matrix[0, 1:], *matrix[1:3, 0]]) > _STRAIGHT).any()


def _is_central(target):
    """Whether a driver's target is a bone or an object in the middle, which a mirrored pose mirrors in itself."""
    if name := _bone(target):
        bones = _bones(target)
        return name in bones and side_names.side(name, bones) == 0
    return isinstance(target.id, bpy.types.Object) and side_names.side(target.id.name, bpy.data.objects.keys()) == 0


def _negate(driver, names):
    """Gives the variables of a driver the other sign."""
    every = [variable.name for variable in driver.variables]
    if driver.type != "SCRIPTED":
        means = {"AVERAGE": f"({' + '.join(every)}) / {len(every)}", "SUM": " + ".join(every)}
        driver.expression = means.get(driver.type, f"{driver.type.lower()}({', '.join(every)})" if len(every) > 1 else every[0])
        driver.type = "SCRIPTED"
    for name in names:
        driver.expression = re.sub(rf"(?<![\w.]){re.escape(name)}(?!\w)", f"(-{name})", driver.expression)


def _flip(target):
    """Turns a driver's target to the bone, the property or the object of the other side, where there is one."""
    bones = _bones(target)
    other = side_names.counterpart(target.bone_target, bones)
    if other in bones:
        target.bone_target = other
    path = _NAMED.sub(lambda match: side_names.counterpart(match[0], bones), target.data_path)
    if path != target.data_path and target.id is not None and _leads_somewhere(target.id, path):
        target.data_path = path
    elif isinstance(target.id, bpy.types.Object) and not _bone(target):
        other = bpy.data.objects.get(side_names.counterpart(target.id.name, bpy.data.objects.keys()))
        if other and _leads_somewhere(other, target.data_path) >= _leads_somewhere(target.id, target.data_path):
            target.id = other


def _bone(target):
    """Name of the bone that a driver's target reads, or nothing."""
    return target.bone_target or "".join(_BONE.findall(target.data_path)[:1])


def _bones(target):
    """Names of the bones of a driver's target."""
    pose = getattr(target.id, "pose", None)
    return pose.bones.keys() if pose is not None else []


def _leads_somewhere(owner, path):
    try:
        owner.path_resolve(path)
    except ValueError:
        return False
    return True
