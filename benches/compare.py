"""Seconds and memory of the pipeline by mesh size, beside SciPy's eigenvalue solver on the same meshes.

    make bench                                  # builds, runs this, writes benches/results/DATE
    python benches/compare.py --out FOLDER 10 35 71

Each number f is a generated mesh of 10 f^2 + 2 vertices (`benches/stages.rs`). For each, one process runs the whole
pipeline a few times on one thread, by default options, one does so on two (stages by themselves: `benches/by_stage.py`); then one
process for each peer computes, on one thread, what pyFM and robust_laplacian users compute (--eigenfunctions, by default 50):

- `scipy eigsh`: cotangent stiffness and lumped mass, eigenpairs by shift-invert at -0.01 (pyFM's call);
- `robust_laplacian + eigsh`: its Laplacian, eigenpairs by shift-invert at 1e-8 (its README's call);
- `pyfmaps`: a whole map of the mesh onto itself as pyFM's documentation makes it: wave kernel signatures, a functional map of
  20 x 20 with the term that reverses orientation, ZoomOut by steps of 10 up to as many eigenfunctions. It is told that
  there is a reflection, and does not judge or verify. Once, up to 20,000 vertices.

FOLDER/runs.json keeps all raw seconds; FOLDER/table.md and FOLDER/speed.png are made from it.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

# Beyond so many vertices the map peer takes minutes.
LARGE_FOR_MAPS = 20_000
# Above so many vertices everything runs once, and the peers, which take minutes there, not at all.
LARGE = 100_000


def cotangent_laplacian(vertices: np.ndarray, faces: np.ndarray):
    """Stiffness and lumped mass, both sparse."""
    from scipy.sparse import coo_matrix, diags

    count = len(vertices)
    stiffness = coo_matrix((count, count))
    areas = np.linalg.norm(np.cross(*(vertices[faces[:, c]] - vertices[faces[:, 0]] for c in (1, 2))), axis=1) / 2
    for corner in range(3):
        i, j, k = (faces[:, (corner + step) % 3] for step in range(3))
        cotangent = np.einsum("ij,ij->i", vertices[j] - vertices[i], vertices[k] - vertices[i]) / (2 * areas)
        half = coo_matrix((cotangent / 2, (j, k)), shape=(count, count))
        stiffness = stiffness - half - half.T
    stiffness = (stiffness - diags(np.asarray(stiffness.sum(axis=1)).ravel())).tocsc()
    mass = np.bincount(faces.ravel(), np.repeat(areas / 3, 3), count)
    return stiffness, diags(mass).tocsc()


def self_map_seconds(vertices: np.ndarray, faces: np.ndarray, count: int) -> dict[str, float]:
    """Seconds of the steps by which pyfmaps maps a mesh onto itself, orientation reversed."""
    from pyFM.functional import FunctionalMapping
    from pyFM.mesh import TriMesh

    first, step = 20, 10
    times = [time.perf_counter()]
    mesh = TriMesh(vertices, faces, area_normalize=True, center=True).process(k=count + 1, intrinsic=True)
    times.append(time.perf_counter())
    mapping = FunctionalMapping(mesh, mesh)
    mapping.preprocess(n_descr=100, descr_type="WKS", k_process=count + 1)
    mapping.fit(K=(first, first), w_descr=0.1, w_lap=1e-3, w_dcomm=1, w_orient=1, orient_reversing=True)
    times.append(time.perf_counter())
    mapping.zoomout_refine(nit=(count - first) // step, step=step)
    mapping.get_p2p()
    times.append(time.perf_counter())
    return dict(zip(["eigenpairs", "first map", "zoomout"], np.diff(times)))


def peer(name: str, prefix: str, count: int, repeats: int) -> None:
    """Runs one peer in this process and prints its seconds and peak memory."""
    vertices = np.fromfile(prefix + ".positions").reshape(-1, 3)
    faces = np.fromfile(prefix + ".triangles", np.uint32).reshape(-1, 3).astype(int)
    if name == MAP_PEER:
        runs = [self_map_seconds(vertices, faces, count) for _ in range(repeats)]
    else:
        runs = [eigenpair_seconds(name, vertices, faces, count) for _ in range(repeats)]
    peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(json.dumps({"runs": runs, "peak_memory_bytes": peak}))


def eigenpair_seconds(name: str, vertices: np.ndarray, faces: np.ndarray, count: int) -> dict[str, float]:
    """Seconds of a Laplacian and its lowest eigenpairs."""
    from scipy.sparse.linalg import eigsh

    start = time.perf_counter()
    if name == "scipy eigsh":
        stiffness, mass = cotangent_laplacian(vertices, faces)
        shift = -0.01
    else:
        import robust_laplacian

        stiffness, mass = robust_laplacian.mesh_laplacian(vertices, faces)
        shift = 1e-8
    middle = time.perf_counter()
    eigsh(stiffness, count, mass, sigma=shift)
    return {"laplacian": middle - start, "eigenpairs": time.perf_counter() - middle}


MAP_PEER = "pyfmaps"
PEERS = ["scipy eigsh", "robust_laplacian + eigsh", MAP_PEER]


def peers_for(vertices: int, repeats: int) -> dict[str, int]:
    """How often each peer that is not too slow for the size runs."""
    if vertices > LARGE:
        return {}
    return {name: 1 if name == MAP_PEER else repeats for name in PEERS if name != MAP_PEER or vertices <= LARGE_FOR_MAPS}


def output(command: list) -> dict:
    """The JSON that a command prints."""
    return json.loads(subprocess.run([str(part) for part in command], check=True, stdout=subprocess.PIPE).stdout)


def measure(program: Path, frequency: int, count: int) -> dict:
    """All runs on one mesh."""
    repeats = 1 if 10 * frequency**2 > LARGE else 5
    with tempfile.TemporaryDirectory() as folder:
        prefix = f"{folder}/mesh"
        run = [program, frequency, "--repeats", repeats]
        own = output([*run, "--write", prefix])
        two = output([*run, "--threads", 2])
        peers = {
            name: output([sys.executable, __file__, "--peer", name, prefix, count, times])
            for name, times in peers_for(own["vertices"], repeats).items()
        }
    return {"vertices": own["vertices"], "intrinsym": own, "two threads": two, "peers": peers, "load": os.getloadavg()[0]}


def stages(entry: dict) -> dict[str, float]:
    """Median seconds of each stage of the pipeline, on one thread."""
    runs = [dict(run["seconds"]) for run in entry["intrinsym"]["runs"]]
    return {stage: statistics.median(run.get(stage, 0.0) for run in runs) for stage in runs[0]}


def total(entry: dict, threads: str = "intrinsym", runs: str = "runs") -> float:
    return statistics.median(sum(seconds for _, seconds in run["seconds"]) for run in entry[threads][runs])


def peer_total(entry: dict, name: str) -> float:
    """Seconds of a peer; not a number where it did not run."""
    if name not in entry["peers"]:
        return float("nan")
    return statistics.median(sum(run.values()) for run in entry["peers"][name]["runs"])


def exponent(sizes: list[int], seconds: list[float]) -> float:
    """Slope of the least-squares line in log-log, from the second size on; not a number where there are too few."""
    known = np.array([(size, value) for size, value in zip(sizes, seconds) if np.isfinite(value)][1:])
    if len(known) < 2:
        return float("nan")
    return float(np.polyfit(*np.log(known).T, 1)[0])


def cell(text: str) -> str:
    return "-" if "nan" in text else text


def table(entries: list[dict]) -> str:
    """Markdown: milliseconds of whole detections by size, then the comparison."""
    sizes = [entry["vertices"] for entry in entries]
    header = "| | " + " | ".join(f"{size:,}" for size in sizes) + " | growth |"
    lines = [header, "|---" * (len(sizes) + 2) + "|"]

    def row(name: str, seconds: list[float]) -> None:
        growth = cell(f"N^{exponent(sizes, seconds):.2f}") if len(sizes) > 2 and min(seconds) > 0 else ""
        cells = " | ".join(cell(f"{1e3 * v:,.1f}" if v < 0.1 else f"{1e3 * v:,.0f}") for v in seconds)
        lines.append(f"| {name} | {cells} | {growth} |")

    def plain(name: str, texts: list[str]) -> None:
        lines.append(f"| {name} | " + " | ".join(cell(text) for text in texts) + " | |")

    plain("solved on", [f"{entry['intrinsym']['runs'][0]['solved_vertices']:,}" for entry in entries])
    row("**all**", [total(entry) for entry in entries])
    row("**all, two threads**", [total(entry, "two threads") for entry in entries])
    row("**again, two threads**", [total(entry, "two threads", "again") for entry in entries])
    # Older results do not have it.
    if all("again_stored" in entry["two threads"] for entry in entries):
        row("the same from a stored map", [total(entry, "two threads", "again_stored") for entry in entries])
    for name in PEERS:
        row(name, [peer_total(entry, name) for entry in entries])
    own = [stages(entry)["proxy"] + stages(entry)["laplacian"] + stages(entry)["eigenfunctions"] for entry in entries]
    eigsh = [peer_total(entry, PEERS[0]) for entry in entries]
    plain("times slower than our proxy, Laplacian and eigenfunctions", [f"{e / o:.1f}" for e, o in zip(eigsh, own)])
    plain("times slower than our whole pipeline", [f"{e / total(entry):.1f}" for e, entry in zip(eigsh, entries)])
    plain("pyfmaps: the same", [f"{peer_total(entry, MAP_PEER) / total(entry):.1f}" for entry in entries])
    memory = lambda run, key: f"{run.get(key, float('nan')) / 1e6:,.0f}"
    plain("peak memory, MB: intrinsym", [memory(entry["intrinsym"], "peak_memory_bytes") for entry in entries])
    plain("the same, as estimated", [memory(entry["intrinsym"], "estimated_memory_bytes") for entry in entries])
    for name in PEERS:
        plain(f"peak memory, MB: {name}", [memory(entry["peers"].get(name, {}), "peak_memory_bytes") for entry in entries])
    return "\n".join(lines) + "\n"


def plot(entries: list[dict], path: Path) -> None:
    """Seconds over vertices, both logarithmic."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    sizes = [entry["vertices"] for entry in entries]
    curves = {"intrinsym, whole pipeline": [total(entry) for entry in entries]}
    curves["intrinsym, two threads"] = [total(entry, "two threads") for entry in entries]
    alone = {name: "" if name == MAP_PEER else ", eigenfunctions alone" for name in PEERS}
    curves |= {name + what: [peer_total(entry, name) for entry in entries] for name, what in alone.items()}
    figure, axes = pyplot.subplots(figsize=(7, 4.5))
    for name, seconds in curves.items():
        axes.loglog(sizes, seconds, marker="o", label=f"{name} ({cell(f'N^{exponent(sizes, seconds):.2f}')})")
    axes.set(xlabel="vertices", ylabel="seconds (one thread, unless said)")
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def newest_program() -> Path:
    """The bench executable that was built last."""
    folder = Path(os.environ.get("CARGO_TARGET_DIR", "target")) / "release" / "deps"
    built = [path for path in folder.glob("stages-*") if path.suffix == ""]
    return max(built, key=lambda path: path.stat().st_mtime)


def main() -> None:
    """Command line entry."""
    if sys.argv[1:2] == ["--peer"]:
        return peer(sys.argv[2], sys.argv[3], int(sys.argv[4]), int(sys.argv[5]))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("frequencies", type=int, nargs="+")
    parser.add_argument("--eigenfunctions", type=int, default=50, help="of the peers")
    parser.add_argument("--program", type=Path, help="the bench executable; default: the one built last")
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    program = arguments.program or newest_program()
    arguments.out.mkdir(parents=True, exist_ok=True)
    entries = []
    for frequency in arguments.frequencies:
        entries.append(measure(program, frequency, arguments.eigenfunctions))
        print(f"{entries[-1]['vertices']:,} vertices: {total(entries[-1]):.3f} s", file=sys.stderr)
    machine = {"machine": platform.machine(), "processors": os.cpu_count(), "python": platform.python_version()}
    (arguments.out / "runs.json").write_text(json.dumps({"machine": machine, "entries": entries}, indent=1) + "\n")
    (arguments.out / "table.md").write_text(table(entries))
    if len(entries) > 2:
        plot(entries, arguments.out / "speed.png")
    print(table(entries))


if __name__ == "__main__":
    main()
