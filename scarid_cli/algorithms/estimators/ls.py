"""Least squares by streaming orthogonal factorisation (paper eq. 25), without normal equations.

The memory that it needs does not depend on the number of rows. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass

from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation
from scarid_cli.algorithms.regression.information import Information, absorb, empty, solve
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Estimator(BaseEstimator):
    def init(self, initial: Array) -> Information:
        """The state before the first row; only the number of the initial parameters matters."""
        return empty(len(initial))

    def step(
        self,
        state: Information,
        rows: Rows,
        *,
        trace: bool = False,  # noqa: ARG002
    ) -> tuple[Information, Array]:
        return absorb(state, rows.W, rows.y, rows.scales)

    def fit(self, state: Information) -> Estimation:
        return Estimation(solve(state))
