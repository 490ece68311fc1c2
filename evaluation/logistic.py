"""Logistic regression, and how well stated probabilities hold."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from scipy.optimize import minimize
from scipy.stats import rankdata

# Keeps weights finite where the classes can be told apart without error; too weak to matter elsewhere.
RIDGE = 1e-6


def fit(features: np.ndarray, right: np.ndarray, weight: np.ndarray | None = None) -> np.ndarray:
    """Weights (1 + columns), the constant first, that make `right` most likely; `weight` (n) counts rows."""
    right = right.astype(float)
    weight = np.full(len(right), 1 / len(right)) if weight is None else weight / weight.sum()
    centre, scale = features.mean(0), np.maximum(features.std(0), 1e-12)
    rows = np.c_[np.ones(len(right)), (features - centre) / scale]

    def loss(weights):
        logit = rows @ weights
        value = weight @ (np.logaddexp(0, logit) - right * logit) + RIDGE * weights @ weights
        return value, rows.T @ (weight * (1 / (1 + np.exp(-logit)) - right)) + 2 * RIDGE * weights

    found = minimize(loss, np.zeros(rows.shape[1]), jac=True, method="BFGS").x
    slopes = found[1:] / scale
    return np.r_[found[0] - slopes @ centre, slopes]


def probability(weights: np.ndarray, features: np.ndarray) -> np.ndarray:
    """What the fitted model says of each row."""
    return 1 / (1 + np.exp(-(weights[0] + features @ weights[1:])))


def balanced(right: np.ndarray, share: float = 0.5) -> np.ndarray:
    """Weights that make `right` count `share` of the whole, however many there are."""
    return np.where(right, share / right.sum(), (1 - share) / (~right).sum())


def cross_validated(
    features: np.ndarray, right: np.ndarray, group: np.ndarray, weigh=None, folds: int = 4
) -> np.ndarray:
    """Probability of each row by a model that has not seen the row's group."""
    fold = np.random.default_rng(0).permutation(group.max() + 1)[group] % folds
    stated = np.zeros(len(right))
    for own in range(folds):
        seen = fold != own
        weights = fit(features[seen], right[seen], weigh(right[seen]) if weigh else None)
        stated[~seen] = probability(weights, features[~seen])
    return stated


def area_under_curve(score: np.ndarray, right: np.ndarray) -> float:
    """Chance that a right one scores above a wrong one (area under the receiver operating characteristic)."""
    right = right.astype(bool)
    pairs = right.sum() * (~right).sum()
    above = rankdata(score)[right].sum() - right.sum() * (right.sum() + 1) / 2
    return float(above / pairs) if pairs else float("nan")


def calibration_table(stated: np.ndarray, right: np.ndarray, bins: int = 10) -> list[tuple[float, float, int]]:
    """Mean stated probability, share right, and number of rows of each tenth of 0..=1 that is not empty."""
    index = np.minimum((stated * bins).astype(int), bins - 1)
    chosen = [index == own for own in range(bins)]
    return [
        (float(stated[rows].mean()), float(right[rows].mean()), int(rows.sum())) for rows in chosen if rows.any()
    ]


def calibration_error(stated: np.ndarray, right: np.ndarray) -> float:
    """Expected calibration error over ten bins."""
    return float(
        sum(abs(said - was) * count for said, was, count in calibration_table(stated, right)) / len(stated)
    )


def rust_weights(source: Path, name: str = "WEIGHTS") -> np.ndarray:
    """The numbers of a constant array in a Rust source file."""
    found = re.search(rf"const {name}: \[f64; \d+\] = \[([^\]]*)\]", source.read_text())
    return np.array([float(word) for word in found[1].split(",") if word.strip()])


def weights_table(names: list[str], fitted: np.ndarray, shipped: np.ndarray) -> str:
    """Fitted weights beside those of the source, if these are as many."""
    beside = [f"{value:.3f}" for value in shipped] if len(shipped) == len(fitted) else ["-"] * len(fitted)
    rows = "\n".join(
        f"| {name} | {value:.4f} | {other} |" for name, value, other in zip(["constant", *names], fitted, beside)
    )
    return f"| weight | fitted now | in the source |\n|---|---|---|\n{rows}"
