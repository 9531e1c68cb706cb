"""Maximum likelihood for normal torque noise with an unknown covariance between the joints.

It alternates between the covariance of the residuals and generalised least squares (Zellner 1962;
iterated as by Oberhofer and Kmenta 1974). If the row of one joint is left out, the whole sample is
left out. All rows are held in memory. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.regression.estimation import Estimation, HoldingEstimator, Scores
from scarid_cli.algorithms.regression.information import Fit, least_squares
from scarid_cli.algorithms.regression.rows import Rows, joined
from scarid_cli.arrays import Array

ITERATIONS = 100
LEAST = 1e-6  # the smallest standard deviation of the noise, relative to the largest


@dataclass(frozen=True)
class Estimator(HoldingEstimator):
    def fit(self, state: list[Rows]) -> Estimation:
        rows = joined(state)
        whole = (rows.scales > 0.0).all(axis=1)
        W, y = rows.W[whole], rows.y[whole]
        whitening = np.eye(y.shape[1])
        theta = np.zeros(W.shape[2])
        for _ in range(ITERATIONS):
            fit = _solved(W, y, whitening)
            moved = np.abs(fit.estimates - theta)
            theta = fit.estimates
            residual = y - W @ theta
            covariance = _definite(residual.T @ residual / max(len(y), 1))
            whitening = np.linalg.inv(np.linalg.cholesky(covariance))
            if np.all(moved <= 1e-10 * np.abs(theta)):
                break
        scores = Scores(whitening=whitening)
        return Estimation(fit, scores, extra={"noise_covariance": covariance.tolist()})


def _definite(covariance: Array) -> Array:
    """The covariance, with a little noise added to every joint if it is singular.

    A joint that is fitted exactly (torques without noise) must not outweigh all others.
    """
    variances = np.linalg.eigvalsh(covariance)
    least = LEAST**2 * variances[-1] or 1.0
    if variances[0] > least:
        return covariance
    return np.asarray(covariance + least * np.eye(len(covariance)), dtype=np.float64)


def _solved(W: Array, y: Array, whitening: Array) -> Fit:
    return least_squares(np.einsum("ij,kjp->kip", whitening, W), y @ whitening.T)
