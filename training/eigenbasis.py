"""Eigenfunctions from the Rust core: there is no second Laplacian here.

The command `intrinsym eigen MESH -k K -o OUT.npz` is found by the environment variable INTRINSYM,
else in target/release, else on the PATH.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .meshfile import write_ply


@dataclass
class Eigenbasis:
    """Eigenvalues (k,), eigenfunctions (n, k) orthonormal under the mass, mass (n,); constant left out."""

    eigenvalues: np.ndarray
    eigenfunctions: np.ndarray
    mass: np.ndarray


def command() -> str:
    """The program to call."""
    built = Path(__file__).parent.parent / "target" / "release" / "intrinsym"
    found = os.environ.get("INTRINSYM") or (str(built) if built.exists() else shutil.which("intrinsym"))
    if not found:
        raise FileNotFoundError("build the command line (cargo build --release) or set INTRINSYM to it")
    return found


def of_file(mesh: Path, count: int) -> Eigenbasis:
    """The first `count` eigenfunctions after the constant of a mesh file."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "eigen.npz"
        call = [command(), "eigen", str(mesh), "-k", str(count), "-o", str(out)]
        done = subprocess.run(call, capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(f"{mesh}: {done.stderr.strip()}")
        with np.load(out) as data:
            return without_constant(data["eigenvalues"], data["eigenfunctions"], data["mass"], count)


def of_mesh(vertices: np.ndarray, faces: np.ndarray, count: int) -> Eigenbasis:
    """As `of_file`, for arrays."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.ply"
        write_ply(path, vertices, faces)
        basis = of_file(path, count)
    if len(basis.mass) != len(vertices):
        raise RuntimeError("the core repaired the mesh: its vertices are not the file's")
    return basis


def without_constant(eigenvalues, eigenfunctions, mass, count) -> Eigenbasis:
    """Drop the constant function if the core listed it, and keep `count`."""
    mean = (mass[:, None] * eigenfunctions).sum(0) / mass.sum()
    rms = np.sqrt((mass[:, None] * eigenfunctions**2).sum(0) / mass.sum())
    varying = np.abs(mean) < 0.5 * rms
    return Eigenbasis(eigenvalues[varying][:count], eigenfunctions[:, varying][:, :count], mass)
