"""Least squares by streaming orthogonal factorisation (paper eq. 25), never normal equations.

Memory does not depend on the number of rows. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from scarid_cli.algorithms.regression.information import Fit, Information, absorb, empty, solve
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Estimator:
    RECURSIVE: ClassVar[bool] = False
    HOLDS: ClassVar[bool] = False

    def init(self, prior: Array) -> Information:
        """Of the initial parameters only their number counts."""
        return empty(len(prior))

    def step(
        self,
        state: Information,
        rows: Rows,
        *,
        trace: bool = False,  # noqa: ARG002
    ) -> tuple[Information, Array]:
        return absorb(state, rows.W, rows.y, rows.scales)

    def fit(self, state: Information) -> Fit:
        return solve(state)
