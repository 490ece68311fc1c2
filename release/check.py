"""Unpacks each archive of out/release on its own, inspects the files, and runs their first commands where this machine can.

usage: check.py     Exit status 1 if anything is not as it must be.
"""

from __future__ import annotations

import shlex
import shutil
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

from inspect_files import faults
from link import run, version
from pack import NATIVE, OUT
from runners import Runner, add_stand_in, compiler, what_is_missing
from targets import TARGETS, Target

#: The most that a file may have, in millions of bytes.
LARGEST_PROGRAM = 9.0
LARGEST_WHEEL = 6.0
USE_PYTHON = "import intrinsym, sys; print(intrinsym.Mesh.read(sys.argv[1]).detect().outcome)"


def _size(path: Path, largest: float) -> list[str]:
    size = path.stat().st_size / 1e6
    return [f"{path.name} has {size:.1f} MB, more than {largest:.0f}"] if size > largest else []


def _run(runner: Runner, *command: object) -> list[str]:
    done = runner.run(*command)
    return [] if done.returncode == 0 else [f"{Path(str(command[0])).name} ends with {done.returncode}: {done.stderr.decode()[-500:]}"]


def _commands(target: Target, folder: Path) -> list[str]:
    program = folder / target.program
    wrong = faults(program, is_library=False) + _size(program, LARGEST_PROGRAM)
    if what_is_missing(target):
        return wrong
    if target.system == "windows":
        add_stand_in(folder)
    wrong += _run(Runner(target, folder), program, "detect", "human.ply", "-o", "paired.ply", "--picture", "paired.png")
    return wrong + [f"{name} was not written" for name in ("paired.ply", "paired.png") if not (folder / name).is_file()]


def _library(target: Target, folder: Path) -> list[str]:
    """The shared library is what it must be; the example links with it, and with the static one, and runs."""
    shared = folder / ("bin" if target.system == "windows" else "lib") / target.shared
    wrong = faults(shared, is_library=True)
    linked = {
        "shared": [folder / "lib" / "intrinsym.lib"] if target.system == "windows" else [shared, f"-Wl,-rpath,{shared.parent}"],
        "static": [folder / "lib" / "libintrinsym.a", *[f"-l{name}" for name in NATIVE[target.system]]],
    }
    if target.system == "linux":
        # gcc brings the unwinder by itself, zig does not.
        linked["static"].append("-lunwind")
    for kind, libraries in linked.items():
        program = folder / f"detect_{kind}.exe"
        flags = ["-DISYM_STATIC"] if kind == "static" else []
        source = folder / "examples" / "detect.c"
        run(*compiler(target, "c"), *flags, "-I", folder / "include", source, "-o", program, *libraries)
        if not what_is_missing(target):
            wrong += _run_example(target, folder, program)
    return wrong


def _run_example(target: Target, folder: Path, program: Path) -> list[str]:
    if target.system == "windows":
        shutil.copy(folder / "bin" / target.shared, folder)
        add_stand_in(folder)
    return _run(Runner(target, folder), program, _example())


def _example() -> Path:
    return Path(__file__).resolve().parent.parent / "examples" / "human.ply"


def _by_cmake(target: Target, folder: Path) -> list[str]:
    """The commands of README.txt, as they stand there."""
    lines = (folder / "README.txt").read_text().splitlines()
    commands = [line.strip() for line in lines if line.startswith("    ")]
    run("sh", "-e", "-c", "\n".join([f"cd {shlex.quote(str(folder))}", *commands]))
    return _run(Runner(target, folder), folder / "build" / "detect", _example())


def _wheel(target: Target, path: Path, folder: Path) -> list[str]:
    wrong = faults(folder / "intrinsym" / "lib" / target.shared, is_library=True) + _size(path, LARGEST_WHEEL)
    if not _runs_as_it_is(target):
        return wrong
    venv.create(folder / "venv", with_pip=True)
    python = folder / "venv" / "bin" / "python"
    run(python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", path)
    return wrong + _run(Runner(target, folder), python, "-c", USE_PYTHON, _example())


def _runs_as_it_is(target: Target) -> bool:
    return not what_is_missing(target) and not Runner(target, OUT).prefix


def check(target: Target, folder: Path) -> list[str]:
    """What is wrong with the files of a target, in words; nothing where it was not built."""
    wrong = []
    for prefix, test in (("intrinsym", _commands), ("intrinsym-c", _library)):
        name = f"{prefix}-{version()}-{target.name}"
        for packed in OUT.glob(f"{name}.*"):
            shutil.unpack_archive(packed, folder)
            wrong += [f"{packed.name}: {line}" for line in test(target, folder / name)]
    if _runs_as_it_is(target) and (folder / name).is_dir():
        wrong += _by_cmake(target, folder / name)
    for path in OUT.glob(f"*-{target.wheel}.whl"):
        shutil.unpack_archive(path, folder / "wheel", "zip")
        wrong += [f"{path.name}: {line}" for line in _wheel(target, path, folder / "wheel")]
    return wrong


def main() -> int:
    subprocess.run(["sha256sum", "--quiet", "--check", "SHA256SUMS"], cwd=OUT, check=True)
    found = []
    for target in TARGETS:
        if not list(OUT.glob(f"*-{target.name}.*")):
            continue
        with tempfile.TemporaryDirectory() as folder:
            wrong = check(target, Path(folder))
        found += wrong
        state = what_is_missing(target)
        print(f"{target.name}: {'; '.join(wrong) or 'as it must be'}; {f'built, not run: {state}' if state else 'run'}", flush=True)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
