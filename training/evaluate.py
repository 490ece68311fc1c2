"""How good the shipped model is: accuracy, calibration, and the public benchmark.

    python -m training.evaluate models/signnet.onnx --data test.npz
    python -m training.evaluate models/signnet.onnx --benchmark ROOT [--cache DIR]
    python -m training.evaluate models/signnet.onnx --remeshed DATA [--cache DIR]
    python -m training.evaluate models/signnet.onnx --watertight DATA [--cache DIR]
    python -m training.evaluate models/signnet.onnx --authors FOLDER

Each takes `--first 12` to count the first twelve eigenfunctions only.

Accuracy counts the sign of ln(even/odd) against the sign of c on the unambiguous entries, |c| > 0.8.
Benchmark labels: c over the landmark pairs of Kim, Lipman and Funkhouser (their mirror images are
given; each pair counts both ways). Labels of the remeshed sets (see evaluation/remeshed.py): c over all their
corresponding vertices. The authors' labels are people's, c = 1, -1 or 0. All are measured on only, never trained on.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import onnxruntime

from evaluation import watertight
from evaluation.princeton import read_pairs

from . import data, eigenbasis, labels
from .dataset import EIGENFUNCTIONS, parity_labels
from .mirror_truth import NO_PARTNER

UNAMBIGUOUS = 0.8
BINS = 10
PEOPLE_CLASSES = ("david", "michael", "victoria", "scape")


@dataclass
class Entries:
    """Probabilities (n, signs, 3), correlations c (n, signs) and a group name per shape (n,)."""

    probabilities: np.ndarray
    correlation: np.ndarray
    group: np.ndarray

    def first(self, count: int | None) -> Entries:
        """Those of the first `count` eigenfunctions."""
        return Entries(self.probabilities[:, :count], self.correlation[:, :count], self.group)


def softmax(logits: np.ndarray) -> np.ndarray:
    """Over the last axis."""
    raised = np.exp(logits - logits.max(-1, keepdims=True))
    return raised / raised.sum(-1, keepdims=True)


def systematic_samples(mass: np.ndarray, count: int) -> np.ndarray:
    """The same vertices as `area_weighted_vertices` of src/spectral/sampling.rs."""
    middles = (np.arange(count) + 0.5) * (mass.sum() / count)
    return np.minimum(np.searchsorted(np.cumsum(mass), middles), len(mass) - 1)


class Model:
    """The ONNX file in ONNX Runtime."""

    def __init__(self, path: Path):
        settings = onnxruntime.SessionOptions()
        settings.intra_op_num_threads = 1
        self._session = onnxruntime.InferenceSession(str(path), settings, providers=["CPUExecutionProvider"])
        self.signs, self.points, _ = self._session.get_inputs()[0].shape

    def probabilities(self, rows: np.ndarray) -> np.ndarray:
        """(signs, 3) from eigenfunctions (points, >= signs) at area-weighted samples."""
        x = np.stack([np.c_[rows[:, :3], rows[:, i]] for i in range(self.signs)]).astype(np.float32)
        return softmax(self._session.run(None, {"eigenfunctions": x})[0])


def on_shapes(model: Model, shapes: data.Shapes) -> Entries:
    """Generated shapes, at the first samples of each."""
    probabilities = [model.probabilities(rows[: model.points].astype(np.float32)) for rows in shapes.samples]
    return Entries(np.array(probabilities), shapes.labels[:, : model.signs], shapes.kind)


def landmark_pairs(root: Path, name: str) -> np.ndarray:
    """Vertex pairs (p, 2) that are mirror images, both ways, points of the plane with themselves."""
    vertices = [int(line.split()[0]) for line in (root / "Corrs" / f"{name}.pid").read_text().splitlines() if line.split()]
    pairs = []
    for line in (root / "Corrs" / f"{name}.sym.info").read_text().splitlines():
        numbers = [int(word) for word in line.split()]
        if numbers:
            pairs += [(numbers[0], numbers[-1]), (numbers[-1], numbers[0])]
    return np.array(vertices)[np.array(pairs)]


def landmark_correlation(functions: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """c of each column of `functions` over the landmark pairs."""
    here, there = functions[pairs[:, 0]], functions[pairs[:, 1]]
    return (here * there).sum(0) / np.sqrt((here**2).sum(0) * (there**2).sum(0) + 1e-30)


def basis_of(mesh: Path, cache: Path | None):
    """Eigenbasis of a benchmark mesh, kept in `cache` if given."""
    kept = cache / f"{mesh.stem}.npz" if cache else None
    if kept and kept.exists():
        with np.load(kept) as stored:
            return eigenbasis.Eigenbasis(stored["values"], stored["functions"], stored["mass"])
    basis = eigenbasis.of_file(mesh, EIGENFUNCTIONS)
    if kept:
        cache.mkdir(parents=True, exist_ok=True)
        np.savez(kept, values=basis.eigenvalues, functions=basis.eigenfunctions, mass=basis.mass)
    return basis


def on_benchmark(model: Model, root: Path, cache: Path | None) -> Entries:
    """SCAPE and TOSCA, each mesh by its class; meshes whose landmark numbers are void are left out."""
    probabilities, correlations, groups = [], [], []
    for mesh in benchmark_meshes(root):
        name = class_of(mesh)
        basis = basis_of(mesh, cache)
        rows = systematic_samples(basis.mass, model.points)
        probabilities.append(model.probabilities(basis.eigenfunctions[rows]))
        pairs = landmark_pairs(mesh.parent.parent, "1" if name == "mesh" else name)
        correlations.append(landmark_correlation(basis.eigenfunctions[:, : model.signs], pairs))
        groups.append("scape" if name == "mesh" else name)
    return Entries(np.array(probabilities), np.array(correlations), np.array(groups))


def on_watertight(model: Model, root: Path, cache: Path | None) -> Entries:
    """The classes of SHREC'07 with one mirror plane (see evaluation/watertight.py)."""
    probabilities, correlations, groups = [], [], []
    for number, name in watertight.CLASSES.items():
        pairs = read_pairs(root / "Corrs" / f"{number}.sym.info")
        for mesh in range((number - 1) * watertight.MESHES + 1, number * watertight.MESHES + 1):
            basis = basis_of(root / "Meshes" / f"{mesh}.off", cache)
            rows = systematic_samples(basis.mass, model.points)
            probabilities.append(model.probabilities(basis.eigenfunctions[rows]))
            landmarks = watertight.read_vertices(root / "Corrs", mesh)[pairs]
            correlations.append(landmark_correlation(basis.eigenfunctions[:, : model.signs], landmarks))
            groups.append(name)
    return Entries(np.array(probabilities), np.array(correlations), np.array(groups))


