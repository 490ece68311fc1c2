# SPDX-License-Identifier: GPL-3.0-or-later
"""What shape keys keep when others, or their basis, are mirrored."""

import bpy
import numpy as np
import pytest
from conftest import attribute, module, positions, said, selected
from intrinsym import Merge

ops = bpy.ops.intrinsic_symmetry


def _normals(mesh):
    normals = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("normal", normals)
    return normals.reshape(-1, 3)


@pytest.fixture
def swelling(human):
    """(vertices, 3) a swelling of the outermost part of the left side."""
    points, side = positions(human.data), attribute(human.data, "sym_side")
    far = np.argmax(np.where(side == 1, points[:, 0], -np.inf))
    distance = np.linalg.norm(points - points[far], axis=1) / np.ptp(points[:, 0])
    return 0.01 * np.where(side == 1, np.maximum(1 - 3 * distance, 0), 0)[:, None] * _normals(human.data)


def _key(object, name, displacement, relative_to=None):
    if object.data.shape_keys is None:
        object.shape_key_add(name="Basis")
    key = object.shape_key_add(name=name)
    if relative_to:
        key.relative_key = object.data.shape_keys.key_blocks[relative_to]
    base = module("mesh_data").key_positions(key.relative_key)
    module("mesh_data").set_key_positions(key, base + displacement)
    object.active_shape_key_index = object.data.shape_keys.key_blocks.find(name)
    return key


def _moved(object, name):
    """(vertices, 3) displacement of a key; nothing without such a key."""
    key = object.data.shape_keys.key_blocks[name]
    base = module("mesh_data").key_positions(key.relative_key)
    return module("mesh_data").key_positions(key).astype(float) - base


def _size(object, name):
    return np.abs(_moved(object, name)).max()


@pytest.mark.parametrize("tool", ["symmetrize", "mirror_edit"])
def test_other_keys_keep_their_offsets_when_the_basis_is_edited(human, swelling, tool):
    random = 0.01 * np.random.default_rng(0).normal(size=swelling.shape)
    _key(human, "Smile", random)
    _key(human, "More", random, relative_to="Smile")
    human.active_shape_key_index = 0
    ops.remember()
    basis = module("mesh_data").shown_positions(human)
    module("mesh_data").set_shown_positions(human, basis + swelling)
    getattr(ops, tool)(direction="LEFT_TO_RIGHT")
    right = attribute(human.data, "sym_side") == -1
    assert np.abs(module("mesh_data").shown_positions(human) - basis)[right].max() > 0.005
    for name in ("Smile", "More"):
        assert np.abs(_moved(human, name) - random).max() < 2e-6
    assert np.abs(positions(human.data) - module("mesh_data").shown_positions(human)).max() == 0


def test_what_is_remembered_on_one_key_is_not_mirrored_on_another(human, swelling):
    _key(human, "Smile", swelling)
    _key(human, "Frown", -swelling)
    ops.remember()
    human.active_shape_key_index = 1
    with pytest.raises(RuntimeError, match='The shape key "Frown" is remembered'):
        ops.mirror_edit()
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match='The shape key "Frown" is remembered'):
        ops.mirror_edit()
    bpy.ops.object.mode_set(mode="OBJECT")
    human.active_shape_key_index = 2
    assert ops.mirror_edit() == {"FINISHED"}
    ops.clear()
    assert not [name for name in human.data.attributes.keys() if name.startswith("sym_")]


@pytest.mark.parametrize("active", ["Smile.L", "Smile.R"])
@pytest.mark.parametrize("direction", ["LEFT_TO_RIGHT", "RIGHT_TO_LEFT", "AVERAGE"])
def test_an_empty_key_does_not_erase_its_counterpart(human, swelling, active, direction):
    for name, displacement in (("Smile.L", swelling), ("Smile.R", 0 * swelling)):
        _key(human, name, displacement)
    human.active_shape_key_index = human.data.shape_keys.key_blocks.find(active)
    ops.mirror_shape_keys(direction=direction)
    assert np.abs(_moved(human, "Smile.L") - swelling).max() < 1e-6 and _size(human, "Smile.R") > 0.005


