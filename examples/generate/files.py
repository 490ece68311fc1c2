"""Small binary PLY files and mirror tables."""

import numpy as np


def write_ply(path, positions, faces, comments):
    """Writes positions (vertices x 3, stored as float32) and faces (lists of corner indices)."""
    header = ["ply", "format binary_little_endian 1.0", *(f"comment {line}" for line in comments)]
    header += [f"element vertex {len(positions)}", *(f"property float {axis}" for axis in "xyz")]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]
    with open(path, "wb") as file:
        file.write("\n".join(header).encode("ascii"))
        file.write(np.asarray(positions, dtype="<f4").tobytes())
        for face in faces:
            file.write(bytes([len(face)]) + np.asarray(face, dtype="<i4").tobytes())


def write_mirror(path, partners):
    """Writes one 0-based partner per line: line v holds the mirror image of vertex v."""
    with open(path, "w", encoding="ascii") as file:
        file.writelines(f"{partner}\n" for partner in partners)
