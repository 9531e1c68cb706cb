"""Recursive least squares with forgetting (paper section 2.3; several factors: section 5).

The recursion is in factored information form: the covariance stays symmetric and positive definite,
and it stays bounded when the filter forgets without excitation. Each row is weighted by the
running residual of its joint, as wls does at the end, so that a joint with torques of hundreds of
N m does not drown out one with 1 N m.
forgetting = 1: forgetting factor per sample, in (0, 1]; one, or one per parameter.
p0 = 100: initial covariance, P0 = p0 I.
weights = 1: 0 to weight the rows of all joints alike.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.settings import require_between, require_positive
from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation, Scores
from scarid_cli.algorithms.regression.information import (
    RUNNING,
    Information,
    absorb,
    inverse_deviations,
    prior,
    solve,
)
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

SUM, COUNT = 0, 1  # of the running residual of a joint
BANDWIDTH = 10.0  # Hz, of the torque of a robot: rows within half a period are much alike
FADED = 1e-10  # the part of the initial information that forgetting leaves in the long run


@dataclass(frozen=True)
class WeightedInformation:
    """The information so far, and the running residuals (joints, RUNNING); none to weight alike.

    The number of joints is known only with the first rows.
    """

    information: Information
    residuals: Array


@dataclass(frozen=True)
class Estimator(BaseEstimator):
    forgetting: float | tuple[float, ...] = 1.0
    p0: float = 100.0
    weights: int = 1

    RECURSIVE: ClassVar[bool] = True
    INITIAL: ClassVar[bool] = True

    def check(self) -> None:
        require_positive(self, "p0")
        require_between(self, 0, 1, "weights")
        for factor in self.factors:
            if not factor > 0.0:
                raise UsageFault(f"forgetting must be positive, not {factor:g}")
            if not factor <= 1.0:
                raise UsageFault(f"forgetting must not exceed 1, not {factor:g}")

    @property
    def factors(self) -> tuple[float, ...]:
        return self.forgetting if isinstance(self.forgetting, tuple) else (self.forgetting,)

    def init(self, initial: Array) -> WeightedInformation:
        if len(self.factors) not in (1, len(initial)):
            raise UsageFault(
                f"forgetting: {len(self.factors)} factors for {len(initial)} parameters; give one "
                "factor, or one per parameter"
            )
        return WeightedInformation(prior(initial, self.p0), np.zeros((0, RUNNING)))

    def step(
        self, state: WeightedInformation, rows: Rows, *, trace: bool = False
    ) -> tuple[WeightedInformation, Array]:
        joints = rows.y.shape[1]
        weighted = self.weights and joints > 1
        residuals = state.residuals.copy()
        if weighted and not len(residuals):
            residuals = np.zeros((joints, RUNNING))
        information, estimates = absorb(
            state.information,
            rows.W,
            rows.y,
            rows.scales,
            forgetting=np.resize(self.factors, state.information.parameters),
            floor=FADED / self.p0,
            residuals=residuals,
            apart=_rows_apart(rows.h),
            trace=trace,
        )
        return WeightedInformation(information, residuals), estimates

    def widened(self, columns: int) -> Estimator:
        """The estimator with more factors: new parameters are forgotten as slowly as any other."""
        if not isinstance(self.forgetting, tuple):
            return self
        return replace(self, forgetting=(*self.forgetting, *[max(self.forgetting)] * columns))

    def fit(self, state: WeightedInformation) -> Estimation:
        whitening = None
        if len(state.residuals):
            counts = np.maximum(state.residuals[:, COUNT], 1.0)
            deviations = np.sqrt(state.residuals[:, SUM] / counts)
            whitening = np.diag(inverse_deviations(deviations))
        scores = Scores(whitening=whitening, forgetting=min(self.factors))
        return Estimation(solve(state.information), scores)


def _rows_apart(h: float) -> float:
    """How many rows, sampled every h [s], there are for one that is independent; at least 1."""
    return max(1.0, 0.5 / (BANDWIDTH * h)) if h > 0.0 else 1.0
