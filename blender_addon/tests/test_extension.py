# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip: its manifest, what it installs, and that it goes away."""

import re
import tomllib
import zipfile

import bpy
from conftest import MODULE, ROOT, extension_zip, install, module


def _manifest():
    with zipfile.ZipFile(extension_zip()) as file:
        return tomllib.loads(file.read("blender_manifest.toml").decode()), file.namelist()


def test_the_manifest():
    manifest, names = _manifest()
    cargo = re.search(r'^version = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.MULTILINE)[1]
    assert manifest["version"] == cargo
    assert manifest["blender_version_min"] == "4.2.0"
    assert manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    assert list(manifest["permissions"]) == ["files"]  # no network
    assert [wheel.removeprefix("./") for wheel in manifest["wheels"]] == [n for n in names if n.endswith(".whl")]
    assert not [name for name in names if "__pycache__" in name or "tests" in name]


def test_the_library_comes_from_the_wheel():
    import intrinsym

    manifest, _ = _manifest()
    assert intrinsym.library_version() == manifest["version"]
    assert bpy.utils.user_resource("EXTENSIONS") in str(intrinsym.library_path())


def test_every_operator_has_a_poll_and_can_be_undone():
    operators = [getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("INTRINSIC_SYMMETRY_OT_")]
    assert len(operators) >= 12
    for operator in operators:
        assert "UNDO" in operator.bl_options and "REGISTER" in operator.bl_options, operator
        assert operator.poll and operator.__doc__, operator


def test_options_are_the_library_s():
    import intrinsym

    preferences = bpy.context.preferences.addons[MODULE].preferences
    for spec in intrinsym.option_specs():
        about = preferences.bl_rna.properties[spec.name]
        if spec.choices:
            assert tuple(item.identifier for item in about.enum_items) == spec.choices
            assert getattr(preferences, spec.name) == spec.choices[spec.default]
            continue
        # A default of 0 below the minimum follows from the effort.
        least = min(spec.default, spec.minimum)
        assert (about.default, about.hard_min, about.hard_max) == (spec.default, least, spec.maximum)
        assert getattr(preferences, spec.name) == spec.default


def test_it_can_be_disabled_and_enabled():
    bpy.ops.preferences.addon_disable(module=MODULE)
    assert not hasattr(bpy.types, "INTRINSIC_SYMMETRY_OT_detect")
    assert not hasattr(bpy.types.Mesh, "intrinsic_symmetry_eigenfunctions")
    bpy.ops.preferences.addon_enable(module=MODULE)
    assert hasattr(bpy.types, "INTRINSIC_SYMMETRY_OT_detect")


def test_it_can_be_uninstalled():
    repositories = bpy.context.preferences.extensions.repos
    index = next(i for i, repository in enumerate(repositories) if repository.module == "user_default")
    bpy.ops.extensions.package_uninstall(repo_index=index, pkg_id="intrinsic_symmetry")
    assert not hasattr(bpy.types, "INTRINSIC_SYMMETRY_OT_detect")
    install()
    assert module("ops_detect") and hasattr(bpy.types, "INTRINSIC_SYMMETRY_OT_detect")
