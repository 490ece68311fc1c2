"""The build for 64-bit Arm under qemu: the C programs, and maps as near to the truth as those of x86-64."""

from __future__ import annotations

import math
import shutil
import struct
from pathlib import Path

import pytest
from cargo import WORK
from conftest import EXAMPLES, compile_program, linux_map, mesh, read_map
from link import version
from runners import Runner
from targets import TARGETS

TARGET = next(target for target in TARGETS if target.name == "linux-aarch64")
BUILT = WORK / TARGET.name
#: Partners may differ where two are almost as near: vectors of another width add in another order.
LARGEST_SHARE_THAT_DIFFERS = 0.02
LARGEST_RATIO_OF_ERRORS = 1.02


@pytest.fixture(scope="session")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Runner:
    return Runner(TARGET, tmp_path_factory.mktemp("arm"))


def test_programs_run(arm: Runner, test_program: tuple[str, str, list[str]]) -> None:
    name, language, meshes = test_program
    output = arm.folder / name
    shutil.copy(BUILT / TARGET.shared, arm.folder / f"{TARGET.shared}.{version().split('.')[0]}")
    linked = [BUILT / TARGET.shared, f"-Wl,-rpath,{arm.folder}", "-lm", "-lpthread"]
    compile_program(TARGET, name, language, output, "-DOTHER_CXX_LIBRARY", *linked)
    done = arm.run(output, *map(mesh, meshes))
    assert done.returncode == 0, done.stderr.decode()


def positions(path: Path) -> list[tuple[float, ...]]:
    """Of the vertices of a binary PLY that begins with three floats for each, as the examples do."""
    data = path.read_bytes()
    header, body = data.split(b"end_header\n", 1)
    count = int(header.split(b"element vertex ")[1].split()[0])
    return list(struct.iter_unpack("<3f", body[: 12 * count]))


def mean_error(name: str, partners: list[int]) -> float:
    """Mean distance of the partners from the true ones, where both exist."""
    places, truth = positions(mesh(name)), read_map(EXAMPLES / f"{name}.mirror")
    pairs = [(one, other) for one, other in zip(partners, truth) if one >= 0 and other >= 0]
    assert len(pairs) > 0.9 * len(truth)
    return sum(math.dist(places[one], places[other]) for one, other in pairs) / len(pairs)


@pytest.mark.parametrize("name", ["human", "human_shells", "quadruped"])
def test_maps_are_near_to_those_of_this_machine(arm: Runner, name: str) -> None:
    output = arm.folder / f"{name}.map"
    done = arm.run(BUILT / "intrinsym", "detect", mesh(name), "--map", output, "--quiet")
    assert done.returncode == 0, done.stderr.decode()
    here, there = read_map(linux_map(name, arm.folder)), read_map(output)
    assert len(here) == len(there)
    share = sum(one != other for one, other in zip(here, there)) / len(here)
    print(f"{name}: {share:.2%} of the partners differ")
    assert share <= LARGEST_SHARE_THAT_DIFFERS
    assert mean_error(name, there) <= LARGEST_RATIO_OF_ERRORS * mean_error(name, here)