@pytest.mark.parametrize("direction, left, right", [("LEFT_TO_RIGHT", 1, 1), ("RIGHT_TO_LEFT", 3, 3), ("AVERAGE", 2, 2),
                                                    ("SWAP", 3, 1)])
def test_the_direction_counts_for_pairs(human, swelling, direction, left, right):
    _key(human, "Smile.L", swelling)
    ops.mirror_shape_keys()
    image = _moved(human, "Smile.R")
    right_key = human.data.shape_keys.key_blocks["Smile.R"]
    module("mesh_data").set_key_positions(right_key, positions(human.data) + 3 * image)
    ops.mirror_shape_keys(direction=direction)
    for name, wanted in (("Smile.L", left * swelling), ("Smile.R", right * image)):
        assert np.abs(_moved(human, name) - wanted).max() < 0.15 * 0.01 * 3


def test_an_exchange_with_a_key_that_is_not_there_empties_its_own(human, swelling):
    _key(human, "Smile.L", swelling)
    ops.mirror_shape_keys(direction="SWAP")
    assert _size(human, "Smile.L") < 1e-6 and _size(human, "Smile.R") > 0.005
    human.active_shape_key_index = human.data.shape_keys.key_blocks.find("Smile.L")
    ops.mirror_shape_keys(direction="SWAP")
    assert np.abs(_moved(human, "Smile.L") - swelling).max() < 1e-6 and _size(human, "Smile.R") < 1e-6


def test_keys_without_a_known_side_are_left_alone(human, swelling, capfd):
    _key(human, "Sonrisa_izq", swelling)
    ops.mirror_shape_keys(direction="SWAP", exchange_names=False)
    image = _moved(human, "Sonrisa_izq")
    _key(human, "Sonrisa_der", swelling)
    text = said(capfd, ops.mirror_shape_keys, all_keys=True, direction="LEFT_TO_RIGHT")
    assert "Sonrisa_izq" in text and "Sonrisa_der" in text
    assert np.array_equal(_moved(human, "Sonrisa_izq"), image)
    assert np.abs(_moved(human, "Sonrisa_der") - swelling).max() < 1e-6


def _rig(*names):
    rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
    bpy.context.scene.collection.objects.link(rig)
    active = bpy.context.view_layer.objects.active
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name in names or ("jaw.L", "jaw.R"):
        rig.data.edit_bones.new(name).tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.objects.active = active
    for name in ("smile_L", "smile_R"):
        rig[name] = 0.5
    return rig


def _drive(key, rig):
    driver = key.driver_add("value").driver
    driver.expression = "bone + own"
    bone, own = driver.variables.new(), driver.variables.new()
    bone.name, bone.type = "bone", "TRANSFORMS"
    bone.targets[0].id, bone.targets[0].bone_target = rig, "jaw.L"
    own.name, own.targets[0].id, own.targets[0].data_path = "own", rig, '["smile_L"]'


def _read_bone(driver, rig, bone, channel, space="LOCAL_SPACE"):
    """Makes a driver read a bone: a channel of a type of variable, or the end of a path."""
    variable, driver.expression = driver.variables.new(), "x + 5"
    variable.name, target = "x", variable.targets[0]
    if channel.isupper():
        variable.type = "TRANSFORMS"
        target.bone_target, target.transform_type, target.transform_space = bone, channel, space
        target.id = rig
    else:
        target.id, target.data_path = rig, f'pose.bones["{bone}"].{channel}'


def _driven(object, rig, posed):
    """Values of Smile.L and Smile.R in a pose, mirrored on bones with the sign -1."""
    for bone, sign in posed.items():
        rig.pose.bones[bone].rotation_mode = "XYZ"
        rig.pose.bones[bone].location = sign * 0.1, 0.2, 0.3
        rig.pose.bones[bone].rotation_euler = 0.1, sign * 0.2, sign * 0.3
    bpy.context.view_layer.update()
    keys = object.data.shape_keys.evaluated_get(bpy.context.evaluated_depsgraph_get()).key_blocks
    return keys["Smile.L"].value, keys["Smile.R"].value


