"""Files of the generator: binary PLY meshes, mirror tables, and their descriptions."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

HEADER = """ply
format binary_little_endian 1.0
element vertex {vertices}
property float x
property float y
property float z
element face {faces}
property list uchar int vertex_indices
end_header
"""


def write_ply(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    """A triangle mesh as binary little-endian PLY with single-precision positions."""
    rows = np.zeros(len(faces), dtype=[("count", "u1"), ("index", "<i4", 3)])
    rows["count"], rows["index"] = 3, faces
    with open(path, "wb") as file:
        file.write(HEADER.format(vertices=len(vertices), faces=len(faces)).encode())
        file.write(np.asarray(vertices, "<f4").tobytes())
        file.write(rows.tobytes())


def write_shape(folder: Path, name: str, vertices, faces, mirror, description: dict) -> None:
    """NAME.ply, NAME.mirror (one partner index a line, -1 for none) and NAME.json."""
    folder.mkdir(parents=True, exist_ok=True)
    write_ply(folder / f"{name}.ply", vertices, faces)
    np.savetxt(folder / f"{name}.mirror", mirror, fmt="%d")
    (folder / f"{name}.json").write_text(json.dumps(description, indent=1) + "\n")


def read_ply(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a PLY file laid out as `write_ply` lays it out."""
    head, _, body = path.read_bytes().partition(b"end_header\n")
    counts = {line.split()[1]: int(line.split()[2]) for line in head.decode().splitlines() if line.startswith("element")}
    expected = HEADER.format(vertices=counts["vertex"], faces=counts["face"])
    if head.decode() + "end_header\n" != expected:
        raise ValueError(f"{path}: only float x, y, z and triangles in binary little-endian PLY are read")
    vertices = np.frombuffer(body, "<f4", 3 * counts["vertex"]).reshape(-1, 3)
    rows = np.frombuffer(body[vertices.nbytes:], [("count", "u1"), ("index", "<i4", 3)])
    return vertices.astype(float), rows["index"].astype(np.int64)
