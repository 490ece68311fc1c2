"""Many small meshes through two nodes of Ray, killed twice and resumed: `make evaluate-ray`.

    python -m evaluation.many_meshes [--program target/release/intrinsym] --out RESULTS.json --work FOLDER

Counts rows, compares each with what the command line says of its mesh, and measures what Ray costs beside the
command line with two jobs. The nodes are processes of this machine. Overhead is given in wall time, and in CPU
seconds of all processes, Ray's own included, which other work on the machine disturbs less.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shutil
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from datetime import date
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import ray
from ray.cluster_utils import Cluster

from intrinsym._isolated import Limits, MeshProcess
from intrinsym.ray._command import main as batch
from intrinsym.ray._rows import table_of

from .lobed import write_lobed
from .program import ANSWERS, identity, write_results

#: Rings and columns of the small meshes of 128 vertices, and of those of 12,476.
SMALL, LARGE = (10, 14), (100, 126)
#: Small meshes that are timed, large ones, and how often each.
#: Two numbers of large ones: what a run costs and what a mesh costs are told apart by them.
TIMED_SMALL, TIMED_LARGE, REPEATS = 1000, (60, 240), 3
#: What is killed in each run, and the share of the rows that are there by then.
KILLS = ([(0.25, "driver")], [(0.45, "node"), (0.65, "driver")], [])
#: Meshes whose costs are measured one by one.
COSTED = 20
OPTIONS = ["--effort", "fast"]
TICK = os.sysconf("SC_CLK_TCK")


def cluster_of_two() -> Cluster:
    """A head without CPUs and two nodes with one each."""
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0})
    for _ in range(2):
        cluster.add_node(num_cpus=1)
    cluster.wait_for_nodes()
    return cluster


def cpu_seconds() -> float:
    """CPU seconds of this process and of all that it has started, and they."""
    spent, parents = {}, {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        parents[int(folder.name)], spent[int(folder.name)] = int(fields[1]), sum(map(int, fields[11:15])) / TICK

    def ours(process: int | None) -> bool:
        return process == os.getpid() or (process in parents and ours(parents[process]))

    return sum(seconds for process, seconds in spent.items() if ours(process))


def command_line(program: Path, meshes: list[Path], folder: Path) -> dict[str, float]:
    """Runs the command line over meshes with two jobs; wall and CPU seconds."""
    shutil.rmtree(folder, ignore_errors=True)
    words = [
        program,
        "detect",
        *meshes,
        "--output-dir",
        folder,
        "--write",
        "map,json",
        "--jobs",
        "2",
        "--quiet",
        *OPTIONS,
    ]
    wall, cpu = time.perf_counter(), cpu_seconds()
    status = subprocess.run(list(map(str, words))).returncode
    if status not in ANSWERS:
        raise RuntimeError(f"{program} ended with {status}")
    return {"wall": time.perf_counter() - wall, "cpu": cpu_seconds() - cpu}


def with_ray(meshes: Path, folder: Path) -> dict[str, float]:
    """Runs intrinsym-batch over a list of meshes in this process; wall and CPU seconds, and those inside detections."""
    shutil.rmtree(folder, ignore_errors=True)
    wall, cpu = time.perf_counter(), cpu_seconds()
    if batch([str(meshes), "--output", str(folder), "--quiet", *OPTIONS]) != 0:
        raise RuntimeError("intrinsym-batch failed")
    spent = {"wall": time.perf_counter() - wall, "cpu": cpu_seconds() - cpu}
    summary = json.loads((folder / "summary.json").read_text())
    return spent | {"busy": summary["total_seconds"] / (2 * spent["wall"])}


def listed(meshes: list[Path], path: Path) -> Path:
    """Writes a list of meshes as intrinsym-batch takes it."""
    path.write_text("\n".join(map(str, meshes)))
    return path


def overhead(program: Path, meshes: list[Path], work: Path) -> dict:
    """Both ways in turns over the same meshes, with Ray's workers started before; medians, and all runs."""
    runs: dict[str, list] = {"command_line": [], "ray": []}
    given = listed(meshes, work / "timed.txt")
    with_ray(listed(meshes[:20], work / "warm.txt"), work / "timed")
    for _ in range(REPEATS):
        runs["command_line"].append(command_line(program, meshes, work / "timed"))
        runs["ray"].append(with_ray(given, work / "timed"))
    middle = {way: {key: statistics.median(run[key] for run in made) for key in made[0]} for way, made in runs.items()}
    ratio = {key: middle["ray"][key] / middle["command_line"][key] - 1 for key in ("wall", "cpu")}
    return {"meshes": len(meshes), "overhead": ratio, "medians": middle, "runs": runs}


