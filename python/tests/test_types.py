"""What a type checker makes of the package, and of code that uses it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from conftest import ROOT

#: A user's program. Where a line is wrong, its comment is what the type checker says of it.
PROGRAM = """
from typing import assert_type
import intrinsym
found = intrinsym.detect([[0.0, 0, 0]], [[0, 0, 0]], effort="fast", network=False, symmetries=2)
assert_type(found, intrinsym.Detection)
assert_type(found[0], intrinsym.Symmetry)
assert_type(found[:2], list[intrinsym.Symmetry])
assert_type(found.report, intrinsym.Report)
assert_type(found.report.judged, intrinsym.Judgement | None)
assert_type(found[0].evidence.score, float)
intrinsym.detect([[0.0]], [[0]], effort="hard")  # arg-type
intrinsym.detect([[0.0]], [[0]], sampels=3)  # call-arg
intrinsym.Mesh.read("a.ply").detect(threads="two")  # arg-type
intrinsym.eigen([[0.0]], [[0]])  # call-arg
found.report.judged.plausibility  # union-attr
"""


def mypy(cache: Path, *arguments: object) -> str:
    package = ROOT / "python"
    command = [sys.executable, "-m", "mypy", "--config-file", package / "pyproject.toml", "--cache-dir", cache]
    return subprocess.run([*command, *map(str, arguments)], cwd=package, capture_output=True, text=True).stdout


def test_the_package_passes_strictly(tmp_path):
    said = mypy(tmp_path)
    assert said.startswith("Success"), said


def test_a_program_s_mistakes_are_seen_and_nothing_else(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    said = mypy(tmp_path / "cache", program)
    seen = {int(line): error for line, error in re.findall(r"program\.py:(\d+): error: .*\[([\w-]+)\]", said)}
    lines = enumerate(PROGRAM.splitlines(), 1)
    assert seen == {number: line.split("# ")[1] for number, line in lines if "# " in line}, said
