"""Recursive least squares with forgetting (paper section 2.3; several factors: section 5).

The recursion is in factored information form: the covariance stays symmetric and positive definite,
and it stays bounded when the filter forgets without excitation.
forgetting = 1: forgetting factor per sample, in (0, 1]; one, or one per parameter.
p0 = 100: initial covariance, P0 = p0 I.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation, Scores
from scarid_cli.algorithms.regression.information import Information, absorb, prior, solve
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

FADED = 1e-10  # the part of the initial information that forgetting leaves in the long run


@dataclass(frozen=True)
class Estimator(BaseEstimator):
    forgetting: float | tuple[float, ...] = 1.0
    p0: float = 100.0

    RECURSIVE: ClassVar[bool] = True
    INITIAL: ClassVar[bool] = True

    def check(self) -> None:
        require_positive(self, "p0")
        for factor in self.factors:
            if not factor > 0.0:
                raise UsageFault(f"forgetting must be positive, not {factor:g}")
            if not factor <= 1.0:
                raise UsageFault(f"forgetting must not exceed 1, not {factor:g}")

    @property
    def factors(self) -> tuple[float, ...]:
        return self.forgetting if isinstance(self.forgetting, tuple) else (self.forgetting,)

    def init(self, initial: Array) -> Information:
        if len(self.factors) not in (1, len(initial)):
            raise UsageFault(
                f"forgetting: {len(self.factors)} factors for {len(initial)} parameters; give one "
                "factor, or one per parameter"
            )
        return prior(initial, self.p0)

    def step(
        self, state: Information, rows: Rows, *, trace: bool = False
    ) -> tuple[Information, Array]:
        return absorb(
            state,
            rows.W,
            rows.y,
            rows.scales,
            forgetting=np.resize(self.factors, state.parameters),
            floor=FADED / self.p0,
            trace=trace,
        )

    def widened(self) -> Estimator:
        """The estimator with one more factor: the delay is forgotten as slowly as any parameter."""
        if not isinstance(self.forgetting, tuple):
            return self
        return replace(self, forgetting=(*self.forgetting, max(self.forgetting)))

    def fit(self, state: Information) -> Estimation:
        return Estimation(solve(state), Scores(forgetting=min(self.factors)))