def rows_in(folder: Path) -> Iterator[dict]:
    """The rows that are committed."""
    for part in sorted(folder.glob("rows/options=*/*.parquet")):
        yield from pq.ParquetFile(part).read().to_pylist()


def killed_twice(cluster: Cluster, meshes: Path, count: int, folder: Path) -> list[dict]:
    """Runs intrinsym-batch as a process once for each of KILLS; what each run did."""
    shutil.rmtree(folder, ignore_errors=True)
    words = [sys.executable, "-m", "intrinsym.ray", meshes, "--output", folder, "--address", cluster.address, *OPTIONS]
    history = []
    for kills in KILLS:
        before, start = count_rows(folder), time.perf_counter()
        process = subprocess.Popen(list(map(str, words)))
        for share, victim in kills:
            wait_for_rows(process, folder, int(share * count))
            if victim == "node":
                replace_node(cluster)
            else:
                process.send_signal(signal.SIGKILL)
        status = process.wait()
        seconds = round(time.perf_counter() - start, 1)
        done = {"killed": kills, "rows_before": before, "rows_after": count_rows(folder)}
        history.append(done | {"status": status, "seconds": seconds})
    return history


def count_rows(folder: Path) -> int:
    """How many rows are committed."""
    return sum(pq.read_metadata(part).num_rows for part in folder.glob("rows/options=*/*.parquet"))


def wait_for_rows(process: subprocess.Popen, folder: Path, count: int) -> None:
    """Waits until so many rows are committed. Raises RuntimeError if the process ends before."""
    while count_rows(folder) < count:
        if process.poll() is not None:
            raise RuntimeError(f"intrinsym-batch ended with {process.returncode} before it was killed")
        time.sleep(2)


def replace_node(cluster: Cluster) -> None:
    """Kills a node with all that runs on it, and starts another one."""
    cluster.remove_node(next(iter(cluster.worker_nodes)), allow_graceful=False)
    cluster.add_node(num_cpus=1)
    cluster.wait_for_nodes()


def compare(folder: Path, answers: Path, meshes: list[Path]) -> dict[str, int]:
    """Rows lost, doubled, and unlike what the command line wrote."""
    seen: dict[str, int] = {}
    unlike, outcomes = 0, {}
    for row in rows_in(folder):
        seen[row["path"]] = seen.get(row["path"], 0) + 1
        outcomes[row["outcome"]] = outcomes.get(row["outcome"], 0) + 1
        unlike += not is_like(row, answers / Path(row["path"]).stem)
    return {
        "meshes": len(meshes),
        "rows": sum(seen.values()),
        "lost": sum(str(mesh.resolve()) not in seen for mesh in meshes),
        "doubled": sum(times > 1 for times in seen.values()),
        "unlike_the_command_line": unlike,
        "outcomes": outcomes,
    }


def is_like(row: dict, answer: Path) -> bool:
    """Whether a row says what the command line wrote: outcome, map, plausibility, confidence."""
    report = json.loads(answer.with_suffix(".json").read_text())
    best = (report["symmetries"] or [None])[0]
    if row["outcome"] != report["outcome"] or row["symmetries"] != len(report["symmetries"]):
        return False
    if best is None:
        return row["partner"] is None
    same = all(row[key] == best[key] for key in ("plausibility", "mean_confidence", "exact_share"))
    return same and np.array_equal(row["partner"], np.loadtxt(answer.with_suffix(".map"), dtype=int))