def on_remeshed(model: Model, root: Path, cache: Path | None) -> Entries:
    """Remeshed FAUST and TOSCA, by set."""
    probabilities, correlations, groups = [], [], []
    for mesh in sorted(root.glob("*/vtx_5k/*.off")):
        group = mesh.parts[-3]
        basis = basis_of(mesh, cache and cache / group)
        rows = systematic_samples(basis.mass, model.points)
        probabilities.append(model.probabilities(basis.eigenfunctions[rows]))
        truth = mesh.parent / "corres" / mesh.name
        source, image = (np.loadtxt(truth.with_suffix(end), dtype=int) - 1 for end in (".vts", ".sym.vts"))
        mirror = np.full(len(basis.mass), NO_PARTNER)
        mirror[source] = image
        correlations.append(parity_labels(basis.eigenfunctions[:, : model.signs], basis.mass, mirror))
        groups.append(group)
    return Entries(np.array(probabilities), np.array(correlations), np.array(groups))


def class_of(mesh: Path) -> str:
    """cat of cat3.off."""
    return mesh.stem.rstrip("0123456789")


def vertex_count(mesh: Path) -> int:
    """From the second line of an OFF file."""
    with open(mesh, encoding="ascii") as file:
        file.readline()
        return int(file.readline().split()[0])


def benchmark_meshes(root: Path) -> list[Path]:
    """Those with the most usual vertex count of their class (the others are cut-open variants)."""
    meshes = sorted([*(root / "SCAPE" / "Meshes").glob("*.off"), *(root / "TOSCA" / "Meshes").glob("*.off")])
    counts = {mesh: vertex_count(mesh) for mesh in meshes}
    usual = {}
    for name in {class_of(mesh) for mesh in meshes}:
        values = [counts[mesh] for mesh in meshes if class_of(mesh) == name]
        usual[name] = max(set(values), key=values.count)
    return [mesh for mesh in meshes if counts[mesh] == usual[class_of(mesh)]]


def accuracy(entries: Entries, shapes: np.ndarray, threshold: float) -> tuple[float, int]:
    """Share of right signs among entries with |c| > threshold, and how many there are."""
    right = np.sign(entries.probabilities[..., 0] - entries.probabilities[..., 1]) == np.sign(entries.correlation)
    chosen = (np.abs(entries.correlation) > threshold) & shapes[:, None]
    return (float(right[chosen].mean()) if chosen.any() else float("nan")), int(chosen.sum())


