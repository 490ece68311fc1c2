"""The archives of one target: the command line, and the C library."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import archive
from cargo import ROOT, WORK
from link import WINDOWS_LIBRARIES, run, version
from notices import write_licences
from targets import Target

OUT = ROOT / "out" / "release"
SHELLS = {"bash": "intrinsym.bash", "zsh": "_intrinsym", "fish": "intrinsym.fish", "powershell": "_intrinsym.ps1"}
#: What a program links beside our static library.
NATIVE = {"linux": ["pthread", "m", "dl"], "macos": ["System"], "windows": ["stdc++", *WINDOWS_LIBRARIES]}
NOT_RUN = "This was built and inspected, but not run: no such machine was at hand. Please say how it goes.\n"
README = """Intrinsym {version} for {system}: the mirror image of every point of a mesh, along its surface.

{first}

Licences: LICENSE, and THIRD_PARTY.txt for what is linked.
{note}"""
FIRST_COMMANDS = """The first minute, in this folder:

    {program} detect human.ply -o paired.ply --picture paired.png
    {program} --help

Put {file} into a folder of your PATH to use it from anywhere."""
FIRST_LINK = """The interface is include/isym.h (C) and include/isym.hpp (C++17). examples/ is a complete program:

    cmake -S examples -B build -DCMAKE_PREFIX_PATH="$PWD"
    cmake --build build

Its program, detect in build, takes the path of a mesh."""


def fresh(folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def _write_readme(target: Target, folder: Path, first: str) -> None:
    note = "\n" + NOT_RUN if target.system == "macos" else ""
    text = README.format(version=version(), system=target.name, first=first, note=note)
    (folder / "README.txt").write_text(text)


def _pack(target: Target, folder: Path) -> Path:
    OUT.mkdir(parents=True, exist_ok=True)
    if target.system == "windows":
        output = OUT / f"{folder.name}.zip"
        archive.zip(folder, output)
    else:
        output = OUT / f"{folder.name}.tar.gz"
        archive.tar(folder, output)
    return output


def write_manual(program: Path, folder: Path) -> None:
    """Manual pages and completions, by a program that runs here."""
    for name in ("man", "completions"):
        fresh(folder / name)
    run(program, "manual", folder / "man")
    for shell, name in SHELLS.items():
        script = subprocess.run([program, "completions", shell], capture_output=True, check=True).stdout
        (folder / "completions" / name).write_bytes(script)


def command_line(target: Target, program: Path, manual: Path | None) -> Path:
    folder = fresh(WORK / target.name / f"intrinsym-{version()}-{target.name}")
    shutil.copy(program, folder)
    shutil.copy(ROOT / "examples" / "human.ply", folder)
    if manual:
        shutil.copytree(manual, folder, dirs_exist_ok=True)
    called = ".\\intrinsym" if target.system == "windows" else "./intrinsym"
    _write_readme(target, folder, FIRST_COMMANDS.format(program=called, file=program.name))
    write_licences(target, folder)
    return _pack(target, folder)


def _place_shared(target: Target, library: Path, folder: Path) -> dict[str, str]:
    """Copies the shared library to where its system looks; answers what the CMake package says of it."""
    if target.system == "windows":
        (folder / "bin").mkdir()
        shutil.copy(library, folder / "bin")
        # Of one content: Microsoft's linker looks for the first, MinGW's for the second.
        shutil.copy(library.with_name("intrinsym.lib"), folder / "lib")
        shutil.copy(library.with_name("intrinsym.lib"), folder / "lib" / "libintrinsym.dll.a")
        return {"SHARED": "../bin/intrinsym.dll", "SONAME": "", "IMPORT": "${intrinsym_folder}/intrinsym.lib"}
    if target.system == "macos":
        shutil.copy(library, folder / "lib")
        return {"SHARED": library.name, "SONAME": f"@rpath/{library.name}", "IMPORT": ""}
    soname = f"{library.name}.{version().split('.')[0]}"
    shutil.copy(library, folder / "lib" / f"{library.name}.{version()}")
    (folder / "lib" / soname).symlink_to(f"{library.name}.{version()}")
    (folder / "lib" / library.name).symlink_to(soname)
    return {"SHARED": soname, "SONAME": soname, "IMPORT": ""}


def c_library(target: Target, shared: Path, static: Path) -> Path:
    folder = fresh(WORK / target.name / f"intrinsym-c-{version()}-{target.name}")
    for name in ("include", "lib/pkgconfig"):
        (folder / name).mkdir(parents=True)
    for header in ("include/isym.h", "cpp/isym.hpp"):
        shutil.copy(ROOT / header, folder / "include")
    shutil.copytree(ROOT / "examples" / "c", folder / "examples")
    shutil.copy(static, folder / "lib")
    facts = _place_shared(target, shared, folder)
    facts |= {"SOURCE": str(ROOT), "OUT": str(folder), "VERSION": version(), "LIBRARIES": ";".join(NATIVE[target.system])}
    run("cmake", *[f"-D{name}={value}" for name, value in facts.items()], "-P", ROOT / "release" / "package.cmake")
    _write_readme(target, folder, FIRST_LINK)
    write_licences(target, folder)
    return _pack(target, folder)


def wheel(target: Target, shared: Path, program: Path) -> Path:
    """The Python package around the library and the program, from a copy of its folder."""
    folder = fresh(WORK / target.name / "wheel")
    shutil.copytree(ROOT / "python", folder / "python", ignore=shutil.ignore_patterns("lib", "bin", "build", "*.egg-info", "__pycache__"))
    shutil.copy(ROOT / "Cargo.toml", folder)
    library = folder / "python" / "src" / "intrinsym" / "lib"
    library.mkdir()
    shutil.copy(shared, library)
    write_licences(target, library)
    programs = folder / "python" / "bin"
    programs.mkdir()
    shutil.copy(program, programs)
    run(sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check", "--no-deps", "--no-build-isolation",
        f"--config-settings=--build-option=--plat-name={target.wheel}", "--wheel-dir", folder, folder / "python")
    built = next(folder.glob("*.whl"))
    OUT.mkdir(parents=True, exist_ok=True)
    archive.zip_again(built, OUT / built.name)
    return OUT / built.name
