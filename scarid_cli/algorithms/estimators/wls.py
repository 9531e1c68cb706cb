"""Least squares with each joint weighted by its residual, in one pass.

Gautier, "Dynamic identification of robots with power model" (1997). The standard deviation of a
joint's torque is estimated from a fit of that joint's rows alone. Thus a joint with torques of
hundreds of N m does not drown out one with 1 N m. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation, Scores
from scarid_cli.algorithms.regression.information import (
    Information,
    absorb,
    condensed,
    empty,
    inverse_deviations,
    merged,
    residual_deviation,
    solve,
)
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.arrays import Array

JointsInformation = tuple[Information, ...]


@dataclass(frozen=True)
class Estimator(BaseEstimator):
    def init(self, initial: Array) -> JointsInformation:
        """One part for now: the number of joints is known only with the first rows."""
        return (empty(len(initial)),)

    def step(
        self,
        state: JointsInformation,
        rows: Rows,
        *,
        trace: bool = False,  # noqa: ARG002
    ) -> tuple[JointsInformation, Array]:
        joints = rows.y.shape[1]
        parts = state if len(state) == joints else state * joints
        arrays = (rows.W, rows.y, rows.scales)
        found = [
            absorb(part, *(np.ascontiguousarray(x[:, j : j + 1]) for x in arrays))
            for j, part in enumerate(parts)
        ]
        return tuple(part for part, _ in found), np.empty((0, rows.W.shape[2]))

    def of_rows(
        self,
        rows: Rows,
        initial: Array | None = None,  # noqa: ARG002
    ) -> Estimation:
        return self.fit(
            tuple(
                condensed(rows.W[:, j], rows.y[:, j], rows.scales[:, j])
                for j in range(rows.y.shape[1])
            )
        )

    def fit(self, state: JointsInformation) -> Estimation:
        deviations = np.array([residual_deviation(part) for part in state])
        inverse = inverse_deviations(deviations)
        fit = solve(merged(state, inverse.tolist()))
        return Estimation(fit, Scores(whitening=np.diag(inverse)))
