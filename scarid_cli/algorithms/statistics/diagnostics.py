"""The diagnostics of an estimation: robust errors, tests for bias, and residuals of each joint.

Errors and sums of squares are computed from all rows of a record. Everything else is computed from
a subsample if the record is long.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.estimation import Estimation
from scarid_cli.algorithms.regression.information import NotIdentifiableError, least_squares
from scarid_cli.algorithms.regression.rows import Rows, with_delay, without_slow
from scarid_cli.algorithms.statistics.blocks import Blocks
from scarid_cli.algorithms.statistics.jackknife import (
    RobustCovariance,
    inflation,
    jackknife,
    jackknife_of_blocks,
)
from scarid_cli.algorithms.statistics.misalignment import lag_share
from scarid_cli.algorithms.statistics.residuals import JointResidual, residuals
from scarid_cli.arrays import Array

SLOW = 0.1  # of the root-mean-square velocity of a joint: below it, a row counts as slow


@dataclass(frozen=True)
class Diagnostics:
    """What the residuals show about an estimation.

    `covariance` is robust to autocorrelated residuals; it is None for an estimator without scores.
    `errors` (parameters) are its standard errors. Without it they are the standard errors for white
    residuals, multiplied by the ratio of robust to white errors of least squares on the same rows
    (`inflation`). `blocks` is the number of blocks of the record that the errors come from.
    `lag_share` is the part of the residual that the motion 25 ms before and after explains: it is
    near 0 if all signals belong to the same instant, and near 1 if they are misaligned. `moved` is
    the number of standard errors by which each estimate changes when the rows slower than `slow`
    (joints) [rad/s or m/s] are left out and a delay of the torques is fitted as well.
    """

    covariance: RobustCovariance | None
    blocks: int
    errors: Array
    joints: tuple[JointResidual, ...]
    lag_share: float
    moved: Array
    slow: Array

    def part(self, own: int) -> Diagnostics:
        """The diagnostics of the first `own` parameters."""
        covariance = self.covariance and self.covariance.part(own)
        return replace(self, covariance=covariance, errors=self.errors[:own])


def diagnose(
    rows: Rows, found: Estimation, parameters: int, record: Blocks | None = None
) -> Diagnostics:
    """Diagnose an estimation from its rows.

    `record` has the blocks of the whole record if `rows` are only a subsample of it. The first
    `parameters` columns of W belong to the robot; the others are nuisance parameters.
    """
    joints = residuals(rows, found.fit.estimates, record)
    covariance = _covariance(rows, found, record)
    if covariance:
        blocks, errors = covariance.blocks, covariance.errors
    else:
        blocks, errors = _inflated(rows, found, record or Blocks.every(rows.h).add(rows).whole())
    weights = np.array([1.0 / j.deviation if j.deviation > 0.0 else 0.0 for j in joints])
    slow = SLOW * np.sqrt(np.mean(rows.motion[1] ** 2, axis=1))
    fast = without_slow(rows, slow)
    other = with_delay_fitted(fast, found.fit.estimates[:parameters], weights)
    return Diagnostics(
        covariance=covariance,
        blocks=blocks,
        errors=errors,
        joints=joints,
        lag_share=lag_share(fast, weights, parameters),
        moved=_in_errors(other - found.fit.estimates[:parameters], errors[:parameters]),
        slow=slow,
    )


def _in_errors(difference: Array, errors: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(difference == 0.0, 0.0, difference / errors), dtype=np.float64)


def _covariance(rows: Rows, found: Estimation, record: Blocks | None) -> RobustCovariance | None:
    if found.scores is None:
        return None
    return jackknife_of_blocks(record, rows, found) if record else jackknife(rows, found)


def _inflated(rows: Rows, found: Estimation, record: Blocks) -> tuple[int, Array]:
    """The number of blocks, and the standard errors of an estimator without scores."""
    blocks, ratio = inflation(record, rows)
    return blocks, np.asarray(found.fit.standard_errors() * ratio, dtype=np.float64)


def with_delay_fitted(rows: Rows, estimates: Array, weights: Array) -> Array:
    """The estimates when the delay of the torques is fitted as well; nan if that is singular."""
    parameters = len(estimates)
    wide = with_delay(replace(rows, W=rows.W[:, :, :parameters]), estimates)
    try:
        return least_squares(wide.W, wide.y, rows.scales * weights).estimates[:parameters]
    except NotIdentifiableError:
        return np.full(parameters, np.nan)
