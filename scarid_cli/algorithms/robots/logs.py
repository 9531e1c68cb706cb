"""Logs that hold something other than positions and torques of the joints in SI units.

A description says in [log] what its robot's logs hold:

    [log]
    rate = 1000               # Hz, for a log without a time column
    positions = "motor"       # angles of the motors, q_motor = R (q - zero)
    torques = "current"       # currents of the motors [A]; or "motor": their torques
    columns = { q1 = "enc_1", tau1 = "amp_1" }
    units = { "q*" = "deg" }

    [[joint]]
    gear_ratio = -48.0        # turns of the motor per turn of the joint; negative: reversed
    torque_constant = 0.05    # N m/A
    zero = 1.5708             # rad or m: position of the joint where the log has 0

    [[coupling]]
    joints = [5, 6]           # the motor of joint 6 also turns with joint 5, by
    ratio = 32.0              # this ratio; by default that of joint 6

Power is the same on both sides, so tau = R' tau_motor.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from scarid_cli.algorithms.keys import values
from scarid_cli.arrays import Array

JOINT, MOTOR, CURRENT = "joint", "motor", "current"
AXIS = ("gear_ratio", "torque_constant", "zero")  # of [[joint]]


@dataclass(frozen=True)
class LogFormat:
    """The columns and units of a log, as `convert` takes them, and the motors of the joints.

    `ratios` is the matrix R above (joints, joints), `constants` the torque constants (joints)
    [N m/A], `zero` (joints) is in rad or m.
    """

    columns: dict[str, str] = field(default_factory=dict)
    units: tuple[tuple[str, str], ...] = ()
    rate: float | None = None
    positions: str = JOINT
    torques: str = JOINT
    ratios: tuple[tuple[float, ...], ...] = ()
    constants: tuple[float, ...] = ()
    zero: tuple[float, ...] = ()

    @property
    def converts(self) -> bool:
        """Whether anything but names and a clock is changed."""
        return bool(self.units or any(self.zero)) or {self.positions, self.torques} != {JOINT}

    def is_of(self, columns: Collection[str]) -> bool:
        """Whether a table has the columns that are named here, and not yet their new names."""
        old = set(self.columns.values())
        new = set(self.columns) - old
        return bool(new) and old <= {*columns} and new.isdisjoint(columns)

    def positions_of_joints(self, q: Array) -> Array:
        """Positions (joints, samples) [rad or m] from those of the log, of joints or motors."""
        turned = self.velocities_of_joints(q) if self.positions == MOTOR else q
        return np.asarray(turned + np.array(self.zero)[:, None])

    def velocities_of_joints(self, dq: Array) -> Array:
        """Velocities or accelerations (joints, samples) from those of the motors."""
        return _mixed(np.linalg.inv(np.array(self.ratios)), dq)

    def torques_of_joints(self, tau: Array) -> Array:
        """Torques (joints, samples) [N m or N] from torques [N m] or currents [A] of the motors."""
        constants = np.array(self.constants) if self.torques == CURRENT else 1.0
        return _mixed(np.transpose(self.ratios) * constants, tau)


def _mixed(matrix: Array, x: Array) -> Array:
    """The product, summed in the same order for any number of samples."""
    total = matrix[:, :1] * x[0]
    for k in range(1, len(x)):
        total = total + matrix[:, k : k + 1] * x[k]
    return np.asarray(total, dtype=np.float64)


def log_of(document: dict[str, Any], joints: int) -> LogFormat | None:
    """What a description says of logs of so many joints; None if it has no [log] and no zeros."""
    axes = values.tables("joint", document.get("joint", [])) or [{}] * joints
    if "log" not in document and not any("zero" in axis for axis in axes):
        return None
    couplings = values.tables("coupling", document.get("coupling", []))
    entry = values.table("log", document.get("log", {}))
    values.only("[log]", entry, ("rate", "positions", "torques", "columns", "units"))
    columns = values.table("columns", entry.get("columns", {}))
    units = values.table("units", entry.get("units", {}))
    rate = values.number("rate", entry["rate"]) if "rate" in entry else None
    if rate is not None and rate <= 0.0:
        raise ValueError("rate is not positive")
    torques = values.choice("torques", entry.get("torques", JOINT), (JOINT, MOTOR, CURRENT))
    lacking = [j for j, axis in enumerate(axes, start=1) if "torque_constant" not in axis]
    if torques == CURRENT and lacking:
        raise ValueError(
            f'joint {lacking[0]} has no torque_constant, which torques = "current" needs'
        )
    return LogFormat(
        columns={new: values.text(new, old) for new, old in columns.items()},
        units=tuple((pattern, values.text(pattern, unit)) for pattern, unit in units.items()),
        rate=rate,
        positions=values.choice("positions", entry.get("positions", JOINT), (JOINT, MOTOR)),
        torques=torques,
        ratios=_ratios(axes, couplings),
        constants=_numbers(axes, "torque_constant", 1.0),
        zero=_numbers(axes, "zero", 0.0),
    )


def _numbers(axes: list[dict[str, Any]], key: str, otherwise: float) -> tuple[float, ...]:
    return tuple(values.number(key, axis.get(key, otherwise)) for axis in axes)


def _ratios(
    axes: list[dict[str, Any]], couplings: list[dict[str, Any]]
) -> tuple[tuple[float, ...], ...]:
    R = np.diag([gear_ratio(axis) for axis in axes])
    for entry in couplings:
        one, two, ratio = coupled(entry, axes)
        R[two, one] = ratio
    return tuple(tuple(line) for line in R.tolist())


def gear_ratio(axis: dict[str, Any]) -> float:
    """The gear ratio of a [[joint]]."""
    ratio = values.number("gear_ratio", axis.get("gear_ratio", 1.0))
    if not ratio:
        raise ValueError("gear_ratio is 0")
    return ratio


def coupled(entry: dict[str, Any], axes: list[dict[str, Any]]) -> tuple[int, int, float]:
    """The two joints of a [[coupling]] (from 0) and its ratio, that of the second joint's motor."""
    values.only("[[coupling]]", entry, ("joints", "ratio"))
    one, two = (values.whole("coupling", x) for x in entry["joints"])
    if not {one, two} <= set(range(1, len(axes) + 1)) or one == two:
        raise ValueError(
            f"joints {one} and {two} cannot be coupled; give two different ones of 1 to {len(axes)}"
        )
    ratio = entry.get("ratio", gear_ratio(axes[two - 1]))
    return one - 1, two - 1, values.number("ratio", ratio)