@pytest.mark.parametrize("kind", ["SCRIPTED", "SUM", "AVERAGE"])
@pytest.mark.parametrize("channel", ["LOC_X", "LOC_Y", "LOC_Z", "ROT_X", "ROT_Y", "ROT_Z", "SCALE_X"])
def test_a_driver_has_the_sign_of_the_mirrored_pose(human, swelling, channel, kind):
    """As Blender's own flipped poses: the right bone's X and its turns about Y and Z are negated."""
    rig, key = _rig(), _key(human, "Smile.L", swelling)
    driver = key.driver_add("value").driver
    _read_bone(driver, rig, "jaw.L", channel)
    driver.type = kind
    if kind == "SCRIPTED":
        driver.expression = "max(x, 0)"
    ops.mirror_shape_keys()
    left, right = _driven(human, rig, {"jaw.L": 1, "jaw.R": -1})
    assert left > 0.05 and right == pytest.approx(left, abs=1e-5)


@pytest.mark.parametrize("channel", ["LOC_X", "LOC_Y", "ROT_X", "ROT_Y", "ROT_Z", "rotation_euler[2]", "location[1]"])
def test_a_driver_by_a_bone_in_the_middle_has_the_sign_of_the_mirrored_pose(human, swelling, channel):
    rig, key = _rig("head"), _key(human, "Smile.L", swelling)
    key.slider_max = 9
    _read_bone(key.driver_add("value").driver, rig, "head", channel)
    ops.mirror_shape_keys()
    left, _ = _driven(human, rig, {"head": 1})
    assert left not in (0, 5)
    assert _driven(human, rig, {"head": -1})[1] == pytest.approx(left, abs=1e-5)


@pytest.mark.parametrize("path", ["location.x", "location.y", "rotation_euler.x", "rotation_euler.y", "rotation_euler.z"])
def test_a_driver_by_a_path_with_a_dot_has_the_sign_of_the_mirrored_pose(human, swelling, path):
    rig, key = _rig(), _key(human, "Smile.L", swelling)
    key.slider_max = 9
    _read_bone(key.driver_add("value").driver, rig, "jaw.L", path)
    ops.mirror_shape_keys()
    left, right = _driven(human, rig, {"jaw.L": 1, "jaw.R": -1})
    assert left not in (0, 5) and right == pytest.approx(left, abs=1e-5)


@pytest.mark.parametrize("space", ["TRANSFORM_SPACE", "WORLD_SPACE"])
@pytest.mark.parametrize("channel", ["LOC_X", "LOC_Y", "LOC_Z", "ROT_X", "ROT_Y", "ROT_Z"])
def test_a_driver_in_another_space_has_the_sign_of_the_mirrored_pose(human, swelling, channel, space, capfd):
    rig, key = _rig(), _key(human, "Smile.L", swelling)
    key.slider_max = 9
    _read_bone(key.driver_add("value").driver, rig, "jaw.L", channel, space)
    assert "Check" not in said(capfd, ops.mirror_shape_keys)
    left, right = _driven(human, rig, {"jaw.L": 1, "jaw.R": -1})
    assert left not in (0, 5) and right == pytest.approx(left, abs=1e-5)


def test_a_driver_whose_sign_cannot_be_told_is_named(human, swelling, capfd):
    """In the space of the world, beside the mirror plane of the armature."""
    rig, key = _rig(), _key(human, "Smile.L", swelling)
    rig.location.x = 1
    bpy.context.view_layer.update()
    _read_bone(key.driver_add("value").driver, rig, "jaw.L", "LOC_X", "WORLD_SPACE")
    assert 'Check the driver of "Smile.R": the sign of "x"' in said(capfd, ops.mirror_shape_keys)


@pytest.mark.parametrize("channel, is_unsure", [("LOC_X", True), ("LOC_Z", False), ("SCALE_X", False), ("location[0]", True),
                                                ("location.z", False), ('["smile"]', False)])
