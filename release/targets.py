"""The targets of a release: what each is called, and what it needs."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

#: The oldest systems that the files run on. glibc 2.28 is of 2018, and what Blender asks for.
GLIBC = "2.28"
MACOS = "11.0"
#: How the programs of MinGW begin.
MINGW = "x86_64-w64-mingw32"


@dataclass(frozen=True)
class Target:
    """One system on one processor."""

    #: In the names of the files.
    name: str
    #: Rust's name.
    triple: str
    #: The platform tag of the wheel.
    wheel: str
    #: The built library, as cargo names it.
    shared: str
    #: zig's name, or None where Debian's MinGW compiles.
    zig: str | None

    @property
    def system(self) -> str:
        return self.name.split("-")[0]

    @property
    def machine(self) -> str:
        return self.triple.split("-")[0]

    @property
    def program(self) -> str:
        return "intrinsym.exe" if self.system == "windows" else "intrinsym"


def _linux(machine: str) -> Target:
    return Target(
        name=f"linux-{machine}",
        triple=f"{machine}-unknown-linux-gnu",
        wheel=f"manylinux_{GLIBC.replace('.', '_')}_{machine}",
        shared="libintrinsym.so",
        zig=f"{machine}-linux-gnu.{GLIBC}",
    )


def _macos(machine: str, python: str) -> Target:
    return Target(
        name=f"macos-{python}",
        triple=f"{machine}-apple-darwin",
        wheel=f"macosx_{MACOS.replace('.', '_')}_{python}",
        shared="libintrinsym.dylib",
        zig=f"{machine}-macos.{MACOS}",
    )


WINDOWS = Target("windows-x86_64", "x86_64-pc-windows-gnu", "win_amd64", "intrinsym.dll", None)

TARGETS = [_linux("x86_64"), WINDOWS, _linux("aarch64"), _macos("aarch64", "arm64"), _macos("x86_64", "x86_64")]


@cache
def rust_folder() -> Path:
    """Where the Rust toolchain lies."""
    command = ["rustc", "--print", "sysroot"]
    return Path(subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip())


def missing(target: Target) -> str | None:
    """What this machine lacks for a target, in words, or None."""
    if not (rust_folder() / "lib/rustlib" / target.triple / "lib").is_dir():
        return f"Rust's standard library (rustup target add {target.triple})"
    if target.zig is None:
        compiler = f"{MINGW}-g++-posix"
        return None if shutil.which(compiler) else f"{compiler} (Debian's g++-mingw-w64-x86-64-posix)"
    if find_spec("ziglang") is None or shutil.which("cargo-zigbuild") is None:
        return "zig and cargo-zigbuild (release/requirements.txt)"
    return None
