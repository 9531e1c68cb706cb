"""Rows of a regression with known parameters, and what an estimator makes of them."""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation
from scarid_cli.algorithms.regression.information import Fit
from scarid_cli.algorithms.regression.rows import Rows, plain
from scarid_cli.arrays import Array

THETA = np.array([3.0, -2.0, 0.5, 10.0])
P = len(THETA)


def data(samples: int, joints: int = 2, noise: float = 0.1, seed: int = 0) -> tuple[Array, Array]:
    """W (samples, joints, P) and y (samples, joints) with white noise."""
    rng = np.random.default_rng(seed)
    W = rng.standard_normal((samples, joints, P))
    return W, W @ THETA + noise * rng.standard_normal((samples, joints))


def estimated(estimator: BaseEstimator, rows: Rows, initial: Array | None = None) -> Estimation:
    """What the estimator finds in these rows."""
    start = np.zeros(rows.W.shape[2]) if initial is None else initial
    return estimator.fit(estimator.step(estimator.init(start), rows)[0])


def fitted(estimator: BaseEstimator, W: Array, y: Array, prior: Array | None = None) -> Fit:
    """The numbers of it."""
    return estimated(estimator, plain(W, y), prior).fit