def whole_shapes(entries: Entries, shapes: np.ndarray) -> float:
    """Share of shapes with every unambiguous sign right."""
    right = np.sign(entries.probabilities[..., 0] - entries.probabilities[..., 1]) == np.sign(entries.correlation)
    return float((right | (np.abs(entries.correlation) <= UNAMBIGUOUS))[shapes].all(1).mean())


def reliability(confidence: np.ndarray, truth: np.ndarray) -> tuple[float, list[tuple[float, float, int]]]:
    """Expected calibration error, and (mean confidence, mean truth, count) of ten equal bins."""
    which = np.minimum((confidence * BINS).astype(int), BINS - 1)
    bins = [(float(confidence[which == b].mean()), float(truth[which == b].mean()), int((which == b).sum()))
            for b in range(BINS) if (which == b).any()]
    error = sum(abs(a - b) * n for a, b, n in bins) / len(confidence)
    return error, bins


def sign_reliability(entries: Entries, threshold: float = UNAMBIGUOUS):
    """Of the more likely sign, given that there is one, on entries with |c| above the threshold."""
    even, odd = entries.probabilities[..., 0], entries.probabilities[..., 1]
    sure = np.abs(entries.correlation) > threshold
    confidence = np.maximum(even, odd) / (even + odd)
    return reliability(confidence[sure], (np.sign(even - odd) == np.sign(entries.correlation))[sure].astype(float))


def answer_reliability(entries: Entries):
    """Of the most likely of the three answers, against the soft targets that were trained."""
    target = data.targets(entries.correlation)
    best = entries.probabilities.argmax(-1)
    truth = np.take_along_axis(target, best[..., None], -1)[..., 0]
    return reliability(entries.probabilities.max(-1).ravel(), truth.ravel())


def report(entries: Entries, groups: dict[str, np.ndarray]) -> dict:
    """Everything above, by group, as plain numbers."""
    out = {}
    for name, shapes in groups.items():
        clear, count = accuracy(entries, shapes, UNAMBIGUOUS)
        every, total = accuracy(entries, shapes, 0.0)
        out[name] = {"shapes": int(shapes.sum()), "accuracy": round(clear, 5), "entries": count,
                     "accuracy_all": round(every, 5), "entries_all": total,
                     "all_signs_right": round(whole_shapes(entries, shapes), 4)}
    sign_error, sign_bins = sign_reliability(entries)
    answer_error, answer_bins = answer_reliability(entries)
    out["calibration"] = {"sign_error": round(sign_error, 5), "sign_bins": sign_bins,
                          "answer_error": round(answer_error, 5), "answer_bins": answer_bins}
    return out


def benchmark_groups(group: np.ndarray) -> dict[str, np.ndarray]:
    """All, SCAPE, TOSCA, people, animals, and each class."""
    people = np.isin(group, PEOPLE_CLASSES)
    groups = {"all": np.ones(len(group), bool), "SCAPE": group == "scape", "TOSCA": group != "scape",
              "people": people, "animals": ~people}
    return groups | all_and_each(group)


def all_and_each(group: np.ndarray) -> dict[str, np.ndarray]:
    """All shapes, and those of each group."""
    return {"all": np.ones(len(group), bool)} | {str(name): group == name for name in np.unique(group)}


def main() -> None:
    """Command line entry."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", type=Path)
    parser.add_argument("--data", type=Path, nargs="+", help="training files kept for testing")
    parser.add_argument("--benchmark", type=Path, help="folder with SCAPE and TOSCA")
    parser.add_argument("--remeshed", type=Path, help="folder with SET/vtx_5k/NAME.off")
    parser.add_argument("--watertight", type=Path, help="folder with SHREC'07's Meshes and Corrs")
    parser.add_argument("--authors", type=Path, help="folder of the authors' MATLAB files")
    parser.add_argument("--first", type=int, help="count this many eigenfunctions (default: all that the model answers)")
    parser.add_argument("--cache", type=Path, help="folder that keeps the benchmark's eigenfunctions")
    options = parser.parse_args()
    model = Model(options.model)
    measured = {}
    if options.data:
        measured["generated"] = on_shapes(model, data.load(options.data))
    if options.authors:
        measured["authors"] = on_shapes(model, labels.authors(options.authors))
    if options.remeshed:
        measured["remeshed"] = on_remeshed(model, options.remeshed, options.cache)
    if options.watertight:
        measured["watertight"] = on_watertight(model, options.watertight, options.cache)
    if options.benchmark:
        measured["benchmark"] = on_benchmark(model, options.benchmark, options.cache)
    for name, entries in measured.items():
        groups = (benchmark_groups if name == "benchmark" else all_and_each)(entries.group)
        print(json.dumps({name: report(entries.first(options.first), groups)}, indent=1))


if __name__ == "__main__":
    main()
