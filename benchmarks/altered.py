"""Changes of a log that no imperfection of the simulator makes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array
from scarid_cli.io.table import matrix, with_columns

Recorded = tuple[Array, Array, Array]  # t (samples), q and tau (joints, samples)
Change = Callable[[Robot, Recorded], Recorded]


def altered(batch: pa.RecordBatch, robot: Robot, change: Change) -> pa.RecordBatch:
    """The measurement after a change of its time, positions and torques."""
    joints = range(1, len(robot.joints) + 1)
    q, tau = ([f"{symbol}{i}" for i in joints] for symbol in ("q", "tau"))
    t, *values = change(robot, (matrix(batch, ["t"])[0], matrix(batch, q), matrix(batch, tau)))
    new = dict(zip(["t", *q, *tau], [t, *values[0], *values[1]], strict=True))
    return with_columns(batch, batch.schema, new)


def coulomb(robot: Robot) -> Array:
    """The Coulomb friction of each joint (joints, 1)."""
    joints = range(1, len(robot.joints) + 1)
    return np.abs([[robot.value("coulomb", i)] for i in joints])


def pulled(robot: Robot, log: Recorded) -> Recorded:
    """A cable pulls with a fifth of the Coulomb friction per rad."""
    t, q, tau = log
    home = Limits.of(robot.joints).home[:, None]
    return t, q, tau + 0.2 * coulomb(robot) * (q - home)


def saturated(_: Robot, log: Recorded) -> Recorded:
    """The motor constant is 1 % smaller at the largest torque."""
    t, q, tau = log
    size = np.abs(tau)
    return t, q, tau * (1.0 - 0.01 * size / size.max(axis=1, keepdims=True))


def drifted(robot: Robot, log: Recorded) -> Recorded:
    """The torque drifts by a fifth of the Coulomb friction, half below and half above the truth."""
    t, q, tau = log
    return t, q, tau + 0.2 * coulomb(robot) * (t / t[-1] - 0.5)


def clipped(_: Robot, log: Recorded) -> Recorded:
    """The logged torque ends at four fifths of its largest value."""
    t, q, tau = log
    most = 0.8 * np.abs(tau).max(axis=1, keepdims=True)
    return t, q, np.clip(tau, -most, most)


def loose(_: Robot, log: Recorded) -> Recorded:
    """The encoder is 0.2 mrad ahead in the direction of the torque."""
    t, q, tau = log
    return t, q + 2e-4 * np.sign(tau), tau


def hurried(_: Robot, log: Recorded) -> Recorded:
    """The clock of the log is 0.1 % slow."""
    t, q, tau = log
    return 1.001 * t, q, tau
