"""intrinsym-batch on a cluster of two nodes: every mesh gets its row, once, whatever is killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import (
    assert_same_as_command_line,
    batch_command,
    copy_examples,
    open_gate,
    rows_in,
    wait_for,
    without_times,
    worker_at,
    write_mesh,
)

from intrinsym.ray import _command
from intrinsym.ray._command import main


def test_rows_maps_and_summary(batch, meshes, tmp_path, command_line):
    copy_examples(meshes)
    paths = sorted(meshes.iterdir())
    output = tmp_path / "out"
    done = batch(meshes, "--output", output, "--write", "map,ply")
    assert done.stderr == ""
    folder, rows = command_line(paths), rows_in(output)
    assert sorted(rows) == [path.name for path in paths]
    for path in paths:
        assert_same_as_command_line(rows[path.name], folder)
        ours = (output / f"maps/{path}.map").read_bytes()
        assert ours == (folder / f"{path.stem}.map").read_bytes()
    summary = json.loads((output / "summary.json").read_text())
    assert summary["meshes"] == summary["new_rows"] == len(paths) == sum(summary["outcomes"].values())
    assert summary["errors"] == {} and 0 < summary["seconds"]["p50"] <= summary["seconds"]["p100"]
    assert f"{len(paths)} meshes: " in done.stdout and Path(summary["rows"]).is_dir()
    assert list((output / ".staging").iterdir()) == []


def test_a_ply_is_read_back_with_its_attributes(batch, tmp_path):
    path = write_mesh(tmp_path / "in.ply", 2)
    batch(path, "--output", tmp_path / "out", "--write", "ply")
    written = (tmp_path / f"out/ply/{path}.ply").read_bytes()
    header, _, body = written.partition(b"end_header\n")
    for line in (b"int sym_vertex", b"float sym_confidence", b"int sym_side", b"uchar red"):
        assert b"property " + line in header
    (row,) = rows_in(tmp_path / "out").values()
    again = tmp_path / "again.ply"
    again.write_bytes(written)
    assert len(body) == row["vertices"] * (24 + 12 + 3) + row["faces"] * 16
    batch(again, "--output", tmp_path / "out2")
    (second,) = rows_in(tmp_path / "out2").values()
    assert second["partner"] == row["partner"]


def test_the_second_run_has_nothing_to_do(batch, meshes, tmp_path):
    output = tmp_path / "out"
    batch(meshes, "--output", output)
    first, files = rows_in(output), sorted(output.glob("rows/*/*"))
    done = batch(meshes, "--output", output)
    assert "0 new rows" in done.stdout
    assert rows_in(output) == first and sorted(output.glob("rows/*/*")) == files


def test_two_runs_give_the_same_rows(batch, meshes, tmp_path):
    for name in ("one", "two"):
        batch(meshes, "--output", tmp_path / name)
    assert without_times(rows_in(tmp_path / "one")) == without_times(rows_in(tmp_path / "two"))


def test_poison_takes_nothing_with_it(batch, meshes, tmp_path):
    """Crashes, hangs, too much memory, a broken file and a missing one are rows, and stay so."""
    for word in ("crash", "hang", "hungry"):
        write_mesh(meshes / f"{word}-1.ply", 2)
    (meshes / "broken.off").write_text("OFF\n3 1 0\n0 0 0\n")
    (tmp_path / "list.txt").write_text("\n".join(map(str, [*meshes.iterdir(), meshes / "missing.ply"])))
    output = tmp_path / "out"
    batch(tmp_path / "list.txt", "--output", output, "--timeout", 8, "--memory", 300)
    rows = rows_in(output)
    kinds = {name: row["error_kind"] for name, row in rows.items() if row["outcome"] == "error"}
    assert kinds == {
        "crash-1.ply": "Crash",
        "hang-1.ply": "Timeout",
        "hungry-1.ply": "Memory",
        "broken.off": "MeshFileError",
        "missing.ply": "Unreadable",
    }
    assert len(rows) == 12 + 5
    summary = json.loads((output / "summary.json").read_text())
    assert summary["outcomes"]["error"] == 5 and summary["errors"]["Crash"] == 1
    again = batch(tmp_path / "list.txt", "--output", output, "--timeout", 8, "--memory", 300)
    assert "1 new rows" in again.stdout, "only the file that could not be read is looked at again"
    batch(tmp_path / "list.txt", "--output", output, "--timeout", 4, "--again", "Timeout")
    assert rows_in(output)["hang-1.ply"]["error"] == "no answer within 4 s"
    assert without_times(rows_in(output)).keys() == rows.keys()


def test_an_unknown_kind_of_error_is_refused(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["meshes", "--output", "out", "--again", "Timeot"])
    assert ended.value.code == 2 and "'Timeot' is none of Unreadable, Timeout," in capsys.readouterr().err


def test_without_an_address_no_other_ray_is_joined(monkeypatch):
    asked = {}
    monkeypatch.delenv("RAY_ADDRESS", raising=False)
    monkeypatch.setattr(_command.ray, "is_initialized", lambda: False)
    monkeypatch.setattr(_command.ray, "init", lambda address, **_: asked.update(address=address))
    monkeypatch.setattr(_command.ray, "shutdown", lambda: None)
    monkeypatch.setattr(_command, "_run", lambda *_: {})
    main(["meshes", "--output", "out", "--quiet"])
    assert asked == {"address": "local"}


def test_a_killed_worker_loses_nothing(cluster, batch, meshes, gated, tmp_path):
    output = tmp_path / "out"
    with running(batch_command(cluster, meshes, "--output", output)) as process:
        os.kill(worker_at(gated), signal.SIGKILL)
        open_gate(gated)
        assert process.wait(90) == 0
    assert_undisturbed(batch, meshes, output, tmp_path)


def test_a_killed_node_loses_nothing(cluster, batch, meshes, gated, tmp_path):
    output = tmp_path / "out"
    with running(batch_command(cluster, meshes, "--output", output)) as process:
        raylet = parent_of(worker_at(gated))
        (node,) = (node for node in cluster.worker_nodes if raylet_of(node) == raylet)
        cluster.remove_node(node, allow_graceful=False)
        open_gate(gated)
        assert process.wait(90) == 0
    cluster.add_node(num_cpus=1)
    cluster.wait_for_nodes()
    assert_undisturbed(batch, meshes, output, tmp_path)


def test_a_killed_driver_is_resumed(cluster, batch, meshes, gated, tmp_path):
    output = tmp_path / "out"
    with running(batch_command(cluster, meshes, "--output", output)) as process:
        worker = worker_at(gated)
        # One worker waits at the gate with its block; the other one does all the rest.
        wait_for(lambda: len(rows_in(output)) >= 9, "the other blocks are committed")
        process.kill()
        process.wait()
    before = rows_in(output)
    wait_for(lambda: not Path(f"/proc/{worker}").exists(), "Ray has ended the driver's workers")
    open_gate(gated)
    command = batch_command(cluster, meshes, "--output", output)
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    after = rows_in(output)
    assert f"{len(after) - len(before)} new rows" in done.stdout and done.stderr == ""
    assert {name: after[name] for name in before} == before
    assert_undisturbed(batch, meshes, output, tmp_path)


def assert_undisturbed(batch, meshes: Path, output: Path, tmp_path: Path) -> None:
    """The rows are those of a run in which nothing was killed."""
    batch(meshes, "--output", tmp_path / "calm")
    rows = rows_in(output)
    assert len(rows) == 13
    assert without_times(rows) == without_times(rows_in(tmp_path / "calm"))


def test_what_has_changed_is_done_again_and_replaced(batch, meshes, tmp_path):
    output = tmp_path / "out"
    batch(meshes, "--output", output)
    before = rows_in(output)
    write_mesh(meshes / "lobed-3.ply", 103)
    write_mesh(meshes / "new.ply", 104)
    (meshes / "lobed-4.ply").rename(meshes / "lobed-4-moved.ply")
    assert "3 new rows" in batch(meshes, "--output", output).stdout
    after = rows_in(output)
    assert after["lobed-3.ply"]["content_hash"] != before["lobed-3.ply"]["content_hash"]
    assert after["lobed-4-moved.ply"]["partner"] == before["lobed-4.ply"]["partner"]
    same = before.keys() - {"lobed-3.ply"}
    assert {name: after[name] for name in same} == {name: before[name] for name in same}
    assert len(after) == len(before) + 2


def test_other_options_and_files_that_are_missing(batch, meshes, tmp_path):
    output = tmp_path / "out"
    batch(meshes, "--output", output, "--samples", 200)
    assert "12 new rows" in batch(meshes, "--output", output, "--samples", 300).stdout
    assert len(list(output.glob("rows/options=*"))) == 2
    assert "0 new rows" in batch(meshes, "--output", output, "--samples", 200, "--timeout", 50).stdout
    assert "12 new rows" in batch(meshes, "--output", output, "--samples", 200, "--write", "map").stdout
    (output / f"maps/{meshes}/lobed-3.ply.map").unlink()
    assert "1 new rows" in batch(meshes, "--output", output, "--samples", 200, "--write", "map").stdout


def test_a_part_that_cannot_be_read_is_made_again(batch, meshes, tmp_path):
    output = tmp_path / "out"
    batch(meshes, "--output", output)
    before = without_times(rows_in(output))
    part = max(output.glob("rows/*/*.parquet"), key=lambda path: path.stat().st_size)
    part.write_bytes(part.read_bytes()[:-20])
    batch(meshes, "--output", output)
    assert without_times(rows_in(output)) == before


def test_a_second_command_keeps_off(cluster, batch, meshes, gated, tmp_path):
    output = tmp_path / "out"
    with running(batch_command(cluster, meshes, "--output", output)) as process:
        worker_at(gated)
        refused = batch(meshes, "--output", output, status=2)
        assert "another intrinsym-batch works on this folder" in refused.stderr
        open_gate(gated)
        assert process.wait(90) == 0
    assert len(rows_in(output)) == 13


@pytest.mark.client
def test_through_a_ray_client(cluster, meshes, tmp_path):
    port = cluster.head_node._ray_params.ray_client_server_port
    words = batch_command(
        cluster, meshes, "--output", tmp_path / "out", "--address", f"ray://127.0.0.1:{port}"
    )
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == ""
    assert "12 new rows" in done.stdout
    assert len(rows_in(tmp_path / "out")) == 12
    none = subprocess.run([*words, "--samples", "7"], capture_output=True, text=True)
    assert none.returncode == 2 and none.stderr.startswith("intrinsym-batch: option samples")


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["none.ply"], "none.ply: no such file or folder"),
        (["--samples", "7"], "option samples"),
        (["--timeout", "0"], "0 is not above 0"),
        (["--write", "png"], "'png' is none of map, ply"),
    ],
)
def test_what_is_wrong_is_said(batch, meshes, tmp_path, words, text):
    assert text in batch(meshes, *words, "--output", tmp_path / "out", status=2).stderr


NO_RAY = """
import sys
sys.modules["ray"] = None
from intrinsym._batch import main
sys.exit(main())
"""


def test_without_ray_it_says_what_to_install():
    done = subprocess.run([sys.executable, "-c", NO_RAY], capture_output=True, text=True)
    assert done.returncode == 2
    assert (
        done.stderr
        == 'intrinsym-batch: intrinsym.ray needs Ray, which is not installed: pip install "intrinsym[ray]"\n'
    )


def running(command: list[str]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(command, stdout=subprocess.DEVNULL)


def parent_of(process: int) -> int:
    return int(Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[1])


def raylet_of(node) -> int:
    return node.all_processes["raylet"][0].process.pid
