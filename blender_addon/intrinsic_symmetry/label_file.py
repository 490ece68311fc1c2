# SPDX-License-Identifier: GPL-3.0-or-later
"""Label files for training the sign network, as docs/labels.md describes them, and the triangle mesh beside each."""

import hashlib
import json
from pathlib import Path

import numpy as np


def mesh_hash(vertices, triangles):
    """The hash by which a label file knows its mesh."""
    digest = hashlib.sha256(np.array([len(vertices), len(triangles)], "<u8").tobytes())
    digest.update(np.ascontiguousarray(vertices, "<f4").tobytes())
    digest.update(np.ascontiguousarray(triangles, "<u4").tobytes())
    return "sha256:" + digest.hexdigest()


def write(folder, name, vertices, triangles, labels):
    """Writes NAME.ply and NAME.labels.json; `labels` maps eigenfunctions, counted from 1, to even, odd or neither."""
    folder = Path(folder)
    write_ply(folder / f"{name}.ply", vertices, triangles)
    stored = {
        "format": "intrinsym-labels",
        "version": 1,
        "mesh": f"{name}.ply",
        "mesh_hash": mesh_hash(vertices, triangles),
        "labels": {str(number): label for number, label in sorted(labels.items())},
    }
    (folder / f"{name}.labels.json").write_text(json.dumps(stored, indent=1) + "\n")


def write_ply(path, vertices, triangles):
    """Binary little-endian PLY with float positions and triangles."""
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    points = np.ascontiguousarray(vertices, "<f4").tobytes()
    path.write_bytes(header.encode() + points + faces.tobytes())
