"""The Windows build under Wine: the C programs through the DLL and the static library, the command line, maps as on Linux."""

from __future__ import annotations

import shutil
import subprocess

import pytest
from cargo import WORK
from conftest import compile_program, linux_map, mesh
from link import WINDOWS_LIBRARIES
from runners import Runner, add_stand_in
from targets import WINDOWS

BUILT = WORK / WINDOWS.name


@pytest.fixture(scope="session")
def windows(tmp_path_factory: pytest.TempPathFactory) -> Runner:
    folder = tmp_path_factory.mktemp("windows")
    for name in ("intrinsym.exe", "intrinsym.dll"):
        shutil.copy(BUILT / name, folder)
    add_stand_in(folder)
    return Runner(WINDOWS, folder)


def detect(windows: Runner, *arguments: object) -> subprocess.CompletedProcess:
    return windows.run(windows.folder / "intrinsym.exe", "detect", *arguments)


def test_programs_run_with_the_dll(windows: Runner, test_program: tuple[str, str, list[str]]) -> None:
    name, language, meshes = test_program
    program = windows.folder / f"{name}.exe"
    compile_program(WINDOWS, name, language, program, BUILT / "intrinsym.lib")
    done = windows.run(program, *map(mesh, meshes))
    assert done.returncode == 0, done.stderr.decode()


def test_a_program_runs_with_the_static_library(windows: Runner) -> None:
    libraries = [f"-l{name}" for name in ("stdc++", *WINDOWS_LIBRARIES)]
    output = windows.folder / "use_static.exe"
    compile_program(WINDOWS, "use", "c", output, "-DISYM_STATIC", BUILT / "libintrinsym.a", *libraries)
    done = windows.run(output, mesh("human"), mesh("blob"))
    assert done.returncode == 0, done.stderr.decode()


@pytest.mark.parametrize("name", ["human", "human_shells", "quadruped"])
def test_maps_are_those_of_linux(windows: Runner, name: str) -> None:
    output = windows.folder / f"{name}.map"
    done = detect(windows, mesh(name), "--map", output, "--quiet")
    assert done.returncode == 0, done.stderr.decode()
    assert output.read_bytes() == linux_map(name, windows.folder).read_bytes()


def test_paths_have_backslashes_and_other_alphabets(windows: Runner) -> None:
    folder = windows.folder / "Übung 対称"
    folder.mkdir()
    shutil.copy(mesh("quadruped"), folder / "Löwe.ply")
    done = detect(windows, r"Übung 対称\Löwe.ply", "--output-dir", r"Übung 対称\результат", "--write", "map,ply,json,png")
    assert done.returncode == 0, done.stderr.decode()
    written = {path.name for path in (folder / "результат").iterdir()}
    assert written == {f"Löwe.{ending}" for ending in ("map", "ply", "json", "png")}
    done = detect(windows, r"Übung 対称\Löwe.ply", "-o", r"Übung 対称\löwe.PLY")
    assert done.returncode == 2 and "Löwe.ply" in done.stderr.decode()


def test_mistakes_are_named(windows: Runner) -> None:
    done = detect(windows, "no such.ply")
    assert done.returncode == 2 and b"no such.ply" in done.stderr
