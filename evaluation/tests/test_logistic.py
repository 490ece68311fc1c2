"""Fitting and calibration, on probabilities that are known."""

import numpy as np
import pytest

from evaluation import logistic

TRUE = np.array([-0.5, 1.5, -2.0])


@pytest.fixture(scope="module")
def drawn():
    rng = np.random.default_rng(1)
    features = rng.normal(size=(20000, 2)) * [1, 5] + [2, -3]
    stated = logistic.probability(TRUE * [1, 1, 0.2], features)
    return features, rng.random(len(stated)) < stated


def test_known_weights_come_back(drawn):
    assert logistic.fit(*drawn) == pytest.approx(TRUE * [1, 1, 0.2], abs=0.12)


def test_balanced_classes_move_the_constant_only(drawn):
    features, right = drawn
    plain, even = logistic.fit(features, right), logistic.fit(features, right, logistic.balanced(right))
    assert even[0] - plain[0] == pytest.approx(np.log((~right).sum() / right.sum()), abs=0.25)
    assert even[1:] == pytest.approx(plain[1:], abs=0.1)


def test_classes_without_overlap_stay_finite():
    features = np.r_[np.linspace(-2, -1, 50), np.linspace(1, 2, 50)][:, None]
    weights = logistic.fit(features, features[:, 0] > 0)
    assert np.isfinite(weights).all() and weights[1] > 1


def test_a_fitted_model_is_calibrated_and_a_boastful_one_is_not(drawn):
    features, right = drawn
    stated = logistic.cross_validated(features, right, np.arange(len(right)) // 10)
    assert logistic.calibration_error(stated, right) < 0.02
    assert logistic.calibration_error(np.sqrt(stated), right) > 0.04
    assert sum(count for _, _, count in logistic.calibration_table(stated, right)) == len(right)


def test_cross_validation_never_sees_the_group():
    group = np.arange(40) // 10
    right = np.arange(40) % 2 == 0
    features = np.where(right, 1.0, -1.0)[:, None] * np.where(group < 3, 1, -1)[:, None]
    stated = logistic.cross_validated(features, right, group)
    assert ((stated[group == 3] > 0.5) != right[group == 3]).all()  # what the others teach is false of the fourth


def test_area_under_the_curve_counts_pairs():
    score, right = np.array([0.9, 0.8, 0.8, 0.1]), np.array([True, True, False, False])
    assert logistic.area_under_curve(score, right) == pytest.approx((1 + 1 + 0.5 + 1) / 4)
    assert np.isnan(logistic.area_under_curve(score, np.ones(4, bool)))


def test_the_sources_hold_as_many_weights_as_the_scripts_fit():
    from evaluation import acceptance, confidence

    assert len(logistic.rust_weights(confidence.SOURCE)) == len(confidence.FEATURES) + 1
    for model, (columns, _) in acceptance.MODELS.items():
        assert len(logistic.rust_weights(acceptance.SOURCE, model)) == len(columns) + 1
    assert {column for columns, _ in acceptance.MODELS.values() for column in columns} == set(range(len(acceptance.FEATURES)))
