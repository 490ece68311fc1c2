"""A cluster of two nodes on this machine, small meshes, and what the command line says of them."""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
EXAMPLES = ROOT / "examples"
BINARY = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "intrinsym"

sys.path.insert(0, str(ROOT))
# For the processes of Ray, too, which take them from the one that starts it.
os.environ["PYTHONPATH"] = os.pathsep.join([str(HERE), os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep)
os.environ["INTRINSYM_TEST_HOOK"] = "hooks:before_mesh"
os.environ["RAY_USAGE_STATS_ENABLED"] = "0"

import pyarrow as pa  # noqa: E402
import pyarrow.parquet as pq  # noqa: E402
import ray  # noqa: E402
from hooks import FOLDER, said  # noqa: E402
from ray.cluster_utils import Cluster  # noqa: E402

from evaluation.lobed import lobed, write_ply  # noqa: E402
from intrinsym.ray._command import main  # noqa: E402

#: Options of every run here.
FAST = ("--effort", "fast")
#: Seconds that anything may take before a test gives up.
PATIENCE = 90.0
#: Columns that two runs of the same meshes need not share.
TIMES = ("seconds",)


def wait_for(condition: Callable[[], object], what: str) -> None:
    """Waits until something holds; fails the test if it does not come."""
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            pytest.fail(f"not within {PATIENCE:g} s: {what}")
        time.sleep(0.02)


def worker_at(mesh: Path) -> int:
    """The process of Ray that works on a mesh called gate-..., once it does."""
    wait_for(said(str(mesh), "reached").exists, f"{mesh.name} is worked on")
    return int(said(str(mesh), "reached").read_text())


def open_gate(mesh: Path) -> None:
    """Lets a mesh called gate-... go on, for good."""
    said(str(mesh), "open").touch()


@pytest.fixture(scope="session", autouse=True)
def signals(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of hooks.said."""
    folder = tmp_path_factory.mktemp("signals")
    os.environ[FOLDER] = str(folder)
    return folder


def free_port() -> int:
    """A port of this machine that nobody listens to."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture(scope="session")
def cluster(signals: Path) -> Iterator[Cluster]:
    """A head without CPUs and two nodes with one each."""
    head = {
        "num_cpus": 0,
        "ray_client_server_port": free_port(),
        "_system_config": {"health_check_period_ms": 1000, "health_check_failure_threshold": 3},
    }
    made = Cluster(initialize_head=True, head_node_args=head)
    for _ in range(2):
        made.add_node(num_cpus=1)
    made.wait_for_nodes()
    yield made
    made.shutdown()


@pytest.fixture(scope="session")
def connected(cluster: Cluster) -> Iterator[Cluster]:
    """The cluster, with this process as a driver."""
    ray.init(address=cluster.address, log_to_driver=False, logging_level="error")
    ray.data.DataContext.get_current().enable_progress_bars = False
    yield cluster
    ray.shutdown()


@pytest.fixture
def meshes(tmp_path: Path) -> Path:
    """A folder with twelve meshes of a hundred vertices."""
    folder = tmp_path / "meshes"
    folder.mkdir()
    for seed in range(12):
        write_mesh(folder / f"lobed-{seed}.ply", seed)
    return folder


def write_mesh(path: Path, seed: int, rows: int = 8) -> Path:
    """A small mesh; more rows make a larger one."""
    write_ply(path, *lobed(seed, rows, 12))
    return path


@pytest.fixture
def gated(tmp_path: Path, meshes: Path) -> Path:
    """The largest of the meshes, which is begun first and stays until its gate is opened."""
    name = f"gate-{tmp_path.name}.ply"
    return write_mesh(meshes / name, 100, rows=12)


class Done(NamedTuple):
    """What intrinsym-batch left."""

    stdout: str
    stderr: str


@pytest.fixture
def batch(connected: Cluster, capfd: pytest.CaptureFixture[str]) -> Callable[..., Done]:
    """Runs intrinsym-batch in this process, which is a driver already."""

    def run(*words: object, status: int = 0) -> Done:
        capfd.readouterr()
        try:
            ended = main([*map(str, words), *FAST])
        except SystemExit as stop:
            ended = stop.code
        done = Done(*capfd.readouterr())
        assert ended == status, done
        return done

    return run


def batch_command(cluster: Cluster, *words: object) -> list[str]:
    """The words of intrinsym-batch as a process of its own."""
    given = [str(word) for word in words]
    address = [] if "--address" in given else ["--address", cluster.address]
    return [sys.executable, "-m", "intrinsym.ray", *given, *address, *FAST]


def rows_in(output: Path) -> dict[str, dict]:
    """All rows of a folder of results by the mesh's name; no mesh may have two."""
    files = sorted(output.glob("rows/options=*/*.parquet"))
    rows = [row for file in files for row in pq.ParquetFile(file).read().to_pylist()]
    found = {Path(row["path"]).name: row for row in rows}
    assert len(found) == len(rows)
    return found


def without_times(rows: dict[str, dict]) -> dict[str, dict]:
    """Rows without the columns of TIMES."""
    return {
        name: {key: value for key, value in row.items() if key not in TIMES} for name, row in rows.items()
    }


def by_name(table: pa.Table) -> dict[str, dict]:
    """Rows of a table by the mesh's name."""
    rows = table.to_pylist()
    assert len({row["path"] for row in rows}) == len(rows)
    return {Path(row["path"]).name: row for row in rows}


@pytest.fixture
def command_line(tmp_path: Path) -> Callable[[list[Path]], Path]:
    """Runs `intrinsym detect` over meshes, and gives back the folder of its maps, PLY files and reports."""

    def run(paths: list[Path]) -> Path:
        if not BINARY.is_file():
            pytest.fail(f"{BINARY} is missing: cargo build --release --bin intrinsym")
        folder = tmp_path / "command_line"
        words = [BINARY, "detect", *paths, "--output-dir", folder, *FAST, "--quiet"]
        subprocess.run([str(word) for word in words], capture_output=True)
        return folder

    return run


def assert_same_as_command_line(row: dict, folder: Path) -> None:
    """A row against what the command line wrote."""
    stem = Path(row["path"]).stem
    report = json.loads((folder / f"{stem}.json").read_text())
    partners = np.loadtxt(folder / f"{stem}.map", dtype=int, ndmin=1)
    assert row["outcome"] == report["outcome"]
    assert row["symmetries"] == len(report["symmetries"])
    if not report["symmetries"]:
        assert row["partner"] is None and (partners == -1).all()
        return
    best = report["symmetries"][0]
    assert np.array_equal(row["partner"], partners)
    for name in ("kind", "plausibility", "mean_confidence", "exact_share", "paired_share", "shells_paired"):
        assert str(row[name]).replace("_", " ") == str(best[name]).replace("_", " "), name


def copy_examples(folder: Path) -> list[Path]:
    """The example meshes with symmetries, without and with several shells."""
    return [
        Path(shutil.copy(EXAMPLES / f"{name}.ply", folder)) for name in ("human_shells", "quadruped", "blob")
    ]
