"""Maximum likelihood for normal torque noise with an unknown covariance between the joints.

Alternates between the covariance of the residuals and generalised least squares (Zellner 1962,
iterated: Oberhofer and Kmenta 1974). Holds all rows; samples with a row left out are left out.
No settings.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.information import Fit, least_squares
from scarid_cli.algorithms.regression.rows import Held, Rows, joined
from scarid_cli.arrays import Array

ITERATIONS = 100


@dataclass(frozen=True)
class Estimator(Held):
    def fit(self, state: list[Rows]) -> Fit:
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
            covariance = residual.T @ residual / max(len(y), 1)
            whitening = np.linalg.inv(np.linalg.cholesky(covariance))
            if np.all(moved <= 1e-10 * np.abs(theta)):
                break
        return replace(fit, whitening=whitening, extra={"noise_covariance": covariance.tolist()})


def _solved(W: Array, y: Array, whitening: Array) -> Fit:
    return least_squares(np.einsum("ij,kjp->kip", whitening, W), y @ whitening.T)
