"""From shapes to a model file: generator, the core's eigenfunctions, labels, training, export."""

import numpy as np
import pytest

from training import data, dataset, eigenbasis, evaluate, export, train
from training.network import DESIGNS, Design

TINY = Design((8, 16), (8,), points=128, dropout=0.0)
SHAPES = 12


def core_is_built() -> bool:
    try:
        return bool(eigenbasis.command())
    except FileNotFoundError:
        return False


pytestmark = pytest.mark.skipif(not core_is_built(), reason="needs the command line: cargo build --release")


@pytest.fixture(scope="module")
def training_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("data") / "shapes.npz"
    assert dataset.build(range(SHAPES), 5, path) > SHAPES / 2
    return path


def test_labels_of_generated_shapes_are_correlations(training_file):
    shapes = data.load([training_file])
    asymmetric = np.isin(shapes.kind, ["asymmetric-tree", "unbalanced"])
    assert np.abs(shapes.labels).max() <= 1 + 1e-6
    assert (np.abs(shapes.labels[~asymmetric]) > data.CLEAR).mean() > 0.5
    assert not shapes.labels[asymmetric].any()


def test_a_tiny_run_from_shapes_to_a_model(training_file, tmp_path, monkeypatch):
    shapes = data.load([training_file])
    parameters, statistics, losses = train.train(TINY, shapes, steps=200, seed=0, rate=1e-2, batch=32)
    assert losses[-40:].mean() < 0.9 * losses[:20].mean()
    monkeypatch.setitem(DESIGNS, "tiny", TINY)
    train.save(tmp_path / "net.npz", "tiny", parameters, statistics)
    assert export.export(tmp_path / "net.npz", tmp_path / "net.onnx") < export.TOLERANCE
    entries = evaluate.on_shapes(evaluate.Model(tmp_path / "net.onnx"), shapes)
    assert np.allclose(entries.probabilities.sum(-1), 1, atol=1e-5)
    assert evaluate.accuracy(entries, np.ones(len(shapes), bool), evaluate.UNAMBIGUOUS)[0] > 0.6


def test_a_record_depends_on_seed_and_index_only(training_file):
    again = dataset.Maker(5, None).record(0)
    assert np.array_equal(data.load([training_file]).samples[0], again[0])
