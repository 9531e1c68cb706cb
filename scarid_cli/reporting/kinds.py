"""What a report keeps of a table: one class for each kind of table that it can show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from scarid_cli.algorithms.inference.prediction import Quality
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.reporting.naming import Name
from scarid_cli.reporting.said import Said


@dataclass(frozen=True)
class Result:
    """Common to all kinds: the name of the table, and its robot if the description was found."""

    name: Name
    robot: Robot | None

    @property
    def robot_name(self) -> str | None:
        return self.robot.name if self.robot else None


@dataclass(frozen=True)
class _PerParameter(Result):
    names: tuple[str, ...]
    units: tuple[str, ...]


@dataclass(frozen=True)
class _PerJoint(Result):
    """Torques; `units` are theirs, N m or N."""

    joints: tuple[int, ...]
    units: tuple[str, ...]


@dataclass(frozen=True)
class Parameters(_PerParameter):
    """Estimates with their relative standard deviations [%] (eq. 34); nan where unknown.

    `robust` holds relative standard errors [%] that are robust to autocorrelated residuals; it is
    empty where the table has none. `low` and `high` are the ends of the 95 % intervals in the
    parameters' units, nan where unknown. `extra` is what the metadata say of the estimation, and
    `file` the name of the table.
    """

    estimates: tuple[float, ...]
    deviations: tuple[float, ...]
    extra: dict[str, Any]
    commands: tuple[str, ...] = ()
    robust: tuple[float, ...] = ()
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()
    file: str = ""


@dataclass(frozen=True)
class Trace(_PerParameter):
    """The running estimates: a curve (2, points) and an RMS error (eq. 35) per parameter."""

    curves: tuple[Array, ...]
    errors: tuple[float, ...]


@dataclass(frozen=True)
class Metrics(_PerJoint):
    """Quality of the predicted torques of each joint; nan where unknown.

    `by` are the parameter tables that predicted them, as far as the history tells, and `said` is
    whether the robot has changed.
    """

    qualities: tuple[Quality, ...]
    by: tuple[str, ...] = ()
    said: Said | None = None


@dataclass(frozen=True)
class Comparison(Result):
    """What `compare` said of each table beside the first one."""

    said: tuple[Said, ...]


@dataclass(frozen=True)
class JointGains(Result):
    """The gain of each joint's torque, with its 95 % interval, nan where it is not told.

    `wrong` are the joints (from 1) whose gain differs from 1.
    """

    joints: tuple[int, ...]
    factors: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    wrong: tuple[int, ...]


@dataclass(frozen=True)
class Hung(Result):
    """The ten values of a payload in a `frame`, with their 95 % intervals, nan where not told.

    `body` are those of the nearest body that there can be, so many standard deviations `away`.
    """

    frame: str
    possible: bool
    away: float
    quantities: tuple[str, ...]
    units: tuple[str, ...]
    values: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    body: tuple[float, ...]


@dataclass(frozen=True)
class Loads(Result):
    """Payloads over time: start, end and finding [s], mass and half its interval [kg] of each."""

    rows: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Prediction(_PerJoint):
    """Measured and predicted torque of each joint and their difference, as curves (2, points)."""

    measured: tuple[Array, ...]
    predicted: tuple[Array, ...]
    residuals: tuple[Array, ...] = ()


@dataclass(frozen=True)
class Measurement(Result):
    """Torque, position and reference of each joint, as curves (2, points).

    `tracking` is the root-mean-square difference between position and reference [rad or m].
    """

    torques: tuple[Array, ...]
    positions: tuple[Array, ...]
    references: tuple[Array, ...]
    tracking: tuple[float, ...]


OF_NO_METHOD = (Measurement, Comparison, JointGains)  # which methods do not differ in


@dataclass(frozen=True)
class MotionEstimate(Result):
    """Estimated and, where the table has them, true velocities and accelerations.

    Curves (2, points), joint by joint: dq1, ddq1, dq2, ... `errors` are root-mean-square errors
    relative to the standard deviation of the true signal [%]. `misses` are the curves of estimate
    minus truth. `against` is what stands for the truth: "truth", or "common motion" of a real log.
    """

    columns: tuple[str, ...]
    curves: tuple[Array, ...]
    truths: tuple[Array, ...]
    errors: tuple[float, ...]
    misses: tuple[Array, ...] = ()
    against: str = "truth"
