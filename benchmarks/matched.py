"""What the benchmarks identify from a matched motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from scarid_cli.algorithms.estimators.ls import Estimator
from scarid_cli.algorithms.processes.matching import over, settling_rows
from scarid_cli.algorithms.regression.information import NotIdentifiableError
from scarid_cli.algorithms.regression.rows import plain
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array


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
    ls = Estimator()
    start = ls.init(np.zeros(len(robot.parameters)))
    regression = plain(robot.regressor(*kinematics), np.ascontiguousarray(tau.T))
    state, _ = ls.step(start, regression)
    try:
        return ls.fit(state).fit.estimates
    except NotIdentifiableError:
        return None
