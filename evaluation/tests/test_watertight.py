"""The judge of the SHREC'07 classes, on files in the data set's layout."""

import numpy as np

from evaluation import princeton, watertight
from evaluation.program import Answer


def write_tetrahedra(path):
    """Two tetrahedra side by side, mirror images of each other, joined at a triangle: vertices 0, 1, 2 are fixed, 3 and 4 a pair."""
    path.write_text("OFF\n5 6 0\n0 0 0\n0 1 0\n0 0 1\n-1 0 0\n1 0 0\n3 0 1 3\n3 1 2 3\n3 2 0 3\n3 1 0 4\n3 2 1 4\n3 0 2 4\n")


def test_landmarks_and_pairs_are_read_and_remarks_are_not(tmp_path):
    (tmp_path / "5.sym.info").write_text("0 2\n1 3 \n\n4\n5 6 7 8\n0: left\n1: the other end\n")
    (tmp_path / "81.vts").write_text("  1836     0.17   0.11   -0.97\n  22 0 0 0\n\n")
    assert princeton.read_pairs(tmp_path / "5.sym.info").tolist() == [[0, 2], [1, 3], [2, 0], [3, 1], [4, 4]]
    assert watertight.read_vertices(tmp_path, 81).tolist() == [1836, 22]


def test_right_wrong_and_missing_images_are_told_apart(tmp_path):
    mesh = tmp_path / "81.off"
    write_tetrahedra(mesh)
    points, images = np.array([3, 4, 0]), np.array([4, 3, 0])
    answer = lambda partners, outcome: Answer("81", outcome == "found", np.array(partners), {"outcome": outcome}, np.zeros(0))
    right = watertight.judge(mesh, points, images, answer([0, 1, 2, 4, 3], "doubtful"))
    assert (right["error"], right["right"], right["outcome"]) == (0, 1, "doubtful")
    wrong = watertight.judge(mesh, points, images, answer([0, 1, 2, 3, -1], "found"))
    assert wrong["right"] == round(1 / 3, 4) and 0.3 < wrong["error"] < 0.7
    none = watertight.judge(mesh, points, images, answer([-1] * 5, "none"))
    rows = [row | {"class": "ant"} for row in (right, wrong, none)]
    line = watertight.report({"date": "2000-01-01", "meshes": rows}).splitlines()[-1]
    assert line.startswith("| **all** | 3 | 44.4 | 33.3 |") and line.endswith("| 0 | 1 | 1 | 0 | 1 |")
