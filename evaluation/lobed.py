"""Small closed surfaces with lobes, a thousand a second: for counting rows and for timing, not for measuring maps."""

from __future__ import annotations

from pathlib import Path

import numpy as np

# Share of the shapes that have no mirror plane.
LOPSIDED_SHARE = 0.2


def lobed(seed: int, rows: int, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """A sphere of rings with lobes of random size; (rows - 1) * columns + 2 vertices and their triangles.

    Four of five mirror in y, the others in nothing.
    """
    rng = np.random.default_rng(seed)
    slope = np.linspace(0, np.pi, rows + 1)[1:-1, None]
    angle = 2 * np.pi * np.arange(columns) / columns
    even, odd = rng.normal(0, 0.25, 4), rng.normal(0, 0.5, 4)
    tilt = rng.uniform(-0.4, 0.4)
    wave = sum(even[k] * np.cos((k + 1) * angle + 0 * slope) for k in range(4))
    if rng.random() < LOPSIDED_SHARE:
        wave = wave + sum(odd[k] * np.sin((k + 1) * angle) * np.cos(slope + k) for k in range(4))
    radius = np.exp(np.sin(slope) ** 2 * wave + tilt * np.cos(slope))
    x, y = (radius * np.sin(slope) * turn(angle) for turn in (np.cos, np.sin))
    z = radius * np.cos(slope)
    poles = [[0, 0, np.exp(tilt)], [0, 0, -np.exp(-tilt)]]
    vertices = np.vstack([np.stack([x, y, z], axis=-1).reshape(-1, 3), poles])
    return vertices, _faces(rows, columns)


def _faces(rows: int, columns: int) -> np.ndarray:
    """Triangles of rings, and the fans about the two poles, which come last."""
    count = (rows - 1) * columns
    first, last = np.arange(columns), count - columns + np.arange(columns)
    own = np.arange(count - columns)
    following = own // columns * columns + (own + 1) % columns
    return np.concatenate(
        [
            np.stack([own, own + columns, following], axis=1),
            np.stack([following, own + columns, following + columns], axis=1),
            np.stack([first, np.roll(first, -1), np.full(columns, count)], axis=1),
            np.stack([np.roll(last, -1), last, np.full(columns, count + 1)], axis=1),
        ]
    )


def write_ply(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    """A binary PLY of float positions and triangles."""
    table = np.empty(len(faces), [("size", "u1"), ("corners", "<i4", 3)])
    table["size"], table["corners"] = 3, faces
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode() + vertices.astype("<f4").tobytes() + table.tobytes())


def write_lobed(folder: Path, count: int, rows: int, columns: int) -> list[Path]:
    """Writes shapes 0 to count - 1 into a folder, those that are there already left as they are."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"lobed-{seed:05d}.ply" for seed in range(count)]
    for seed, path in enumerate(paths):
        if not path.exists():
            write_ply(path, *lobed(seed, rows, columns))
    return paths