@pytest.mark.parametrize("names", [("jaw.L", "jaw.R"), ("jaw",), ("jaw.L",)])
def test_a_driver_by_an_object_reads_that_of_the_other_side(human, swelling, names, channel, is_unsure, capfd):
    """How its axes lie is not known: where the mirrored pose may have the other sign, the driver is named."""
    for name in names:
        bpy.data.objects.new(name, None)["smile"] = 0.5
    driver = _key(human, "Smile.L", swelling).driver_add("value").driver
    variable = driver.variables.new()
    variable.type = "TRANSFORMS" if channel.isupper() else "SINGLE_PROP"
    target = variable.targets[0]
    target.id = bpy.data.objects[names[0]]
    if channel.isupper():
        target.transform_type = channel
    else:
        target.data_path = channel
    text = said(capfd, ops.mirror_shape_keys)
    assert ('Check the driver of "Smile.R": the sign of "var" cannot be told' in text) is (is_unsure and names != ("jaw.L",))
    made = human.data.shape_keys.animation_data.drivers.find('key_blocks["Smile.R"].value').driver.variables[0]
    assert made.targets[0].id.name == names[-1] and target.id.name == names[0]


@pytest.mark.parametrize("there", [True, False])
@pytest.mark.parametrize("read", ["bone", "path", "property", "object", "key"])
def test_a_driver_that_reads_what_has_no_counterpart_is_named(human, swelling, read, there, capfd):
    """It is copied all the same: the twin may be made later."""
    rig = _rig("jaw.L", *["jaw.R"] * there)
    for name in ("Ctrl.L", *["Ctrl.R"] * there):
        bpy.data.objects.new(name, None)
        _key(human, f"Brow{name[-2:]}", swelling)
    driver = _key(human, "Smile.L", swelling).driver_add("value").driver
    variable = driver.variables.new()
    target = variable.targets[0]
    if read == "key":
        target.id_type = "KEY"
    else:
        variable.type = "TRANSFORMS" if read in ("bone", "object") else "SINGLE_PROP"
    target.id = {"object": bpy.data.objects["Ctrl.L"], "key": human.data.shape_keys}.get(read, rig)
    if read == "bone":
        target.bone_target = "jaw.L"
    paths = {"path": 'pose.bones["jaw.L"].scale[0]', "property": '["smile_L"]', "key": 'key_blocks["Brow.L"].value'}
    target.data_path = paths.get(read, "")
    if not there:
        del rig["smile_R"]
    name = {"property": "smile_L", "object": "Ctrl.L", "key": "Brow.L"}.get(read, "jaw.L")
    text = said(capfd, ops.mirror_shape_keys)
    assert (f'Check the driver of "Smile.R": it still reads "{name}": there is no counterpart' in text) is not there
    assert human.data.shape_keys.animation_data.drivers.find('key_blocks["Smile.R"].value')


def test_a_made_key_has_the_settings_of_its_model(human, swelling, truth):
    _key(human, "Base.L", swelling)
    _key(human, "Base.R", 0 * swelling)
    key = _key(human, "Smile.L", swelling, relative_to="Base.L")
    key.slider_max, key.slider_min, key.mute, key.value = 3, 2, True, 2.5
    group = human.vertex_groups.new(name="Mouth.L")
    inside = np.flatnonzero(np.abs(swelling).max(axis=1))
    group.add(inside.tolist(), 0.5, "REPLACE")
    key.vertex_group = "Mouth.L"
    _drive(key, _rig())
    ops.mirror_shape_keys()
    made = human.data.shape_keys.key_blocks["Smile.R"]
    assert (made.slider_min, made.slider_max, made.mute) == (2, 3, True)
    assert made.vertex_group == "Mouth.R" and made.relative_key.name == "Base.R"
    weights = module("weights").read_weights(human)[:, human.vertex_groups["Mouth.R"].index]
    assert np.array_equal(np.flatnonzero(weights), np.sort(truth[inside]))
    driver = {curve.data_path: curve.driver for curve in human.data.shape_keys.animation_data.drivers}[
        'key_blocks["Smile.R"].value'
    ]
    assert driver.expression == "(-bone) + own"
    assert driver.variables["bone"].targets[0].bone_target == "jaw.R"
    assert driver.variables["own"].targets[0].data_path == '["smile_R"]'
    assert _size(human, "Smile.R") > 0.005


