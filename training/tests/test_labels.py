"""Parity labels: computed, read from people's files, read from the authors' files."""

import numpy as np
import pytest
from scipy.io import savemat

from training import labels
from training.data import targets
from training.dataset import EIGENFUNCTIONS, parity_labels
from training.eigenbasis import Eigenbasis, without_constant
from training.meshfile import write_ply

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def test_parity_of_even_odd_and_neither():
    angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    functions = np.c_[np.cos(angle), np.sin(angle), np.cos(angle + np.pi / 4)]
    mirror = (-np.arange(200)) % 200
    assert np.allclose(parity_labels(functions, np.ones(200), mirror), [1, -1, 0], atol=1e-12)


def test_vertices_without_partner_do_not_count():
    functions, mirror = np.array([[1.0], [1.0], [-9.0]]), np.array([1, 0, -1])
    assert parity_labels(functions, np.ones(3), mirror)[0] == pytest.approx(1)
    assert parity_labels(functions, np.ones(3), np.full(3, -1))[0] == 0


def test_targets_are_probabilities():
    wanted = targets(np.array([0.9, -0.9, 0.1, 0.65]))
    assert np.allclose(wanted, [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0, 0.5]], atol=1e-6)


def test_the_constant_is_dropped():
    mass = np.array([1.0, 1, 1, 1]) / 4
    functions = np.c_[np.ones(4), [1, -1, 1, -1], [1, 1, -1, -1.0]]
    basis = without_constant(np.array([0, 1.0, 2]), functions, mass, 2)
    assert np.array_equal(basis.eigenvalues, [1, 2]) and basis.eigenfunctions.shape == (4, 2)


def stand_in(vertices, faces, count):
    """Any functions do: these tests read labels."""
    functions = np.random.default_rng(0).normal(size=(len(vertices), count))
    return Eigenbasis(np.arange(1.0, count + 1), functions, np.ones(len(vertices)))


def test_peoples_labels_are_read_with_their_mesh(tmp_path):
    write_ply(tmp_path / "shape.ply", VERTICES, FACES)
    labels.write(tmp_path / "shape.labels.json", "shape.ply", labels.mesh_hash(VERTICES, FACES),
                 {1: "even", 2: "odd", 7: "neither"})
    shapes = labels.of_people(tmp_path, stand_in)
    assert np.array_equal(shapes.labels[0, [0, 1, 6]], [1, -1, 0])
    assert np.isnan(shapes.labels[0, 2]) and len(shapes.pairs(12)) == 3


def test_a_changed_mesh_is_refused(tmp_path):
    write_ply(tmp_path / "shape.ply", VERTICES * 2, FACES)
    labels.write(tmp_path / "shape.labels.json", "shape.ply", labels.mesh_hash(VERTICES, FACES), {1: "even"})
    with pytest.raises(labels.LabelFileError, match="hash differs"):
        labels.of_people(tmp_path, stand_in)


@pytest.mark.parametrize("text", ["", "[]", '{"format": "other", "version": 1}', '{"format": "intrinsym-labels", "version": 2}',
    '{"format": "intrinsym-labels", "version": 1, "mesh": "m", "mesh_hash": "h", "labels": {"1": "up"}}',
    '{"format": "intrinsym-labels", "version": 1, "mesh": "m", "mesh_hash": "h", "labels": {"0": "even"}}'])
def test_bad_label_files_are_named(tmp_path, text):
    path = tmp_path / "bad.labels.json"
    path.write_text(text)
    with pytest.raises(labels.LabelFileError, match="bad.labels.json"):
        labels.read(path)


def test_the_authors_files_are_read(tmp_path):
    functions = np.random.default_rng(1).normal(size=(50, 17))
    sign = np.array([1, -1, 0] * 6)[:17]
    savemat(tmp_path / "cat.mat", {"model_evecs": functions, "model_sign": sign[:, None]})
    shapes = labels.authors(tmp_path)
    assert np.array_equal(shapes.labels[0], sign[:EIGENFUNCTIONS])
    assert shapes.samples.shape[2] == EIGENFUNCTIONS


def test_the_authors_names_say_the_class():
    names = ["shrec07_1_anno", "shrec07_180_anno", "shrec07_281_anno", "shrec07_400_anno", "scape_mesh061_anno", "90_anno"]
    assert [labels.authors_kind(name) for name in names] == ["human", "teddy", "armadillo", "fourleg", "scape", "people"]


def test_an_authors_file_without_signs_is_refused(tmp_path):
    savemat(tmp_path / "cat.mat", {"model_evecs": np.zeros((50, 17))})
    with pytest.raises(labels.LabelFileError, match="model_sign"):
        labels.authors(tmp_path)
