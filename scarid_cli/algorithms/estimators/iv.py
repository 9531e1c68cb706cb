"""Instrumental variables from the simulated model, IDIM-IV (Janot, Vandanjon and Gautier 2014).

The instruments are the regressor along a noise-free simulation of the robot in closed loop with the
previous estimates, so noise of the measured motion cannot bias the estimates. The log must have the
reference (q1_ref, ...). The controller is that of the robot description, or else the default one of
`simulate`. Joints are weighted by their residuals. The Durbin-Wu-Hausman test against weighted
least squares is reported. All rows are held in memory. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.estimators import wls
from scarid_cli.algorithms.plants.following import simulated
from scarid_cli.algorithms.regression.estimation import Estimation, HoldingEstimator, RobotEstimator
from scarid_cli.algorithms.regression.information import NotIdentifiableError
from scarid_cli.algorithms.regression.rows import Rows, joined
from scarid_cli.algorithms.uncertainty.jackknife import shifts
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

ITERATIONS = 10


@dataclass(frozen=True)
class Estimator(RobotEstimator, HoldingEstimator):
    REFERENCE: ClassVar[bool] = True
    ALIGNS: ClassVar[bool] = False

    def step(
        self, state: list[Rows], rows: Rows, *, trace: bool = False
    ) -> tuple[list[Rows], Array]:
        if rows.reference is None:
            raise UsageFault(
                "iv needs the reference that the robot followed; give a log with the columns "
                "q1_ref, ... and dq1_ref, ..."
            )
        return super().step(state, rows, trace=trace)

    def fit(self, state: list[Rows]) -> Estimation:
        rows = joined(state)
        plain = wls.Estimator().of_rows(rows)
        theta = plain.fit.estimates
        for _ in range(ITERATIONS):
            instruments = simulated(self.robot, theta, rows).W
            found = solved(rows, instruments, plain)
            moved = np.abs(found.fit.estimates - theta)
            theta = found.fit.estimates
            if np.all(moved < 1e-3 * found.fit.standard_errors()):
                break
        statistic, chance = hausman(rows, plain, found)
        return replace(
            found, extra={"durbin_wu_hausman": {"statistic": statistic, "p_value": chance}}
        )


def solved(rows: Rows, instruments: Array, plain: Estimation) -> Estimation:
    """The estimates whose residual is orthogonal to the instruments, weighted as `plain` is."""
    assert plain.scores is not None
    assert plain.scores.whitening is not None
    scales = (rows.scales * np.diag(plain.scores.whitening))[:, :, None]
    p = rows.W.shape[2]
    W, Z = ((x * scales).reshape(-1, p) for x in (rows.W, instruments))
    y = (rows.y[:, :, None] * scales).ravel()
    gram = Z.T @ W
    size = np.sqrt(np.abs(np.diag(gram)))
    if not np.all(size > 0.0) or np.linalg.cond(gram / np.outer(size, size)) > 1e12:
        raise NotIdentifiableError(np.where(size > 0.0, 0.0, 1.0) + (size > 0.0).all())
    theta = np.asarray(np.linalg.solve(gram, Z.T @ y), dtype=np.float64)
    residual = y - W @ theta
    inverse = np.linalg.inv(gram)
    fit = replace(
        plain.fit,
        estimates=theta,
        unit_covariance=inverse @ (Z.T @ Z) @ inverse.T,
        variance=float(residual @ residual) / max(int((scales > 0.0).sum()) - p, 1),
    )
    return Estimation(fit, replace(plain.scores, rows=rows, instruments=instruments))


def hausman(rows: Rows, plain: Estimation, found: Estimation) -> tuple[float, float]:
    """The Durbin-Wu-Hausman test of whether two fits differ by more than chance.

    Returns the statistic and its p-value. The covariance of the difference comes from leaving the
    same blocks out of both fits, so that autocorrelated residuals cause no false alarms; the
    p-value is that of Hotelling's T^2.
    """
    from scipy.special import fdtrc

    difference = found.fit.estimates - plain.fit.estimates
    scatter = shifts(rows, found) - shifts(rows, plain)
    blocks, p = scatter.shape
    covariance = (blocks - 1) / blocks * scatter.T @ scatter
    if blocks <= p or not np.isfinite(covariance).all():
        return float("nan"), float("nan")
    distance = float(difference @ np.linalg.pinv(covariance) @ difference)
    return distance, float(fdtrc(p, blocks - p, distance * (blocks - p) / (p * (blocks - 1))))
