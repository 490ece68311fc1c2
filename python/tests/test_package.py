"""The package against the header, the version, and a clean virtual environment."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import venv
from pathlib import Path
from typing import Literal, get_args, get_origin

import pytest
from conftest import EXAMPLES, ROOT

import intrinsym
from intrinsym import _library, errors
from intrinsym.report import ReasonName

HEADER = (ROOT / "include" / "isym.h").read_text()


def test_every_function_of_the_header_is_declared_with_its_parameters():
    declared = {name: len(parameters) for name, parameters in _library.CHECKED.items()}
    declared |= {name: len(parameters) for name, (_, parameters) in _library.UNCHECKED.items()}
    in_header = {}
    for name, parameters in re.findall(r"^\w[\w *]*?(isym_\w+)\(([^)]*)\);", HEADER, re.MULTILINE):
        in_header[name] = 0 if parameters.strip() in ("", "void") else parameters.count(",") + 1
    assert len(in_header) > 40
    assert declared == in_header


def test_numbers_of_errors_kinds_and_merges_are_those_of_the_header():
    numbers = {name: int(number) for name, number in re.findall(r"^ +(ISYM_\w+) = (\d+),$", HEADER, re.MULTILINE)}
    ours = {f"ISYM_{name}": getattr(errors, name) for name in dir(errors) if name.startswith("ERROR_")}
    ours |= {f"ISYM_KIND_{kind.name}": int(kind) for kind in intrinsym.SymmetryKind}
    ours |= {f"ISYM_MERGE_{merge.name}": int(merge) for merge in intrinsym.Merge}
    assert ours.items() <= numbers.items()
    assert len([name for name in numbers if name.startswith(("ISYM_KIND_", "ISYM_MERGE_"))]) == 6


def test_the_reasons_are_those_of_the_library():
    source = (ROOT / "src" / "verify" / "reason.rs").read_text()
    (body,) = re.findall(r"pub enum Reason \{\n(.*?)\n\}", source, re.DOTALL)
    names = re.findall(r"^    (\w+)(?: \{|,)", body, re.MULTILINE)
    assert [re.sub("(?<!^)([A-Z])", r"_\1", name).lower() for name in names] == list(get_args(ReasonName))


def test_the_version_is_that_of_the_crate():
    version = re.search(r'^version = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.MULTILINE)[1]
    assert intrinsym.__version__ == version


def test_public_names_are_documented():
    for name in intrinsym.__all__:
        thing = getattr(intrinsym, name)
        assert isinstance(thing, str) or get_origin(thing) is Literal or (thing.__doc__ or "").strip(), name


FIVE_LINES = """
import sys, intrinsym
mesh = intrinsym.Mesh.read(sys.argv[1])
found = mesh.detect()
print(found[0].partner.shape[0], intrinsym.library_path())
"""


def test_the_wheel_works_in_a_clean_environment(tmp_path):
    wheels = list((ROOT / "out" / "wheels").glob("intrinsym-*.whl"))
    if len(wheels) != 1:
        pytest.fail(f"one wheel is needed, found {wheels}: make wheel")
    venv.create(tmp_path / "venv", with_pip=True)
    python = tmp_path / "venv" / "bin" / "python"
    hidden = {"PYTHONPATH", "LD_LIBRARY_PATH", intrinsym.ENVIRONMENT_VARIABLE}
    environment = {name: value for name, value in os.environ.items() if name not in hidden}
    install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", str(wheels[0])]
    subprocess.run(install, check=True, env=environment)
    run = subprocess.run(
        [python, "-c", FIVE_LINES, EXAMPLES / "quadruped.ply"],
        check=True, env=environment, cwd=tmp_path, capture_output=True, text=True,
    )  # fmt: skip
    count, library = run.stdout.split()
    assert count == "3398"
    assert Path(library).is_relative_to(tmp_path)
    program = tmp_path / "venv" / "bin" / "intrinsym"
    run = subprocess.run(
        [program, "detect", EXAMPLES / "quadruped.ply", "--map", "map", "--output", "paired.ply"],
        env=environment, cwd=tmp_path, capture_output=True, text=True,
    )  # fmt: skip
    assert run.returncode == 0 and len((tmp_path / "map").read_text().splitlines()) == 3398, run.stderr
    version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout
    assert version.split()[-1] == intrinsym.__version__
    batch = tmp_path / "venv" / "bin" / "intrinsym-batch"
    run = subprocess.run([batch, "x", "--output", "y"], env=environment, capture_output=True, text=True)
    assert run.returncode == 2 and 'pip install "intrinsym[ray]"' in run.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="reads the loader's table of Linux")
def test_the_wheel_needs_no_openmesh():
    maps = Path("/proc/self/maps").read_text().splitlines()
    loaded = {Path(line.split()[-1]) for line in maps if ".so" in line}
    ours = intrinsym.library_path()
    assert ours in loaded
    if intrinsym.ENVIRONMENT_VARIABLE in os.environ or ours.is_relative_to(ROOT / "target"):
        pytest.skip("runs from a build, not from the wheel")
    assert not [path for path in loaded if "OpenMesh" in path.name]