def test_names_that_say_their_side_only_as_a_pair(human, swelling, truth):
    """Of keys, of the key that one is relative to, and of the bones of its drivers."""
    _key(human, "Lpuff", swelling)
    _key(human, "Rpuff", 0.5 * swelling[truth])
    ops.mirror_shape_keys()
    assert _size(human, "Rpuff") == pytest.approx(0.5 * np.abs(swelling).max(), rel=0.3), "the active one wins"
    assert _size(human, "Lpuff") == pytest.approx(_size(human, "Rpuff"), rel=0.3)
    key = _key(human, "Smile.L", swelling, relative_to="Lpuff")
    driver = key.driver_add("value").driver
    for name, kind in (("x", "TRANSFORMS"), ("y", "SINGLE_PROP")):
        driver.variables.new().name = name
        driver.variables[name].type = kind
    rig = _rig("Ljaw", "Rjaw")
    turned, read = driver.variables["x"].targets[0], driver.variables["y"].targets[0]
    turned.id, turned.bone_target = rig, "Ljaw"
    read.id, read.data_path = rig, 'pose.bones["Ljaw"].scale[0]'
    ops.mirror_shape_keys()
    assert human.data.shape_keys.key_blocks["Smile.R"].relative_key.name == "Rpuff"
    curve = human.data.shape_keys.animation_data.drivers.find('key_blocks["Smile.R"].value')
    targets = [variable.targets[0] for variable in curve.driver.variables]
    assert targets[0].bone_target == "Rjaw" and targets[1].data_path == 'pose.bones["Rjaw"].scale[0]'


def test_a_made_key_has_the_value_of_its_model(human, swelling):
    _key(human, "Smile.L", swelling).value = 0.75
    ops.mirror_shape_keys()
    assert human.data.shape_keys.key_blocks["Smile.R"].value == 0.75


def test_locked_keys_stay(human, swelling, capfd):
    _key(human, "Smile.L", swelling)
    _key(human, "Smile.R", 0 * swelling).lock_shape = True
    assert "locked" in said(capfd, ops.mirror_shape_keys)
    assert _size(human, "Smile.R") == 0
    with pytest.raises(RuntimeError, match="locked"):
        ops.symmetrize()


@pytest.mark.parametrize("base", ["Basis", "Smile"])
def test_a_locked_key_goes_with_its_relative_key_as_in_blender(human, swelling, base):
    """Blender's edit mode moves it along, so that its displacement stays; the tools do the same."""
    _key(human, "Smile", swelling)
    kept = 0.01 * np.random.default_rng(0).normal(size=swelling.shape)
    for name, relative_to in (("More", base), ("Most", "More")):
        _key(human, name, kept, relative_to=relative_to).lock_shape = True
    human.active_shape_key_index = human.data.shape_keys.key_blocks.find(base)

    def places():
        return [module("mesh_data").key_positions(human.data.shape_keys.key_blocks[name]) for name in (base, "More", "Most")]

    for change in (_grab_in_edit_mode, ops.mirror_shape_keys if base == "Smile" else ops.symmetrize):
        before = places()
        change()
        moves = [after - earlier for after, earlier in zip(places(), before)]
        assert np.abs(moves[0]).max() > 0.005
        assert np.abs(moves[1] - moves[0]).max() < 2e-6 and np.abs(moves[2] - moves[0]).max() < 2e-6
        assert all(np.abs(_moved(human, name) - kept).max() < 2e-6 for name in ("More", "Most"))


def _grab_in_edit_mode():
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.transform.translate(value=(0.01, 0, 0))
    bpy.ops.object.mode_set(mode="OBJECT")


@pytest.mark.parametrize("locked", ["Smile.L", "Smile.R"])
def test_an_exchange_with_a_locked_key_changes_neither(human, swelling, truth, locked, capfd):
    _key(human, "Smile.L", swelling)
    _key(human, "Smile.R", 0.5 * swelling[truth])
    human.data.shape_keys.key_blocks[locked].lock_shape = True
    before = {name: _moved(human, name) for name in ("Smile.L", "Smile.R")}
    text = said(capfd, ops.mirror_shape_keys, direction="SWAP")
    assert "Smile.L" in text and "Smile.R" in text and "locked" in text and "0 shape keys" in text
    assert all(np.array_equal(_moved(human, name), moved) for name, moved in before.items())
    assert f'alone: "{locked}" (locked)' in said(capfd, ops.mirror_shape_keys, direction="AVERAGE")
    changed = [name for name, moved in before.items() if not np.array_equal(_moved(human, name), moved)]
    assert changed and locked not in changed


