"""Writes out/release: every file of a release, for all targets that this machine can build.

usage: make_release.py [--only-build] [TARGET...]
Targets are linux-x86_64, windows-x86_64, linux-aarch64, macos-arm64 and macos-x86_64; all by default. --only-build leaves
the program and the libraries in build/release/TARGET, for tests, and packs nothing.
BLENDER_PYTHON_WITH_BPY, if set, is a Python that has the package bpy: the Blender extension is made with it.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import archive
import cargo
import link
import pack
from notices import write_bom, write_third_party, write_notes
from targets import TARGETS, Target, missing

#: The target whose program runs here, and writes the manual for all.
HERE = f"linux-{os.uname().machine}"


class Built(NamedTuple):
    """What was compiled for a target."""

    target: Target
    program: Path
    shared: Path
    static: Path


def wanted(names: list[str]) -> list[Target]:
    unknown = set(names) - {target.name for target in TARGETS}
    if unknown:
        raise SystemExit(f"make_release: no such target: {', '.join(sorted(unknown))}")
    chosen = [target for target in TARGETS if not names or target.name in names]
    # First, because it writes the manual.
    return sorted(chosen, key=lambda target: target.name != HERE)


def compile(target: Target) -> Built:
    """Compiles and links into build/release/TARGET."""
    compiled = cargo.build(target)
    folder = pack.fresh(cargo.WORK / target.name)
    program = Path(shutil.copy(compiled / target.program, folder))
    return Built(target, program, link.shared_library(target, compiled, folder), link.static_library(target, compiled, folder))


def pack_all(built: Built, manual: Path) -> Path:
    """Packs the files of a target; answers its wheel."""
    if built.target.name == HERE:
        pack.write_manual(built.program, manual)
    pack.command_line(built.target, built.program, manual if manual.is_dir() else None)
    pack.c_library(built.target, built.shared, built.static)
    return pack.wheel(built.target, built.shared, built.program)


def compile_all(targets: list[Target]) -> tuple[list[Built], list[str]]:
    """Compiles target after target; answers what was built, and what is missing, in words."""
    built, lacking = [], []
    for target in targets:
        reason = missing(target)
        if reason:
            lacking.append(f"target {target.name} is missing: {reason}")
            print(f"make_release: {lacking[-1]}", flush=True)
            continue
        start = time.monotonic()
        built.append(compile(target))
        print(f"make_release: {target.name}: {time.monotonic() - start:.0f} s", flush=True)
    return built, lacking


def blender_extension(wheels: list[Path]) -> str | None:
    """One zip a platform, by Blender's own tool; or what is missing."""
    python = os.environ.get("BLENDER_PYTHON_WITH_BPY")
    if not python:
        return "Blender extension is missing: no Python with bpy (make blender-extension)"
    folder = pack.fresh(cargo.WORK / "blender")
    link.run(python, cargo.ROOT / "blender_addon" / "build_extension.py", *wheels, folder)
    for zipped in folder.glob("*.zip"):
        archive.zip_again(zipped, pack.OUT / zipped.name)
    return None


def meshlab_plugin(built: list[Built]) -> str | None:
    """The plugin around the library of this machine's target, with the licences of what is linked; or what is missing."""
    here = next((one for one in built if one.target.name == HERE), None)
    if here is None:
        return f"MeshLab plugin is missing: it is built with {HERE}"
    if subprocess.run(["make", "meshlab-plugin"], cwd=cargo.ROOT, env=os.environ | {"INTRINSYM_LIBRARY": str(here.static)}).returncode:
        return "MeshLab plugin is missing: make meshlab-plugin"
    folder = next(path for path in (cargo.ROOT / "out" / "meshlab").iterdir() if path.is_dir())
    write_third_party(here.target, folder)
    archive.zip(folder, pack.OUT / f"{folder.name}.zip")
    return None


def release(built: list[Built], lacking: list[str]) -> None:
    """Packs all, and says what is there and what is not."""
    pack.fresh(pack.OUT)
    wheels = [pack_all(one, cargo.WORK / "manual") for one in built]
    lacking += [line for line in (blender_extension(wheels), meshlab_plugin(built)) if line]
    write_bom([one.target for one in built], pack.OUT / f"intrinsym-{link.version()}.cdx.json")
    write_notes(pack.OUT / "RELEASE_NOTES.md", lacking)
    archive.write_sums(pack.OUT)
    for path in sorted(pack.OUT.iterdir()):
        print(f"{path.stat().st_size / 1e6:8.2f} MB  {path.name}")
    for line in lacking:
        print(f"make_release: {line}")


def main() -> None:
    names = [name for name in sys.argv[1:] if name != "--only-build"]
    built, lacking = compile_all(wanted(names))
    if "--only-build" not in sys.argv:
        release(built, lacking)


if __name__ == "__main__":
    main()
