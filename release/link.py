"""Links the C library of one target from what cargo has compiled: the header's functions and no other, no foreign library."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from cargo import ROOT, WORK, answer
from targets import MACOS, MINGW, Target, rust_folder

HEADER = ROOT / "include" / "isym.h"
ZIG = [sys.executable, "-m", "ziglang"]
#: Libraries of Windows that Rust's standard library calls (rustc --print native-static-libs).
WINDOWS_LIBRARIES = ["kernel32", "ntdll", "userenv", "ws2_32", "dbghelp", "bcrypt", "advapi32"]


def functions() -> list[str]:
    """The names of the header's functions."""
    return sorted(re.findall(r"^ISYM_API\s[^;(]*?\b(isym_\w+)\(", HEADER.read_text(), re.MULTILINE))


def run(*command: object, **variables: str) -> None:
    subprocess.run([str(part) for part in command], check=True, env=os.environ | variables)


def host() -> str:
    """Rust's name of this machine."""
    return next(line.split()[1] for line in answer("rustc", "-vV").splitlines() if line.startswith("host:"))


def version() -> str:
    return re.search(r'^version = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.MULTILINE)[1]


def shared_library(target: Target, built: Path, folder: Path) -> Path:
    """Links the shared library into a folder."""
    library = folder / target.shared
    {"linux": _linux, "windows": _windows, "macos": _macos}[target.system](target, built / "libintrinsym.a", library)
    return library


def _linux(target: Target, archive: Path, library: Path) -> None:
    exports = library.with_suffix(".map")
    exports.write_text("{ global: %s local: *; };\n" % " ".join(f"{name};" for name in functions()))
    soname = f"libintrinsym.so.{version().split('.')[0]}"
    run(*ZIG, "c++", "-target", target.zig, "-O2", "-shared", "-s", "-o", library, f"-Wl,-soname,{soname}",
        f"-Wl,--version-script={exports}", "-Wl,-z,defs", "-Wl,--gc-sections",
        *[f"-Wl,-u,{name}" for name in functions()], archive, "-lunwind", "-lm", "-lpthread", "-ldl")
    exports.unlink()


def _windows(target: Target, archive: Path, library: Path) -> None:
    exports = library.with_suffix(".def")
    exports.write_text(f"LIBRARY {library.name}\nEXPORTS\n" + "".join(f"    {name}\n" for name in functions()))
    run(f"{MINGW}-g++-posix", "-shared", "-static", "-s", "-o", library, "-Wl,--gc-sections", "-Wl,--no-insert-timestamp",
        *[f"-Wl,-u,{name}" for name in functions()], exports, archive, *[f"-l{name}" for name in WINDOWS_LIBRARIES])
    # What MinGW's and Microsoft's linkers read, to call the DLL.
    run(*ZIG, "dlltool", "-m", "i386:x86-64", "-d", exports, "-D", library.name, "-l", library.with_name("intrinsym.lib"))


def _macos(target: Target, archive: Path, library: Path) -> None:
    scratch = library.parent
    exports, system = scratch / "exports.txt", scratch / "libSystem.tbd"
    exports.write_text("".join(f"_{name}\n" for name in functions()))
    zig = Path(find_spec("ziglang").origin).parent
    # The linker knows this processor by one name, zig's list by others.
    listed = (zig / "lib/libc/darwin/libSystem.tbd").read_text()
    system.write_text(re.sub(r"arm64e(\.x1)?-", "arm64-", listed))
    machine = "arm64" if target.machine == "aarch64" else target.machine
    run(_tools() / "gcc-ld/ld64.lld", "-arch", machine, "-platform_version", "macos", MACOS, MACOS, "-dylib", "-o", library,
        "-install_name", f"@rpath/{library.name}", "-exported_symbols_list", exports, "-dead_strip", "-x",
        "-adhoc_codesign", archive, *cxx_archives(target), system)
    exports.unlink()
    system.unlink()


def cxx_archives(target: Target) -> list[str]:
    """zig's own C++ library for a target, as archives; zig says where it keeps them when it links."""
    source, output = WORK / "empty.cpp", WORK / "empty"
    source.write_text("")
    command = [*ZIG, "c++", "-target", target.zig, "-shared", "-s", "-O2", "--verbose", str(source), "-o", str(output)]
    words = subprocess.run(command, capture_output=True, text=True, check=True).stderr.split()
    return [word for word in dict.fromkeys(words) if Path(word).name in ("libc++.a", "libc++abi.a")]


def static_library(target: Target, built: Path, folder: Path) -> Path:
    """The static library with the C++ library inside, so that programs link nothing but their system's."""
    library = folder / "libintrinsym.a"
    {"linux": _one_object, "windows": _as_built, "macos": _with_cxx}[target.system](target, built / library.name, library)
    return library


def _as_built(_target: Target, archive: Path, library: Path) -> None:
    _objcopy("--strip-debug", archive, library)


def _one_object(target: Target, archive: Path, library: Path) -> None:
    """One object whose only names are the header's: zig's C++ library does not meet the program's own."""
    whole, names = library.with_suffix(".o"), library.with_suffix(".txt")
    names.write_text("".join(f"{name}\n" for name in functions()))
    emulation = {"x86_64": "elf_x86_64", "aarch64": "aarch64linux"}[target.machine]
    run(_tools() / "gcc-ld/ld.lld", "-m", emulation, "-r", "-o", whole, *[f"--undefined={name}" for name in functions()], archive,
        *cxx_archives(target))
    _objcopy("--strip-debug", f"--keep-global-symbols={names}", whole)
    _archive(library, whole)
    whole.unlink()
    names.unlink()


def _with_cxx(target: Target, archive: Path, library: Path) -> None:
    script = "".join(f"ADDLIB {part}\n" for part in [archive, *cxx_archives(target)])
    commands = f"CREATE {library}\n{script}SAVE\nEND\n"
    subprocess.run([*ZIG, "ar", "-M"], input=commands, text=True, check=True)


def _tools() -> Path:
    """The linkers and object tools that Rust brings: they know every target."""
    return rust_folder() / "lib/rustlib" / host() / "bin"


def _objcopy(*arguments: object) -> None:
    run(_tools() / "rust-objcopy", *arguments, LD_LIBRARY_PATH=str(rust_folder() / "lib"))


def _archive(library: Path, *members: Path) -> None:
    library.unlink(missing_ok=True)
    run(*ZIG, "ar", "rcsD", library, *members)
