"""Instrumental variables from the simulated model, IDIM-IV (Janot, Vandanjon and Gautier 2014).

The instruments are the regressor along a noise-free simulation of the robot in closed loop with the
previous estimates, so noise of the measured motion cannot bias the estimates. The log must have the
reference (q1_ref, ...). The controller is that of the robot description, or else the default one of
`simulate`. Joints are weighted by their residuals. The Durbin-Wu-Hausman test against weighted
least squares is reported. All rows are held in memory. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.settings import GIVEN
from scarid_cli.algorithms.estimators import wls
from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.loop import ClosedLoop, DivergedError, IndefiniteError
from scarid_cli.algorithms.regression.estimation import Estimation, HoldingEstimator
from scarid_cli.algorithms.regression.information import NotIdentifiableError
from scarid_cli.algorithms.regression.rows import Rows, joined, runs
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.statistics.jackknife import shifts
from scarid_cli.algorithms.trajectories.hermite import refine
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

ITERATIONS = 10
CONTROL_RATE = 1000.0  # Hz
SIMULATION_SETTLING = 0.5  # s: until a simulation that starts at rest follows its reference


@dataclass(frozen=True)
class Estimator(HoldingEstimator):
    robot: Robot | None = field(default=None, metadata=GIVEN)

    REFERENCE: ClassVar[bool] = True
    ALIGNS: ClassVar[bool] = False

    def for_robot(self, robot: Robot) -> Estimator:
        return replace(self, robot=robot)

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
        start = wls.Estimator()
        plain = start.fit(start.step(start.init(np.zeros(rows.W.shape[2])), rows)[0])
        theta = plain.fit.estimates
        for _ in range(ITERATIONS):
            instruments = self._simulated(rows, theta)
            found = solved(rows, instruments, plain)
            moved = np.abs(found.fit.estimates - theta)
            theta = found.fit.estimates
            if np.all(moved < 1e-3 * found.fit.standard_errors()):
                break
        statistic, chance = hausman(rows, plain, found)
        return replace(
            found, extra={"durbin_wu_hausman": {"statistic": statistic, "p_value": chance}}
        )

    def _simulated(self, rows: Rows, theta: Array) -> Array:
        """The regressor along the simulated motion, zero until the simulation has settled."""
        assert self.robot is not None
        assert rows.reference is not None
        instruments = np.zeros_like(rows.W)
        settling = round(SIMULATION_SETTLING / rows.h)
        for run in runs(rows.at):
            reference = rows.reference[:, :, run]
            if reference.shape[2] > 2 * settling:
                motion = _followed(self.robot, theta, reference, rows.h)
                instruments[run] = self.robot.regressor(*motion)
                instruments[run][:settling] = 0.0
        return instruments


def _followed(robot: Robot, theta: Array, reference: Array, h: float) -> list[Array]:
    """The closed-loop position, velocity and acceleration of a robot with these parameters."""
    joints = len(robot.joints)
    ratio = max(1, round(h * CONTROL_RATE))
    parameters = zip(robot.parameters, theta.tolist(), strict=True)
    own = replace(robot, parameters=tuple(replace(p, apriori=x) for p, x in parameters))
    loop = ClosedLoop(
        robot=own,
        law=law(robot),
        encoder_resolution=np.zeros(joints),
        position_noise=np.zeros(joints),
        torque_noise=np.zeros(joints),
        seed=0,
        control_rate=ratio / h,
        apriori=robot,
    )
    q, dq = reference
    fine = refine(q, dq, np.gradient(dq, h, axis=1), h, ratio)
    try:
        log = loop.step(loop.init(fine[0][:, 0]), *fine)[1]
    except DivergedError:
        raise UsageFault(
            "iv: the simulated robot diverges with the estimates of least squares; use wls"
        ) from None
    except IndefiniteError:
        raise UsageFault(
            "iv: the inertia matrix of the estimates of least squares is not positive definite, so "
            "they cannot be simulated; use wls"
        ) from None
    signals = (log.q_true, log.dq_true, log.ddq_true)
    # The simulation ends one sample early, since nothing follows the last reference.
    return [np.ascontiguousarray(np.pad(x[:, ::ratio], ((0, 0), (0, 1)), "edge")) for x in signals]


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
