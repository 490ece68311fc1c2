#!/usr/bin/env python3
"""Writes quadruped_eigenvalues.json: the 50 lowest non-zero Laplace-Beltrami eigenvalues by SciPy.

    pip install numpy==2.4.6 scipy==1.17.1
    python tests/data/golden/make_eigenvalues.py

Shares no code with the library: cotangents from positions (Pinkall, Polthier 1993), barycentric lumped
mass, area scaled to 1, no mollification, ARPACK's shift-invert mode."""

import json
import pathlib
import platform

import numpy as np
import scipy
import scipy.sparse as sparse
from scipy.sparse.linalg import eigsh

HERE = pathlib.Path(__file__).resolve().parent
MESH = "examples/quadruped.ply"
COUNT = 50


def read_triangles(path):
    """Positions (double) and triangles of a binary PLY with float x y z and triangles only."""
    header, body = path.read_bytes().split(b"end_header\n", 1)
    counts = {words[1]: int(words[2]) for words in map(str.split, header.decode().splitlines())
              if words[0] == "element"}
    positions = np.frombuffer(body, "<f4", 3 * counts["vertex"]).reshape(-1, 3).astype(float)
    face = np.dtype([("corners", "u1"), ("vertices", "<i4", 3)])
    faces = np.frombuffer(body, face, counts["face"], offset=12 * counts["vertex"])
    assert (faces["corners"] == 3).all()
    return positions, faces["vertices"]


def operators(positions, triangles):
    """Cotangent stiffness and barycentric lumped mass for unit area."""
    size = len(positions)
    corners = positions[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1) / 2
    stiffness = sparse.csr_matrix((size, size))
    for corner in range(3):
        i, j = triangles[:, (corner + 1) % 3], triangles[:, (corner + 2) % 3]
        u, v = positions[i] - corners[:, corner], positions[j] - corners[:, corner]
        half_cotangent = (u * v).sum(1) / (4 * areas)
        entries = np.concatenate([-half_cotangent, -half_cotangent, half_cotangent, half_cotangent])
        rows, columns = np.concatenate([i, j, i, j]), np.concatenate([j, i, i, j])
        stiffness += sparse.csr_matrix((entries, (rows, columns)), (size, size))
    mass = np.bincount(triangles.ravel(), np.repeat(areas / 3, 3), size)
    return stiffness, sparse.diags(mass / areas.sum())


def main():
    positions, triangles = read_triangles(HERE.parents[2] / MESH)
    stiffness, mass = operators(positions, triangles)
    values = eigsh(stiffness.tocsc(), COUNT + 1, mass.tocsc(), sigma=-1.0, which="LM", tol=1e-12,
                   v0=np.ones(len(positions)) + np.arange(len(positions)) % 7,
                   return_eigenvectors=False)
    golden = {
        "mesh": MESH, "vertices": len(positions), "made_by": "tests/data/golden/make_eigenvalues.py",
        "versions": {"scipy": scipy.__version__, "numpy": np.__version__, "python": platform.python_version()},
        "eigenvalues": [float(f"{value:.12g}") for value in np.sort(values)[1:]],
    }
    (HERE / "quadruped_eigenvalues.json").write_text(json.dumps(golden, indent=1) + "\n")


if __name__ == "__main__":
    main()
