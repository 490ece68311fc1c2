# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures how long MeshLab stands still in a detection of hard meshes of 100,000 vertices, and prints a table for docs/robustness.md.

usage: measure_hard.py

The meshes are those of evaluation/hard_meshes.py, loaded into PyMeshLab. The detection has a thread of its own; the main thread copies the mesh, calls the
host's bar twenty times a second, and stores the result. *Main thread* is all that it computes in the filter, seconds of the processor: no
single stand-still is longer.
"""

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3]))

import conftest  # noqa: E402  (the package and its paths)
import pymeshlab  # noqa: E402
from evaluation.hard_meshes import MESHES  # noqa: E402


def measured(make):
    """(seconds of all threads, of the main thread)."""
    points, faces = make()
    loaded = pymeshlab.MeshSet()
    conftest.KEPT_ALIVE.append(loaded)
    as_faces = {"face_matrix": faces} if faces.shape[1] == 3 else {"face_list_of_indices": faces.tolist()}
    loaded.add_mesh(pymeshlab.Mesh(points, **as_faces))
    all_threads, main_thread = time.process_time(), time.thread_time()
    loaded.apply_filter(conftest.COMPUTE)
    return time.process_time() - all_threads, time.thread_time() - main_thread


def main():
    conftest.pytest_configure()
    print("| mesh | all threads | main thread |\n|---|---|---|", flush=True)
    for name, make in MESHES.items():
        print(f"| {name} | " + " | ".join(f"{seconds:.2f}" for seconds in measured(make)) + " |", flush=True)


if __name__ == "__main__":
    main()
