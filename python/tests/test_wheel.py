"""The wheel needs nothing newer than its tag says, and one that does is refused."""

import os
import platform
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from conftest import ROOT
from elftools.elf.elffile import ELFFile

import intrinsym

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="glibc is Linux's")

#: What a system of 2018 has (RHEL 8: glibc 2.28, GCC 8).
NEWEST = {"GLIBC": (2, 28), "GLIBCXX": (3, 4, 25), "CXXABI": (1, 3, 11), "GCC": (8, 0, 0)}
LIBRARY = "intrinsym/lib/libintrinsym.so"
PROGRAM = f"intrinsym-{intrinsym.__version__}.data/scripts/intrinsym"
#: Bytes of the largest wheel.
LARGEST = 6_000_000
PLATFORM = f"manylinux_2_28_{platform.machine()}"


@pytest.fixture(scope="module")
def wheel():
    (found,) = (ROOT / "out" / "wheels").glob("intrinsym-*.whl")
    return found


def test_it_is_tagged_for_glibc_2_28(wheel):
    assert wheel.name.endswith(f"-py3-none-{PLATFORM}.whl")


def test_it_is_small(wheel):
    assert wheel.stat().st_size <= LARGEST


@pytest.mark.parametrize("built", [LIBRARY, PROGRAM])
def test_no_symbol_is_newer(wheel, tmp_path, built):
    extracted = zipfile.ZipFile(wheel).extract(built, tmp_path)
    with open(extracted, "rb") as file:
        needed = ELFFile(file).get_section_by_name(".gnu.version_r")
        names = [version.name for _, versions in needed.iter_versions() for version in versions]
    assert any(name.startswith("GLIBC_") for name in names)
    for name in names:
        kind, numbers = name.split("_", 1)
        assert tuple(map(int, numbers.split("."))) <= NEWEST[kind], name


def test_a_wheel_that_needs_a_newer_glibc_is_refused(wheel, tmp_path):
    source, library = tmp_path / "newer.c", tmp_path / "libintrinsym.so"
    source.write_text("#include <pthread.h>\nint newer(pthread_t thread) { return pthread_detach(thread); }\n")
    compile = [sys.executable, "-m", "ziglang", "cc", "-target", f"{platform.machine()}-linux-gnu.2.34"]
    subprocess.run([*compile, "-shared", "-fPIC", source, "-o", library], check=True)
    changed = tmp_path / wheel.name
    with zipfile.ZipFile(wheel) as old, zipfile.ZipFile(changed, "w") as new:
        for name in old.namelist():
            new.writestr(name, library.read_bytes() if name == LIBRARY else old.read(name))
    tools = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    repair = ["auditwheel", "repair", "--plat", PLATFORM, "--wheel-dir", tmp_path / "out", changed]
    run = subprocess.run(repair, env=tools, capture_output=True, text=True)
    assert run.returncode != 0
    assert "too-recent versioned symbols" in " ".join(run.stderr.split()), run.stderr
