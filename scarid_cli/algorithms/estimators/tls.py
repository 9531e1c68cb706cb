"""Total least squares (Golub and Van Loan 1980), for errors in the regressor and in the torque.

The estimates come from the singular vector of [W y] that belongs to the smallest singular value.
Each column is divided by its norm first, so all columns are assumed to have the same relative
error. One pass over the rows is enough, because their triangular factor has the same singular
vectors. The first-order covariance is that of Van Huffel and Vandewalle (1991, section 8.5).
No settings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.estimators import ls
from scarid_cli.algorithms.regression.estimation import Estimation
from scarid_cli.algorithms.regression.information import (
    Fit,
    Information,
    NotIdentifiableError,
    solve,
)


@dataclass(frozen=True)
class Estimator(ls.Estimator):
    def fit(self, state: Information) -> Estimation:
        plain = solve(state)  # refuses what is not identifiable
        p = state.parameters
        triangle = np.vstack((state.triangle, np.append(np.zeros(p), np.sqrt(state.residual))))
        norms = np.sqrt((triangle**2).sum(axis=0))
        norms[norms == 0.0] = 1.0
        _, singular, directions = np.linalg.svd(triangle / norms)
        last = directions[-1]
        W = triangle[:, :p] / norms[:p]
        spread = singular[-1] ** 2
        _, own, free = np.linalg.svd(W)
        if not own[-1] ** 2 - spread > p * np.finfo(float).eps:  # no unique solution
            raise NotIdentifiableError(free[-1] / norms[:p])
        gram = np.linalg.inv(W.T @ W - spread * np.eye(p))
        scaled = -last[:p] / last[p]
        unit = gram + spread * gram @ gram * (1.0 + scaled @ scaled)
        rescale = norms[p] / norms[:p]
        freedom = max(state.weight - p, 1.0)
        fit = Fit(
            estimates=scaled * rescale,
            unit_covariance=unit * np.outer(rescale, rescale),
            variance=(1.0 + scaled @ scaled) * spread / freedom,
            condition=plain.condition,
        )
        return Estimation(fit, scores=None)
