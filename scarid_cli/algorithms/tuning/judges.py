"""Judges of the settings of a differentiator, from the data alone, without the truth.

The likelihood judges the Kalman methods by their innovations. The smoother judges by the distance
to a Kalman smoother that has tuned itself to the same positions: it also sees the samples after a
row, and is several times nearer to the truth than any causal method. The torques judge by the error
of the torques predicted for held-out segments, with parameters identified through the method.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.estimators.ls import Estimator
from scarid_cli.algorithms.processes.matching import over, settling_rows
from scarid_cli.algorithms.regression.information import NotIdentifiableError
from scarid_cli.algorithms.regression.rows import plain
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.tuning.likelihood import log_likelihood
from scarid_cli.algorithms.tuning.search import Judge
from scarid_cli.arrays import Array

SKIPPED_START = 1.0  # seconds at the start, where a method may still be on its way
SEGMENTS = 10  # of a record, every second one held out


def negative_log_likelihood(q: Array, h: float) -> Judge:
    """The negative logarithm of the likelihood of the innovations, per sample."""
    return lambda method: -log_likelihood(method, q, h) / len(q)


def distance_to_smoother(q: Array, h: float) -> Judge:
    """The geometric mean of the rms errors of velocity and acceleration against the smoother.

    Each error is divided by the standard deviation of the smoother's signal.
    """
    _, *smooth = over(smoother(q, h).matched(), q, h)
    late = min(int(SKIPPED_START / h), len(q) // 5)
    inner = slice(late, -late)
    sizes = [float(np.std(x[inner])) or 1.0 for x in smooth]

    def judge(method: Any) -> float:
        with np.errstate(all="ignore"):
            estimates = over(method, q, h)
            errors = [
                np.sqrt(np.mean((x - y)[inner] ** 2)) / size
                for x, y, size in zip(estimates, smooth, sizes, strict=True)
            ]
        return float(np.sqrt(errors[0] * errors[1]))

    return judge


def smoother(q: Array, h: float) -> Any:
    """The Kalman smoother, tuned to the positions q of one joint."""
    return DIFFERENTIATORS.load("rts")().fitted(q, h)


def error_of_torques(robot: Robot, q: Array, tau: Array, h: float) -> Judge:
    """The error of the torques predicted for held-out segments of the smoothed motion.

    It is the root mean square over the joints of the standard deviation of the error, divided by
    that of the torque. q and tau: (joints, rows).
    """
    smooth = motion([smoother(x, h) for x in q], q, tau, h)
    rows = q.shape[1]
    held_out = np.arange(rows) * SEGMENTS // rows % 2 == 1
    test = smooth.settled & held_out

    def judge(method: Any) -> float:
        with np.errstate(all="ignore"):
            own = motion([method] * len(q), q, tau, h)
            if not all(np.isfinite(signal).all() for signal in own.signals):
                return np.inf
            theta = identified(robot, own, own.settled & ~held_out)
            if theta is None or not test.any():
                return np.inf
            W = robot.regressor(*(np.ascontiguousarray(x[:, test]) for x in smooth.signals[:3]))
            measured = smooth.signals[3][:, test]
            wrong = measured - robot.torques(W, theta)
        sizes = measured.std(axis=1)
        return float(np.sqrt(np.mean((wrong.std(axis=1) / np.where(sizes > 0.0, sizes, 1.0)) ** 2)))

    return judge


@dataclass(frozen=True)
class SettledMotion:
    """Position, velocity, acceleration, torque (joints, rows), and which rows are settled."""

    signals: tuple[Array, Array, Array, Array]
    settled: Any


def motion(methods: list[Any], q: Array, tau: Array, h: float) -> SettledMotion:
    """The phase-matched motion of a whole record, with one method per joint."""
    parts, start, end = [], 0, 0
    for method, x, y in zip(methods, q, tau, strict=True):
        form = method.matched()
        torque_filter = form.torque_filter
        parts.append((*over(form, x, h), over(torque_filter, y, h)[0] if torque_filter else y))
        before, after = settling_rows(torque_filter, h) if torque_filter else (0, 0)
        start, end = max(start, after), max(end, before)
    positions, dq, ddq, torques = (np.array(rows) for rows in zip(*parts, strict=True))
    at = np.arange(q.shape[1])
    return SettledMotion((positions, dq, ddq, torques), (at >= start) & (at < len(at) - end))


def identified(robot: Robot, motion: SettledMotion, rows: Any) -> Array | None:
    """The least-squares estimates from some rows; None if they leave a parameter undetermined."""
    *kinematics, tau = (np.ascontiguousarray(signal[:, rows]) for signal in motion.signals)
    regression = plain(robot.regressor(*kinematics), np.ascontiguousarray(tau.T))
    try:
        return Estimator().of_rows(regression).fit.estimates
    except NotIdentifiableError:
        return None