@pytest.mark.parametrize("active", ["Smile.L", "Smile.R"])
def test_the_active_key_is_carried_to_its_twin(human, swelling, truth, active):
    for name, moved in (("Smile.L", swelling), ("Smile.R", 0.5 * swelling[truth])):
        _key(human, name, moved)
    human.active_shape_key_index = human.data.shape_keys.key_blocks.find(active)
    sizes = {name: _size(human, name) for name in ("Smile.L", "Smile.R")}
    ops.mirror_shape_keys()
    other = "Smile.R" if active == "Smile.L" else "Smile.L"
    assert _size(human, active) == sizes[active] and _size(human, other) == pytest.approx(sizes[active], rel=0.3)


def test_a_chosen_direction_wins_over_the_active_key(human, swelling, truth):
    _key(human, "Smile.L", swelling)
    _key(human, "Smile.R", 0.5 * swelling[truth])
    before = _size(human, "Smile.L")
    ops.mirror_shape_keys(direction="LEFT_TO_RIGHT")
    assert _size(human, "Smile.L") == before and _size(human, "Smile.R") == pytest.approx(before, rel=0.3)


@pytest.mark.parametrize("relative", [True, False])
def test_a_key_made_among_absolute_ones_is_named(human, swelling, relative, capfd):
    _key(human, "Swell.L", swelling)
    human.data.shape_keys.use_relative = relative
    text = said(capfd, ops.mirror_shape_keys)
    assert ("absolute" in text) is not relative and ('"Swell.R" is one more' in text) is not relative


def test_a_mask_on_one_side_is_mirrored_though_its_name_says_no_side(human, swelling, truth):
    weight = np.linalg.norm(swelling, axis=1) / np.linalg.norm(swelling, axis=1).max()
    group = human.vertex_groups.new(name="mask")
    for vertex in np.flatnonzero(weight).tolist():
        group.add((vertex,), float(weight[vertex]), "REPLACE")
    _key(human, "Smile.L", swelling).vertex_group = "mask"
    ops.mirror_shape_keys()
    keys = human.data.shape_keys.key_blocks
    assert (keys["Smile.L"].vertex_group, keys["Smile.R"].vertex_group) == ("mask", "mask.R")
    read = module("weights").read_weights(human)
    column = human.vertex_groups["mask.R"].index
    assert np.allclose(read[truth, column], weight, atol=1e-5)


def test_a_mask_on_both_sides_stays(human, swelling):
    human.vertex_groups.new(name="mask").add(range(len(swelling)), 0.5, "REPLACE")
    _key(human, "Smile.L", swelling).vertex_group = "mask"
    ops.mirror_shape_keys()
    assert human.data.shape_keys.key_blocks["Smile.R"].vertex_group == "mask"
    assert human.vertex_groups.keys() == ["mask"]


def test_a_mask_whose_twin_has_too_long_a_name(human, swelling):
    human.vertex_groups.new(name=62 * "m").add(np.flatnonzero(swelling.any(axis=1)).tolist(), 1, "REPLACE")
    _key(human, "Smile.L", swelling).vertex_group = 62 * "m"
    with pytest.raises(RuntimeError, match='"m{62}.R" is too long for Blender: shorten the name'):
        ops.mirror_shape_keys()
    assert "Smile.R" not in human.data.shape_keys.key_blocks


def test_issue_38_a_key_that_is_relative_to_one_of_a_side_is_turned_as_the_basis_is(human, swelling):
    """A pair that is exact already stays; Select Asymmetric agrees."""
    places, symmetry = positions(human.data), module("stored_map").load(human.data)
    image = lambda moved: symmetry.carry_displacement(places, moved, Merge.SWAP)  # noqa: E731
    _key(human, "Puff.L", 20 * swelling)
    _key(human, "Puff.R", image(20 * swelling))
    _key(human, "Fist.R", image(swelling), relative_to="Puff.R")
    _key(human, "Fist.L", swelling, relative_to="Puff.L")
    ops.mirror_shape_keys()
    assert np.abs(_moved(human, "Fist.R") - image(swelling)).max() < 1e-5
    bpy.ops.object.mode_set(mode="EDIT")
    ops.select_asymmetric(what="KEY", threshold=1e-4)
    assert not len(selected(human))
