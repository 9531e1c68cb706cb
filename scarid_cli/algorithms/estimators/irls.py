"""Iteratively reweighted least squares with Huber's weights (Huber 1964): outliers count less.

Rows whose residual is beyond k deviations of their joint count k over their size; the deviation
is the median absolute one over 0.6745. Holds all rows.
k = 1.345: for 95 % of the efficiency of least squares on normal residuals.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.regression import Rows, joined
from scarid_cli.algorithms.settings import require_positive
from scarid_cli.algorithms.statistics.information import Fit, absorb, empty, solve
from scarid_cli.arrays import Array

ITERATIONS = 100
NORMAL = 0.6744897501960817  # median absolute value of a standard normal variable


@dataclass(frozen=True)
class Estimator:
    k: float = 1.345

    RECURSIVE: ClassVar[bool] = False
    HOLDS: ClassVar[bool] = True

    def __post_init__(self) -> None:
        require_positive(self, "k")

    def init(self, prior: Array) -> list[Rows]:  # noqa: ARG002
        return []

    def step(
        self,
        state: list[Rows],
        rows: Rows,
        *,
        trace: bool = False,  # noqa: ARG002
    ) -> tuple[list[Rows], Array]:
        return [*state, rows], np.empty((0, rows.W.shape[2]))

    def fit(self, state: list[Rows]) -> Fit:
        rows = joined(state)
        scales = rows.scales
        theta = _solved(rows, scales).estimates
        for _ in range(ITERATIONS):
            residual = rows.y - rows.W @ theta
            inverse = 1.0 / deviations(residual, rows.scales)
            size = np.abs(residual) * inverse
            weights = np.minimum(1.0, self.k / np.maximum(size, self.k))
            fit = _solved(rows, rows.scales * np.sqrt(weights) * inverse)
            moved = np.abs(fit.estimates - theta)
            theta = fit.estimates
            if np.all(moved <= 1e-10 * np.abs(theta)):
                break
        return replace(fit, whitening=np.diag(inverse), huber=self.k)


def deviations(residual: Array, scales: Array) -> Array:
    """Of each joint, from the median absolute residual of the rows that count."""
    found = [np.median(np.abs(r[s > 0.0])) for r, s in zip(residual.T, scales.T, strict=True)]
    return np.maximum(np.array(found) / NORMAL, np.finfo(float).tiny)


def _solved(rows: Rows, scales: Array) -> Fit:
    state, _ = absorb(empty(rows.W.shape[2]), rows.W, rows.y, np.ascontiguousarray(scales))
    return solve(state)
