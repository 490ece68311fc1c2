"""A tiny training run end to end: invariance, falling loss, export, the same numbers in ONNX Runtime."""

import hashlib
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import onnx
import onnxruntime
import pytest

from training import data, evaluate, export, network, train
from training.network import DESIGNS, Design, apply, create

SHIPPED = Path(__file__).parents[2] / "models" / "signnet.onnx"
TINY = Design((8, 16), (8,), points=128, dropout=0.0)


@pytest.fixture(scope="module")
def shapes():
    """Closed curves in function space whose parities are known: no eigen-solver is needed here."""
    rng = np.random.default_rng(0)
    samples, correlation = [], []
    for _ in range(60):
        t = rng.uniform(-np.pi, np.pi, 256)  # the mirror map is t -> -t
        parity = rng.choice([1.0, -1.0], 17)
        waves = [np.cos(n * t) + rng.normal() * 0.3 * np.cos(2 * n * t) if p > 0 else np.sin(n * t)
                 for n, p in zip(rng.integers(1, 5, 17), parity)]
        samples.append(np.stack(waves, 1))
        correlation.append(parity)
    return data.Shapes(np.array(samples, np.float32), np.zeros((60, 256, 3), np.float32), np.array(correlation), np.array(["wave"] * 60))


@pytest.fixture(scope="module")
def trained(shapes):
    return train.train(TINY, shapes, steps=150, seed=0, rate=1e-2, batch=32)


def test_the_loss_falls(trained):
    losses = trained[2]
    assert losses[-20:].mean() < 0.7 * losses[:20].mean()


def test_training_is_deterministic(shapes, trained):
    again = train.train(TINY, shapes, steps=20, seed=0, batch=32)[2]
    first = train.train(TINY, shapes, steps=20, seed=0, batch=32)[2]
    assert np.array_equal(again, first)


def test_signs_and_scales_of_the_inputs_change_nothing(trained):
    x = np.random.default_rng(1).normal(size=(12, 128, 4)).astype(np.float32)
    parameters, statistics, _ = trained
    logits = np.asarray(apply(TINY, parameters, statistics, x)[0])
    for flips in np.ndindex(2, 2, 2, 2):
        flipped = np.asarray(apply(TINY, parameters, statistics, x * (1 - 2 * np.array(flips, np.float32)))[0])
        assert np.abs(flipped - logits).max() < 1e-5
    scaled = np.asarray(apply(TINY, parameters, statistics, x * np.array([3, 0.1, 7, 20], np.float32))[0])
    assert np.abs(scaled - logits).max() < 1e-3


def test_exported_model_equals_the_framework(tmp_path, monkeypatch, trained):
    monkeypatch.setitem(DESIGNS, "tiny", TINY)
    train.save(tmp_path / "net.npz", "tiny", trained[0], trained[1])
    assert export.export(tmp_path / "net.npz", tmp_path / "net.onnx") < export.TOLERANCE
    for line in (tmp_path / "net.sha256").read_text().splitlines():
        digest, name = line.split()
        assert hashlib.sha256((tmp_path / name).read_bytes()).hexdigest() == digest
    weights = np.fromfile(tmp_path / "net.weights", "<f4")
    assert len(weights) == network.parameter_count(trained[0]) - (8 + 16 + 8)  # the scales are folded in
    session = onnxruntime.InferenceSession(tmp_path / "net.onnx")
    assert session.get_inputs()[0].shape == [TINY.signs, 128, 4] and session.get_outputs()[0].shape == [TINY.signs, 3]


def test_winners_have_the_value_and_gradient_of_the_plain_maximum():
    design = Design((8, 16), (8,), points=128)
    parameters, statistics = create(design, 0)
    x = jnp.asarray(np.random.default_rng(2).normal(size=(5, 128, 4)), jnp.float32)
    weight = jnp.asarray(np.random.default_rng(3).normal(size=16), jnp.float32)

    def plain(layers):
        return (network._run_stack(layers, statistics["point"], x, False)[0].max(-2) @ weight).sum()

    def sparse(layers):
        return (network.pooled_by_winners(layers, statistics["point"], x) @ weight).sum()

    value, slope = jax.value_and_grad(plain)(parameters["point"])
    value_sparse, slope_sparse = jax.value_and_grad(sparse)(parameters["point"])
    assert value_sparse == pytest.approx(float(value), rel=1e-5)
    for a, b in zip(jax.tree.leaves(slope), jax.tree.leaves(slope_sparse)):
        assert np.abs(a).max() > 0 and np.allclose(a, b, atol=1e-4 * np.abs(a).max())


@pytest.mark.parametrize("name", ["paper", "pointnet", "diag", "positions", "t2", "t4"])
def test_every_design_gives_logits(name):
    design = DESIGNS[name]
    parameters, statistics = create(design, 0)
    x = np.random.default_rng(0).normal(size=(2, 64, design.channels)).astype(np.float32)
    assert apply(design, parameters, statistics, x)[0].shape == (2, design.outputs)


def test_the_temperature_mends_overconfidence():
    rng = np.random.default_rng(0)
    correlation = rng.choice([1.0, -1.0], (400, 12))
    logits = np.stack([correlation, -correlation, np.full(correlation.shape, -9.0)], -1) * 8
    wrong = rng.random(correlation.shape) < 0.2
    logits[wrong] = logits[wrong][:, [1, 0, 2]]
    factor = train.temperature(logits, correlation)
    assert evaluate.softmax(logits * factor).max(-1).mean() == pytest.approx(0.8, abs=0.03)


def test_calibration_error_of_a_known_case():
    error, bins = evaluate.reliability(np.array([0.9, 0.9, 0.6, 0.6]), np.array([1.0, 1.0, 1.0, 0.0]))
    assert error == pytest.approx(0.1) and len(bins) == 2


def test_systematic_samples_follow_the_area():
    assert list(evaluate.systematic_samples(np.array([1.0, 3, 0, 4]), 8)) == [0, 1, 1, 1, 3, 3, 3, 3]


def test_the_weights_that_ship_are_the_models():
    assert SHIPPED.with_suffix(".weights").read_bytes() == export.weights_of(onnx.load(SHIPPED))


def test_the_model_file_that_ships_runs():
    session = onnxruntime.InferenceSession(SHIPPED)
    signs, points, channels = session.get_inputs()[0].shape
    x = np.random.default_rng(0).normal(size=(signs, points, channels)).astype(np.float32)
    flipped = x * np.array([-1, 1, -1, -1], np.float32)
    first, second = (session.run(None, {"eigenfunctions": values})[0] for values in (x, flipped))
    assert first.shape == (signs, 3) and np.abs(first - second).max() < 1e-5


def test_turning_keeps_distances_and_turns_each_shape_its_own_way():
    rng = np.random.default_rng(3)
    positions = rng.normal(size=(5, 40, 3)).astype(np.float32)
    shapes = data.Shapes(np.zeros((5, 40, 4)), positions, np.zeros((5, 4)), np.array(["wave"] * 5))
    turned = data.turned(shapes, 0).positions
    distances = [np.linalg.norm(p[:, 1:] - p[:, :-1], axis=-1) for p in (positions, turned)]
    np.testing.assert_allclose(distances[0], distances[1], rtol=1e-5)
    change = [np.linalg.lstsq(before, after, rcond=None)[0] for before, after in zip(positions, turned)]
    assert min(np.abs(change[i] - change[j]).max() for i in range(5) for j in range(i)) > 0.1
