"""Bad input comes back as an exception with the library's text."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import intrinsym
from intrinsym import ArgumentError, MeshError, MeshFileError, ModelError, OptionError

POINTS = np.eye(4, 3)
FACES = np.array([[0, 1, 2], [0, 2, 3]])


@pytest.mark.parametrize(
    ("vertices", "faces", "error", "text"),
    [
        (POINTS, [[0, 1, 9]], MeshError, "face 0 refers to vertex 9"),
        (POINTS, [[0, 1, 2], [0, 2, -1]], MeshError, "face 1 has the index -1"),
        (POINTS, np.array([[0, 1, 2**32 + 1]]), MeshError, "face 0 has the index 4294967297"),
        (POINTS * [1, np.nan, 1], FACES, MeshError, "vertex 0"),
        (POINTS * 0, FACES, MeshError, "area"),
        (np.zeros((0, 3)), np.zeros((0, 3), int), MeshError, "no vertices"),
        (POINTS[:, :2], FACES, ArgumentError, r"vertices has the shape \(4, 2\)"),
        (POINTS, FACES[:, :2], ArgumentError, r"faces has the shape \(2, 2\)"),
        (POINTS, [[0, 1, 2], [0, 2, 3, 1]], ArgumentError, "face is no array: .*inhomogeneous"),
        (POINTS, FACES.astype(float), ArgumentError, "float64; whole numbers"),
        (POINTS.astype(complex), FACES, ArgumentError, "complex128; real numbers"),
        (POINTS, intrinsym.Polygons([0, 3, 2], [0, 1, 2]), MeshError, "face offsets decrease after face 1"),
        (POINTS, intrinsym.Polygons([0, 4], [0, 1, 2]), MeshError, "last face offset is 4"),
        (POINTS, intrinsym.Polygons([], []), MeshError, "no faces"),
        (POINTS, intrinsym.Polygons([0, 3], [[0, 1, 2]]), ArgumentError, "flat"),
    ],
)
def test_meshes(vertices, faces, error, text):
    with pytest.raises(error, match=text):
        intrinsym.Mesh(vertices, faces)


@pytest.mark.parametrize(
    ("arguments", "error", "text"),
    [
        ({"sampels": 3}, TypeError, "unexpected keyword argument 'sampels'"),
        ({"samples": 7}, OptionError, "option samples"),
        ({"samples": 200.5}, OptionError, "not a whole number"),
        ({"samples": "many"}, OptionError, "'many' is not a number"),
        ({"threads": "two"}, OptionError, "option threads: 'two' is not a number"),
        ({"threads": [2]}, OptionError, "is not a number"),
        ({"threads": 10**400}, OptionError, "is not a number"),
        ({"effort": "hard"}, OptionError, "one of fast, default, thorough"),
        ({"known_signs": [1, 2]}, OptionError, "known_signs"),
        ({"known_signs": [1, 300]}, ArgumentError, "known_signs"),
        ({"model": "no/such.onnx"}, ModelError, "no/such.onnx: cannot be read"),
    ],
)
def test_options(quadruped, arguments, error, text):
    with pytest.raises(error, match=text):
        quadruped.detect(**arguments)


def test_masked_arrays(symmetry):
    masked = np.ma.masked_invalid(POINTS * [1, np.nan, 1])
    with pytest.raises(ArgumentError, match="vertices has 4 masked entries; fill or remove them"):
        intrinsym.Mesh(masked, FACES)
    with pytest.raises(ArgumentError, match="face has 1 masked entries"):
        intrinsym.Mesh(POINTS, np.ma.masked_equal(FACES, 3))
    weights = np.ma.masked_equal(np.arange(3398), 7)
    for tool in (symmetry.mirror_values, symmetry.mirror_selection, symmetry.mirror_face_selection):
        with pytest.raises(ArgumentError, match="1 masked entries"):
            tool(weights)
    assert intrinsym.Mesh(masked.filled(0.5), FACES).vertices[0, 1] == 0.5
    assert intrinsym.Mesh(np.ma.masked_array(POINTS), np.ma.masked_array(FACES)).face_count == 2


def test_files(tmp_path):
    with pytest.raises(MeshFileError, match="no.ply: cannot be read"):
        intrinsym.Mesh.read(tmp_path / "no.ply")
    (tmp_path / "bad.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 x\n3 0 1 2\n")
    with pytest.raises(MeshFileError, match="line 5"):
        intrinsym.Mesh.read(tmp_path / "bad.off")


def test_tools(symmetry):
    with pytest.raises(ArgumentError, match="one row for each of 3398 vertices"):
        symmetry.mirror_values(np.zeros(5))
    with pytest.raises(ArgumentError, match=r"\(3398, 3\) is needed"):
        symmetry.carry_displacement(np.zeros((3398, 3)), np.zeros((3398, 2)))
    with pytest.raises(OptionError, match="minimum_confidence"):
        symmetry.mirror_selection(np.zeros(3398), minimum_confidence=2)
    with pytest.raises(ArgumentError, match="ISYM_MERGE_"):
        symmetry.mirror_values(np.zeros(3398), 9)
    with pytest.raises(ArgumentError, match="merge is 'swap', which is no Merge"):
        symmetry.mirror_values(np.zeros(3398), "swap")


@pytest.mark.parametrize("count", [0, -1, 1001])
def test_counts_of_eigenpairs(quadruped, count):
    with pytest.raises(ArgumentError, match="count"):
        quadruped.eigen(count)


def test_errors_can_be_pickled():
    error = pickle.loads(pickle.dumps(MeshError("face 3", 16)))
    assert isinstance(error, MeshError) and str(error) == "face 3" and error.status == 16


def test_a_path_with_a_nul_is_refused():
    with pytest.raises(ArgumentError, match=r"'a\.ply\\x00b\.ply' holds a NUL"):
        intrinsym.Mesh.read("a.ply\0b.ply")


def test_what_holds_arrays_is_equal_to_itself_alone():
    pairs = intrinsym.eigen(POINTS, FACES, 1)
    assert pairs == pairs
    assert pairs != intrinsym.eigen(POINTS, FACES, 1)
