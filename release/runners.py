"""Runs programs of another system on this machine: Windows' under Wine, Arm's under qemu. Compiles C programs for them."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from cargo import ROOT
from link import ZIG
from targets import MINGW, Target

WINE = "/usr/lib/wine/wine64"
QEMU = "qemu-aarch64-static"
#: Where Debian keeps the C library of 64-bit Arm.
ARM_LIBRARIES = "/usr/aarch64-linux-gnu"


class Runner:
    """What a target's programs run in, with a folder of its own."""

    def __init__(self, target: Target, folder: Path) -> None:
        self.folder = folder
        self.environment = dict(os.environ)
        self.prefix: list[str] = []
        if target.system == "windows":
            self.prefix = [WINE]
            self.environment |= {"WINEPREFIX": str(folder / "wine"), "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml="}
        elif target.machine != os.uname().machine:
            self.prefix = [QEMU, "-L", ARM_LIBRARIES]

    def run(self, *command: object, timeout: float = 600) -> subprocess.CompletedProcess:
        words = [*self.prefix, *map(str, command)]
        return subprocess.run(words, env=self.environment, cwd=self.folder, capture_output=True, timeout=timeout)


def what_is_missing(target: Target) -> str | None:
    """Why a target's programs cannot be run here, in words, or None."""
    if target.system == "macos":
        return "no such machine is at hand"
    if target.system == "windows":
        return None if Path(WINE).exists() else "Wine is missing (Debian's wine64)"
    if target.machine == os.uname().machine:
        return None
    there = shutil.which(QEMU) and Path(ARM_LIBRARIES).exists()
    return None if there else "qemu is missing (Debian's qemu-user-static and libc6-arm64-cross)"


def add_stand_in(folder: Path) -> None:
    """A library that Wine lacks before its release 9, beside a program of ours. See tests/bcryptprimitives.c."""
    source = ROOT / "release" / "tests" / "bcryptprimitives.c"
    command = [f"{MINGW}-gcc-posix", "-shared", "-o", folder / "bcryptprimitives.dll", source, "-ladvapi32"]
    subprocess.run([str(part) for part in command], check=True)


def compiler(target: Target, language: str) -> list[str]:
    """The command of a C or C++ compiler for a target."""
    if target.zig:
        return [*ZIG, "cc" if language == "c" else "c++", "-target", target.zig]
    return [f"{MINGW}-{'gcc' if language == 'c' else 'g++'}-posix", "-static"]
