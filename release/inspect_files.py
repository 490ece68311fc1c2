"""What a built file says of itself: the functions that it gives, the libraries and the system that it asks for."""

from __future__ import annotations

import re
from pathlib import Path

import lief

from link import functions
from targets import GLIBC, MACOS

#: Libraries that every system has.
SYSTEM = {
    "linux": r"(libc\.so\.6|libm\.so\.6|libpthread\.so\.0|libdl\.so\.2|ld-linux[-\w]*\.so\.\d)",
    "windows": r"(?i)(advapi32|bcrypt|bcryptprimitives|dbghelp|kernel32|msvcrt|ntdll|userenv|ws2_32|api-ms-win-[-\w]*)\.dll",
    "macos": r"/usr/lib/lib(System\.B|charset\.1|iconv\.2)\.dylib",
}


def faults(path: Path, is_library: bool) -> list[str]:
    """What is wrong with a program or shared library, in words."""
    binary = lief.parse(str(path))
    if isinstance(binary, lief.ELF.Binary):
        return _elf(binary, is_library)
    if isinstance(binary, lief.PE.Binary):
        return _pe(binary, is_library)
    if isinstance(binary, lief.MachO.FatBinary):
        binary = binary.at(0)
    return _macho(binary, is_library) if isinstance(binary, lief.MachO.Binary) else ["its format is not known"]


def _foreign(libraries: list[str], system: str) -> list[str]:
    return [f"asks for {name}" for name in libraries if not re.fullmatch(SYSTEM[system], name)]


def _exports(names: set[str], is_library: bool) -> list[str]:
    if not is_library:
        return []
    header = set(functions())
    return [f"lacks {name}" for name in sorted(header - names)] + [f"also gives {name}" for name in sorted(names - header)]


def _release(text: str) -> tuple[int, ...]:
    return tuple(int(part) for part in text.split("."))


def _elf(binary: lief.ELF.Binary, is_library: bool) -> list[str]:
    wanted = [entry.name for version in binary.symbols_version_requirement for entry in version.get_auxiliary_symbols()]
    glibc = [name.removeprefix("GLIBC_") for name in wanted if re.fullmatch(r"GLIBC_[\d.]+", name)]
    newer = [f"asks for glibc {name}" for name in glibc if _release(name) > _release(GLIBC)]
    given = {symbol.name for symbol in binary.exported_symbols}
    return newer + _foreign(binary.libraries, "linux") + _exports(given, is_library)


def _pe(binary: lief.PE.Binary, is_library: bool) -> list[str]:
    given = {entry.name for entry in binary.get_export().entries} if binary.has_exports else set()
    return _foreign([entry.name for entry in binary.imports], "windows") + _exports(given, is_library)


def _macho(binary: lief.MachO.Binary, is_library: bool) -> list[str]:
    oldest = ".".join(str(part) for part in binary.build_version.minos[:2])
    wrong = [] if oldest == MACOS else [f"asks for macOS {oldest}"]
    # On Intel macOS starts programs without.
    if binary.header.cpu_type == lief.MachO.Header.CPU_TYPE.ARM64 and not binary.has_code_signature:
        wrong.append("is not signed")
    libraries = [library.name for library in binary.libraries if not library.name.startswith("@rpath/")]
    given = {symbol.name.removeprefix("_") for symbol in binary.exported_symbols}
    return wrong + _foreign(libraries, "macos") + _exports(given, is_library)
