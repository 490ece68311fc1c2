# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the extension's zip with the wheel inside, one for each platform, and lets Blender's own tool validate it.

usage: python build_extension.py WHEEL... OUTPUT_FOLDER     (a Python that has the package bpy; one wheel a platform)
"""

import re
import shutil
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE / "intrinsic_symmetry"
CARGO = HERE.parent / "Cargo.toml"

#: Platform tag of a wheel, how it begins and ends, to Blender's name of the platform.
PLATFORMS = {
    ("manylinux", "x86_64"): "linux-x64",
    ("manylinux", "aarch64"): "linux-arm64",
    ("macosx", "arm64"): "macos-arm64",
    ("macosx", "x86_64"): "macos-x64",
    ("win", "amd64"): "windows-x64",
    ("win", "arm64"): "windows-arm64",
}


def version():
    return re.search(r'^version = "(.*)"', CARGO.read_text(), re.MULTILINE)[1]


def platform(wheel):
    tag = wheel.stem.split("-")[-1]
    for (system, machine), name in PLATFORMS.items():
        if tag.startswith(system) and tag.endswith(machine):
            return name
    raise SystemExit(f"build_extension: Blender has no platform for {wheel.name}")


def blender_tool():
    """Blender's own command for extensions, of the bpy that is installed."""
    found = list(Path(find_spec("bpy").origin).parent.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))
    if not found:
        raise SystemExit("build_extension: this bpy has no tool for extensions")
    return found[0]


def stage(wheels, folder):
    """The extension's folder as it goes into the zips."""
    shutil.copytree(SOURCE, folder, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(HERE / "LICENSE", folder)
    (folder / "wheels").mkdir()
    for wheel in wheels:
        shutil.copy(wheel, folder / "wheels")
    platforms = ", ".join(f'"{platform(wheel)}"' for wheel in wheels)
    files = ", ".join(f'"./wheels/{wheel.name}"' for wheel in wheels)
    manifest = folder / "blender_manifest.toml"
    added = [f'version = "{version()}"', f"platforms = [{platforms}]", f"wheels = [{files}]"]
    manifest.write_text(manifest.read_text() + "\n".join(added) + "\n")


def main():
    *wheels, output = [Path(argument).resolve() for argument in sys.argv[1:]]
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "intrinsic_symmetry"
        stage(wheels, folder)
        tool = [sys.executable, blender_tool()]
        build = [*tool, "build", "--split-platforms", "--source-dir", folder, "--output-dir", output]
        subprocess.run(build, check=True, stdout=subprocess.DEVNULL)
        for wheel in wheels:
            file = output / f"intrinsic_symmetry-{version()}-{platform(wheel).replace('-', '_')}.zip"
            subprocess.run([*tool, "validate", file], check=True)
            print(file)


if __name__ == "__main__":
    main()
