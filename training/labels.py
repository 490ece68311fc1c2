"""Labels by people: our file format, and the paper's authors' MATLAB files.

Our format is one JSON file a shape (documented in docs/labels.md):

    {"format": "intrinsym-labels", "version": 1, "mesh": "dancer.ply", "mesh_hash": "sha256:...",
     "labels": {"1": "even", "2": "odd", "7": "neither"}}

Eigenfunctions are counted from 1, the constant left out; those not listed were not judged.
"""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path

import numpy as np
from scipy.io import loadmat

from . import eigenbasis
from .data import Shapes
from .dataset import EIGENFUNCTIONS, SAMPLES, area_samples
from .meshfile import read_ply

FORMAT, VERSION = "intrinsym-labels", 1
CORRELATION = {"even": 1.0, "odd": -1.0, "neither": 0.0}
AUTHORS_CLASSES = {0: "human", 8: "teddy", 14: "armadillo", 19: "fourleg"}  # of SHREC'07, by twenties


class LabelFileError(ValueError):
    """A label file that cannot be used; the message names the file and the fault."""


def mesh_hash(vertices: np.ndarray, faces: np.ndarray) -> str:
    """"sha256:" and the hash of counts (two u64), positions (f32) and triangles (u32), little-endian."""
    digest = hashlib.sha256(np.array([len(vertices), len(faces)], "<u8").tobytes())
    digest.update(np.ascontiguousarray(vertices, "<f4").tobytes())
    digest.update(np.ascontiguousarray(faces, "<u4").tobytes())
    return "sha256:" + digest.hexdigest()


def read(path: Path) -> tuple[str, str, dict[int, float]]:
    """(mesh file name, mesh hash, correlation by eigenfunction number) of one label file."""
    try:
        stored = json.loads(path.read_text())
        if stored["format"] != FORMAT or stored["version"] != VERSION:
            raise LabelFileError(f"{path}: format {FORMAT} version {VERSION} is wanted")
        labels = {int(number): CORRELATION[label] for number, label in stored["labels"].items()}
        mesh, fingerprint = str(stored["mesh"]), str(stored["mesh_hash"])
    except (json.JSONDecodeError, KeyError, TypeError, AttributeError) as fault:
        raise LabelFileError(f"{path}: {type(fault).__name__}: {fault}") from fault
    if not labels or min(labels) < 1:
        raise LabelFileError(f"{path}: eigenfunctions are counted from 1, and one at least is needed")
    return mesh, fingerprint, labels


def write(path: Path, mesh: str, fingerprint: str, labels: dict[int, str]) -> None:
    """One label file; `labels` maps an eigenfunction's number to even, odd or neither."""
    for number, label in labels.items():
        if number < 1 or label not in CORRELATION:
            raise LabelFileError(f"{path}: eigenfunction {number} is {label!r}; even, odd or neither is wanted")
    stored = {"format": FORMAT, "version": VERSION, "mesh": mesh, "mesh_hash": fingerprint,
              "labels": {str(number): label for number, label in sorted(labels.items())}}
    path.write_text(json.dumps(stored, indent=1) + "\n")


def of_people(folder: Path, solve=eigenbasis.of_mesh) -> Shapes:
    """All label files (*.labels.json) of a folder with the PLY meshes that they name beside them."""
    rows = []
    for path in sorted(folder.glob("*.labels.json")):
        mesh, fingerprint, labels = read(path)
        vertices, faces = read_ply(folder / mesh)
        if mesh_hash(vertices, faces) != fingerprint:
            raise LabelFileError(f"{path}: {mesh} is not the mesh that was labelled (its hash differs)")
        basis = solve(vertices, faces, EIGENFUNCTIONS)
        correlation = np.full(EIGENFUNCTIONS, np.nan)
        for number, value in labels.items():
            if number <= EIGENFUNCTIONS:
                correlation[number - 1] = value
        rows.append(_row(basis.eigenfunctions, basis.mass, vertices, correlation))
    return _shapes(rows, ["people"] * len(rows), folder)


def authors(folder: Path) -> Shapes:
    """The authors' files: `model_evecs` (vertices x 17, no constant) and `model_sign` in {1, -1, 0}.

    They hold no mesh, so the samples are uniform over the vertices and there are no positions.
    """
    rows, paths = [], sorted(folder.glob("**/*.mat"))
    for path in paths:
        stored = loadmat(path)
        try:
            functions = np.asarray(stored["model_evecs"], float)[:, :EIGENFUNCTIONS]
            sign = np.asarray(stored["model_sign"], float).ravel()[:EIGENFUNCTIONS]
        except KeyError as fault:
            raise LabelFileError(f"{path}: has no {fault}") from fault
        if functions.shape[1] < EIGENFUNCTIONS or len(sign) < EIGENFUNCTIONS or not np.isin(sign, (-1, 0, 1)).all():
            raise LabelFileError(f"{path}: {EIGENFUNCTIONS} eigenvectors with signs 1, -1 or 0 are wanted")
        rows.append(_row(functions, np.ones(len(functions)), np.zeros((len(functions), 3)), sign))
    return _shapes(rows, [authors_kind(path.stem) for path in paths], folder)


def authors_kind(name: str) -> str:
    """What the name of an authors' file stands for: SHREC'07 counts twenty shapes a class, other names are people."""
    found = re.match(r"shrec07_(\d+)_", name)
    return AUTHORS_CLASSES.get((int(found[1]) - 1) // 20, "other") if found else "scape" if name.startswith("scape") else "people"


def _row(functions, mass, positions, correlation):
    scaled = functions / np.sqrt((functions**2).mean(0) + 1e-30)
    picked = area_samples(np.random.default_rng(0), mass, SAMPLES)
    return scaled[picked].astype(np.float16), positions[picked].astype(np.float32), correlation.astype(np.float32)


def _shapes(rows, kinds: list[str], folder: Path) -> Shapes:
    if not rows:
        raise LabelFileError(f"{folder}: no label files")
    return Shapes(*(np.array(column) for column in zip(*rows)), np.array(kinds))