def start_seconds(work: Path, mesh: Path) -> float:
    """Wall seconds of intrinsym-batch over one mesh with a Ray of its own: what starting costs."""
    shutil.rmtree(work / "one", ignore_errors=True)
    words = [sys.executable, "-m", "intrinsym.ray", mesh, "--output", work / "one", "--quiet", *OPTIONS]
    start = time.perf_counter()
    subprocess.run(list(map(str, words)), check=True)
    return time.perf_counter() - start


def costs(meshes: list[Path], work: Path) -> dict:
    """What a mesh takes in a worker's process, on one thread: CPU seconds by effort, bytes of Parquet for a vertex, MB of
    the process at its largest."""
    found: dict = {"meshes": len(meshes), "cpu_seconds": {}}
    for effort in ("fast", "default"):
        process = MeshProcess(Limits(600, 4000))
        job = {"threads": 1, "effort": effort}
        process.row(str(meshes[0]), "", job)
        cpu = cpu_seconds()
        rows = [process.row(str(mesh), mesh.name, job) for mesh in meshes]
        found["cpu_seconds"][effort] = (cpu_seconds() - cpu) / len(meshes)
        found["process_megabytes"] = peak_megabytes(process)
        process.stop()
        pq.write_table(table_of(rows), work / "costs.parquet", compression="zstd")
    found["vertices"] = rows[0]["vertices"]
    found["bytes_for_a_vertex"] = (work / "costs.parquet").stat().st_size / sum(row["vertices"] for row in rows)
    return found


def peak_megabytes(process: MeshProcess) -> float:
    """The most memory that the process had, in MB; all of it counts, what it shares with others too."""
    status = Path(f"/proc/{process._running._process.pid}/status").read_text()
    return next(int(line.split()[1]) for line in status.splitlines() if line.startswith("VmHWM:")) * 1024 / 1e6


def measure(program: Path, work: Path, count: int) -> dict:
    """Everything, in order; the nodes are ended at the end."""
    small = write_lobed(work / "small", count, *SMALL)
    large = write_lobed(work / "large", max(TIMED_LARGE), *LARGE)
    result: dict = {
        "date": str(date.today()),
        "program": identity(str(program)),
        "ray": ray.__version__,
        "machine": f"{platform.machine()}, {os.cpu_count()} CPUs, Python {platform.python_version()}",
        "options": OPTIONS,
        "start_seconds": start_seconds(work, small[0]),
        "costs": [costs(small[:COSTED], work), costs(large[:COSTED], work)],
    }
    print("the command line over all meshes", flush=True)
    result["command_line"] = command_line(program, small, work / "answers")
    cluster = cluster_of_two()
    try:
        print("killed twice and resumed", flush=True)
        result["killed_twice"] = killed_twice(cluster, listed(small, work / "all.txt"), count, work / "killed")
        result["compared"] = compare(work / "killed", work / "answers", small)
        result["bytes"] = sum(part.stat().st_size for part in (work / "killed").glob("rows/*/*.parquet"))
        print(json.dumps(result, indent=1), flush=True)
        ray.init(address=cluster.address, log_to_driver=False, logging_level="error")
        result["large_few"], result["large"] = (overhead(program, large[:count], work) for count in TIMED_LARGE)
        result["small"] = overhead(program, small[:TIMED_SMALL], work)
    finally:
        ray.shutdown()
        cluster.shutdown()
    return result


def main() -> int:
    """Command line entry; 1 if a row was lost, doubled or unlike the command line's."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=Path("target/release/intrinsym"))
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--meshes", type=int, default=10_000)
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    result = measure(arguments.program.resolve(), arguments.work.resolve(), arguments.meshes)
    write_results(arguments.out, result)
    compared = result["compared"]
    print(json.dumps({key: result[key] for key in ("compared", "killed_twice", "start_seconds")}, indent=1))
    print({name: result[name]["overhead"] for name in ("large_few", "large", "small")})
    return int(any(compared[key] for key in ("lost", "doubled", "unlike_the_command_line")))


if __name__ == "__main__":
    sys.exit(main())
