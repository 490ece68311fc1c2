"""Meshes of examples/ and what the command line says of them."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import intrinsym

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
BINARY = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "intrinsym"


def truth_of(name: str) -> np.ndarray:
    return np.loadtxt(EXAMPLES / f"{name}.mirror", dtype=np.int64)


@pytest.fixture(scope="session")
def quadruped() -> intrinsym.Mesh:
    return intrinsym.Mesh.read(EXAMPLES / "quadruped.ply")


@pytest.fixture(scope="session")
def loose_triangles() -> intrinsym.Mesh:
    """Of different shapes, none the mirror image of another."""
    rng = np.random.default_rng(1)
    triangles = rng.random((200, 1, 3)) + 0.05 * rng.random((200, 3, 3))
    return intrinsym.Mesh(triangles.reshape(-1, 3), np.arange(600).reshape(-1, 3))


@pytest.fixture(scope="session")
def detection(quadruped: intrinsym.Mesh) -> intrinsym.Detection:
    return quadruped.detect()


@pytest.fixture(scope="session")
def symmetry(detection: intrinsym.Detection) -> intrinsym.Symmetry:
    return detection[0]


@pytest.fixture
def command_line(tmp_path: Path):
    """Runs `intrinsym` with arguments and returns the folder that it runs in."""

    def run(*arguments: object) -> Path:
        if not BINARY.is_file():
            pytest.fail(f"{BINARY} is missing: cargo build --release --bin intrinsym")
        subprocess.run([BINARY, *map(str, arguments)], cwd=tmp_path, check=True, capture_output=True)
        return tmp_path

    return run
