"""Least squares with each joint weighted by its residual (Gautier 1997), in one pass.

"Dynamic identification of robots with power model". The standard deviation of a joint's torque is
that of the residual of its own rows, fitted alone. A joint with torques of hundreds of N m does not
hide one with 1 N m. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation, Scores
from scarid_cli.algorithms.regression.information import (
    Information,
    absorb,
    empty,
    merged,
    residual_deviation,
    solve,
)
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.arrays import Array

JointsInformation = tuple[Information, ...]

NOTHING = 1e-150  # a deviation whose square is no number any more


@dataclass(frozen=True)
class Estimator(BaseEstimator):
    def init(self, initial: Array) -> JointsInformation:
        """Of the initial parameters only their number counts: the joints are not known yet."""
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
        found = [
            absorb(part, *(np.ascontiguousarray(x[:, j : j + 1]) for x in _of(rows)))
            for j, part in enumerate(parts)
        ]
        return tuple(part for part, _ in found), np.empty((0, rows.W.shape[2]))

    def fit(self, state: JointsInformation) -> Estimation:
        deviations = np.array([residual_deviation(part) for part in state])
        # A joint that is fitted exactly (no torque at all) must not outweigh all others.
        least = 1e-6 * deviations.max() if deviations.max() > NOTHING else 1.0
        inverse = 1.0 / np.maximum(deviations, least)
        fit = solve(merged(state, inverse.tolist()))
        return Estimation(fit, Scores(whitening=np.diag(inverse)))


def _of(rows: Rows) -> tuple[Array, Array, Array]:
    return rows.W, rows.y, rows.scales
