"""Recursive least squares with a constant forgetting factor (paper section 2.3).

In square-root information form: the covariance stays symmetric positive definite, and finite
where forgetting meets no excitation.
forgetting = 1: forgetting factor per sample, in (0, 1].
p0 = 100: initial covariance, P0 = p0 I.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.settings import require_positive
from scarid_cli.algorithms.statistics.information import Fit, Information, absorb, prior, solve
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

# What forgetting leaves of the square root of the initial information.
FADED = 1e-4


@dataclass(frozen=True)
class Estimator:
    forgetting: float = 1.0
    p0: float = 100.0

    RECURSIVE: ClassVar[bool] = True

    def __post_init__(self) -> None:
        require_positive(self, "forgetting", "p0")
        if self.forgetting > 1.0:
            raise UsageFault(f"forgetting must not exceed 1, not {self.forgetting:g}")

    def init(self, initial: Array) -> Information:
        return prior(initial, self.p0)

    def step(
        self, state: Information, W: Array, y: Array, *, trace: bool
    ) -> tuple[Information, Array]:
        floor = FADED / np.sqrt(self.p0)
        return absorb(state, W, y, forgetting=self.forgetting, floor=floor, trace=trace)

    def fit(self, state: Information) -> Fit:
        return solve(state)
