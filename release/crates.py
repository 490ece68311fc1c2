"""What a target's files are linked of: Rust crates, and libraries of C++."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from importlib.metadata import version as installed_version
from pathlib import Path

from cargo import ROOT, answer, openmesh
from targets import Target, rust_folder

#: How files with a licence's text begin.
LICENCE_NAMES = ("license", "licence", "copying", "notice", "unlicense", "copyright")
OWN = ["intrinsym", "openmesh-sys", "intrinsym-capi", "intrinsym-cli"]


@dataclass(frozen=True)
class Component:
    """A piece of software that is linked."""

    name: str
    version: str
    #: SPDX.
    licence: str
    #: Files with its terms; none where its authors ship none.
    texts: tuple[Path, ...]
    #: Its package URL.
    purl: str


@cache
def _manifests() -> dict[tuple[str, str], dict]:
    packages = json.loads(answer("cargo", "metadata", "--format-version", "1", "--locked"))["packages"]
    return {(package["name"], package["version"]): package for package in packages}


def _texts(folder: Path) -> tuple[Path, ...]:
    files = [path for path in sorted(folder.iterdir()) if path.is_file()]
    return tuple(path for path in files if path.name.lower().startswith(LICENCE_NAMES))


def _crate(name: str, version: str) -> Component:
    manifest = _manifests()[name, version]
    # Older manifests write a slash for OR.
    licence = (manifest["license"] or "NOASSERTION").replace("/", " OR ")
    texts = _texts(Path(manifest["manifest_path"]).parent)
    return Component(name, version, licence, texts, f"pkg:cargo/{name}@{version}")


@cache
def crates(target: Target) -> list[Component]:
    """The crates that are linked, ours left out."""
    lines = answer("cargo", "tree", "--locked", "--target", target.triple, "--edges", "normal,no-proc-macro", "--prefix", "none",
                   "--package", "intrinsym-cli", "--package", "intrinsym-capi", "--format", "{p}").splitlines()
    pairs = {tuple(line.split()[:2]) for line in lines if line.strip()}
    return [_crate(name, version.lstrip("v")) for name, version in sorted(pairs) if name not in OWN]


def _openmesh() -> Component:
    source = openmesh()
    version = answer("pkg-config", "--modversion", "openmesh")
    return Component("OpenMesh", version, "BSD-3-Clause", (source / "LICENSE",), f"pkg:generic/openmesh@{version}")


def _rust() -> Component:
    version = answer("rustc", "--version").split()[1]
    texts = tuple(path for path in [rust_folder() / "share/doc/rust/COPYRIGHT-library.html"] if path.is_file())
    return Component("Rust standard library", version, "MIT OR Apache-2.0", texts, f"pkg:generic/rust-std@{version}")


def _zigs_libraries() -> Component:
    zig = Path(find_spec("ziglang").origin).parent
    texts = tuple(zig / "lib" / name / "LICENSE.TXT" for name in ("libcxx", "libcxxabi", "libunwind"))
    version = installed_version("ziglang")
    licence = "Apache-2.0 WITH LLVM-exception"
    return Component("LLVM libc++, libc++abi, libunwind (of zig)", version, licence, texts, f"pkg:pypi/ziglang@{version}")


def _debian(package: str, title: str, licence: str, folder: str) -> Component:
    version = answer("dpkg-query", "-W", "-f", "${Version}", package)
    text = Path("/usr/share/doc") / folder / "copyright"
    return Component(title, version, licence, (text,), f"pkg:deb/debian/{package}@{version}")


def _mingw() -> list[Component]:
    exception = "GPL-3.0-or-later WITH GCC-exception-3.1"
    return [
        _debian("g++-mingw-w64-x86-64-posix", "GCC's libstdc++ and libgcc", exception, "g++-mingw-w64-x86-64-posix"),
        _debian("mingw-w64-x86-64-dev", "mingw-w64 run time and winpthreads", "ZPL-2.1 AND MIT", "mingw-w64-x86-64-dev"),
    ]


def libraries(target: Target) -> list[Component]:
    """What is linked beside crates."""
    return [_openmesh(), _rust()] + ([_zigs_libraries()] if target.zig else _mingw())


def components(target: Target) -> list[Component]:
    return libraries(target) + crates(target)
