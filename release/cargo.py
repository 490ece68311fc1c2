"""Compiles the command line and the static library of one target."""

from __future__ import annotations

import os
import subprocess
from functools import cache
from pathlib import Path

from targets import GLIBC, MACOS, MINGW, Target, rust_folder

ROOT = Path(__file__).resolve().parent.parent
WORK = ROOT / "build" / "release"
#: Libraries of MinGW that a program of ours holds inside.
MINGW_STATIC = ["libstdc++.a", "libpthread.a", "libwinpthread.a", "libgcc_eh.a"]


def answer(*command: object) -> str:
    """What a command prints."""
    return subprocess.run([str(part) for part in command], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


@cache
def commit_time() -> int:
    """Seconds since 1970: the only time that stands in the files."""
    return int(answer("git", "log", "-1", "--format=%ct"))


@cache
def openmesh() -> Path:
    return Path(answer(ROOT / "scripts" / "get_openmesh.sh"))


def _renamed_folders() -> list[tuple[Path, str]]:
    """No folder of this machine stands in a file."""
    cargo = Path(os.environ.get("CARGO_HOME", Path.home() / ".cargo"))
    return [(ROOT, "/intrinsym"), (cargo, "/cargo"), (rust_folder(), "/rust")]


def _static_mingw() -> Path:
    """A folder of static libraries alone: the linker takes the first folder that has a library at all."""
    folder = WORK / "mingw"
    folder.mkdir(parents=True, exist_ok=True)
    for name in MINGW_STATIC:
        link = folder / name
        link.unlink(missing_ok=True)
        link.symlink_to(Path(answer(f"{MINGW}-g++-posix", f"-print-file-name={name}")).resolve())
    # Relative, so that the files do not depend on where the checkout lies.
    return folder.relative_to(ROOT)


def _rust_flags(target: Target) -> list[str]:
    flags = [f"--remap-path-prefix={old}={new}" for old, new in _renamed_folders()]
    if target.system == "windows":
        flags += ["-L", f"native={_static_mingw()}"]
    return flags


def environment(target: Target) -> dict[str, str]:
    """The variables of a build."""
    c_flags = " ".join(f"-ffile-prefix-map={old}={new}" for old, new in _renamed_folders())
    variables = os.environ | {
        "CARGO_TARGET_DIR": str(WORK / "target"),
        "CARGO_INCREMENTAL": "0",
        # A tenth smaller, and not slower. With more units, searches for nearest neighbours are not inlined and cost a sixth more.
        "CARGO_PROFILE_RELEASE_LTO": "fat",
        "CARGO_PROFILE_RELEASE_CODEGEN_UNITS": "1",
        "CARGO_ENCODED_RUSTFLAGS": "\x1f".join(_rust_flags(target)),
        "CFLAGS": c_flags,
        "CXXFLAGS": c_flags,
        "OPENMESH_SOURCE": str(openmesh()),
        "SOURCE_DATE_EPOCH": str(commit_time()),
    }
    if target.system == "windows":
        triple = target.triple.replace("-", "_")
        variables |= {f"CC_{triple}": f"{MINGW}-gcc-posix", f"CXX_{triple}": f"{MINGW}-g++-posix"}
        variables[f"CARGO_TARGET_{triple.upper()}_LINKER"] = f"{MINGW}-gcc-posix"
    if target.system == "macos":
        # To strip a signed file breaks its signature.
        variables |= {"MACOSX_DEPLOYMENT_TARGET": MACOS, "CARGO_PROFILE_RELEASE_STRIP": "false"}
    return variables


def build(target: Target) -> Path:
    """Compiles; answers the folder with the program and libintrinsym.a."""
    command = "build" if target.zig is None else "zigbuild"
    triple = f"{target.triple}.{GLIBC}" if target.system == "linux" else target.triple
    packages = ["-p", "intrinsym-capi", "-p", "intrinsym-cli", "--lib", "--bins"]
    arguments = ["cargo", command, "--release", "--locked", "--target", triple, *packages]
    subprocess.run(arguments, cwd=ROOT, env=environment(target), check=True)
    for package in ("capi", "openmesh-sys"):
        # zig leaves an empty file where it was asked to try something.
        (ROOT / package / "a.o").unlink(missing_ok=True)
    return WORK / "target" / target.triple / "release"
