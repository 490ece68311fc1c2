"""A mesh that crashes, hangs or takes all memory is a row with its error, and the next mesh is none the worse."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import EXAMPLES, open_gate, wait_for, worker_at, write_mesh
from hooks import said

from intrinsym._isolated import Limits, MeshProcess
from intrinsym._mesh_row import row_of_file

FAST = {"threads": 1, "effort": "fast"}


@pytest.fixture(scope="module")
def process():
    made = MeshProcess(Limits(seconds=20, memory=500))
    yield made
    made.stop()


def row(process: MeshProcess, path: Path) -> dict:
    return process.row(str(path), path.name, FAST)


@pytest.mark.parametrize(
    ("word", "kind", "text"),
    [
        ("crash", "Crash", "the library crashed (SIGSEGV); please report it with the mesh"),
        ("hungry", "Memory", "the mesh needs more memory than one mesh may take"),
    ],
)
def test_a_death_is_a_row_and_the_next_mesh_is_answered(process, tmp_path, word, kind, text):
    found = row(process, write_mesh(tmp_path / f"{word}-1.ply", 1))
    assert (found["outcome"], found["error_kind"], found["error"]) == ("error", kind, text)
    assert row(process, write_mesh(tmp_path / "fine.ply", 2))["outcome"] == "found"


def test_a_hang_is_ended(tmp_path):
    process = MeshProcess(Limits(seconds=0.5, memory=500))
    found = row(process, write_mesh(tmp_path / "hang.ply", 1))
    assert process._running is None
    assert (found["error_kind"], found["error"]) == ("Timeout", "no answer within 0.5 s")


def test_the_library_out_of_memory_is_a_row():
    process = MeshProcess(Limits(seconds=60, memory=3))
    found = process.row(str(EXAMPLES / "blob.ply"), "blob.ply", FAST)
    assert found["error_kind"] == "Memory"
    process.stop()


def test_a_process_that_somebody_kills_is_tried_again(process, tmp_path, signals):
    path = write_mesh(tmp_path / f"killed-{tmp_path.name}.ply", 2)
    assert row(process, path)["outcome"] == "found"
    assert said(str(path), "killed").exists()


def test_a_process_that_ends_between_meshes_is_nobodys_fault(process, tmp_path):
    path = write_mesh(tmp_path / "fine.ply", 2)
    assert row(process, path)["outcome"] == "found"
    process._running._process.terminate()
    process._running._process.wait()
    assert row(process, path)["outcome"] == "found"


def test_the_answer_is_that_of_a_plain_call(process, tmp_path):
    path = write_mesh(tmp_path / "fine.ply", 2)
    found, plain = row(process, path), row_of_file(str(path), path.name, FAST)
    assert found.pop("seconds") > 0 and plain.pop("seconds") > 0
    assert found.keys() == plain.keys() and found["outcome"] == "found"
    assert all(np.array_equal(found[key], plain[key]) for key in found)


def test_errors_name_the_mesh_and_not_its_copy(process, tmp_path):
    (tmp_path / "copy.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 x\n3 0 1 2\n")
    found = process.row(str(tmp_path / "copy.off"), "s3://scans/bad.off", FAST)
    assert found["error_kind"] == "MeshFileError"
    assert found["error"].startswith("s3://scans/bad.off: line 5")


OWNER = """
import sys
from intrinsym._isolated import Limits, MeshProcess
MeshProcess(Limits(600, 500)).row(sys.argv[1], sys.argv[1], {})
"""


def test_the_process_ends_with_its_owner_in_the_middle_of_a_mesh(tmp_path):
    path = write_mesh(tmp_path / f"gate-{tmp_path.name}.ply", 1)
    owner = subprocess.Popen([sys.executable, "-c", OWNER, path])
    assert worker_at(path) == owner.pid
    (child,) = children_of(owner.pid)
    owner.send_signal(signal.SIGKILL)
    owner.wait()
    wait_for(lambda: not Path(f"/proc/{child}").exists(), "the process has ended")
    open_gate(path)


def children_of(parent: int) -> list[int]:
    return [int(word) for word in Path(f"/proc/{parent}/task/{parent}/children").read_text().split()]


def test_a_library_that_is_missing_is_said(tmp_path, monkeypatch):
    monkeypatch.setenv("INTRINSYM_LIBRARY", str(tmp_path / "none.so"))
    with pytest.raises(RuntimeError, match="none.so"):
        row(MeshProcess(Limits(20, 500)), write_mesh(tmp_path / "fine.ply", 2))
