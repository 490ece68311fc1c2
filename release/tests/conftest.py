"""Runs what was built for another system: its C test programs, and its command line. Files lie in build/release."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from cargo import ROOT, WORK  # noqa: E402
from runners import compiler  # noqa: E402
from targets import Target  # noqa: E402

EXAMPLES = ROOT / "examples"
#: A test program, its language, and the meshes that it reads.
PROGRAMS = [
    ("use", "c", ["human", "blob"]),
    ("misuse", "c", ["quadruped"]),
    ("threads", "c", ["human", "quadruped"]),
    ("wrapper", "cpp", ["quadruped"]),
]


def mesh(name: str) -> Path:
    return EXAMPLES / f"{name}.ply"


def read_map(path: Path) -> list[int]:
    return [int(line) for line in path.read_text().split()]


def linux_map(name: str, folder: Path) -> Path:
    """The map that this machine's program writes."""
    output = folder / f"{name}.linux.map"
    subprocess.run([WORK / "linux-x86_64" / "intrinsym", "detect", mesh(name), "--map", output, "--quiet"], check=True)
    return output


def compile_program(target: Target, name: str, language: str, output: Path, *rest: object) -> None:
    """Compiles a program of tests/c; `rest` says what it is linked with."""
    standard = ["-x", "c", "-std=c11"] if language == "c" else ["-x", "c++", "-std=c++17"]
    source = ROOT / "tests" / "c" / f"{name}.{language}"
    folders = ["-I", ROOT / "include", "-I", ROOT / "cpp"]
    command = [*compiler(target, language), *standard, "-O1", "-Wall", "-Wextra", "-Werror", *folders, source, "-x", "none", "-o", output, *rest]
    subprocess.run([str(part) for part in command], check=True)


@pytest.fixture(params=PROGRAMS, ids=lambda program: program[0])
def test_program(request: pytest.FixtureRequest) -> tuple[str, str, list[str]]:
    return request.param
