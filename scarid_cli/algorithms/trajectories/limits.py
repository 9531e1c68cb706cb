"""Limits of a motion, and the home position where it starts and ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.robots.joints import Joint
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

TOLERANCE = 1e-9  # of a limit, for rounding


@dataclass(frozen=True)
class Limits:
    """Positions from `lower` to `upper`, and limits on |dq| and |ddq|.

    Arrays (joints), in the units of each joint: rad or m, and per s and s2.
    """

    lower: Array
    upper: Array
    dq: Array
    ddq: Array

    @classmethod
    def of(cls, joints: Sequence[Joint]) -> Limits:
        """The limits that a robot's description gives; infinite where it gives none."""
        rows = [(j.lower, j.upper, j.velocity_limit, j.acceleration_limit) for j in joints]
        return cls(*np.array(rows).T)

    @property
    def home(self) -> Array:
        """Zero where it lies in the middle half of the interval, else the middle (joints).

        At zero near a limit, as that of a joint which folds to one side, there would be no room.
        """
        with np.errstate(invalid="ignore"):  # there may be no limits
            middle, length = 0.5 * (self.lower + self.upper), self.upper - self.lower
        aside = np.isfinite(middle) & (np.abs(middle) > 0.25 * length)
        home: Array = np.where(aside, middle, 0.0)
        return home

    def require_room(self, home: Array) -> None:
        """Refuse a home position at a limit, from which a joint could move to one side only."""
        room = np.minimum(np.abs(home - self.lower), np.abs(self.upper - home))
        for joint in np.flatnonzero(room <= TOLERANCE).tolist():
            raise UsageFault(
                f"--home: joint {joint + 1} stands at a limit of {self.interval(joint)}; give a "
                "position with room on both sides"
            )

    def within(self, other: Limits) -> Limits:
        """The limits that keep both."""
        found = Limits(
            np.maximum(self.lower, other.lower),
            np.minimum(self.upper, other.upper),
            np.minimum(self.dq, other.dq),
            np.minimum(self.ddq, other.ddq),
        )
        for joint in np.flatnonzero(~(found.lower < found.upper)).tolist():
            raise UsageFault(
                f"--q-min, --q-max: joint {joint + 1} has no position from "
                f"{self.interval(joint)} within the limits of its description, "
                f"{other.interval(joint)}"
            )
        return found

    def outside(self, q: Array) -> list[list[int]]:
        """The joints and samples (from 0) at which positions, (joints[, samples]), are outside."""
        slack = TOLERANCE * np.maximum(np.abs(self.lower), np.abs(self.upper))
        return _where(q, self.lower - slack, self.upper + slack)

    def interval(self, joint: int) -> str:
        """The position limits of a joint (from 0) in words."""
        return f"{self.lower[joint]:g} to {self.upper[joint]:g}"

    def require(self, t: Array, q: Array, dq: Array, ddq: Array) -> None:
        """Refuses a motion, sampled at the times t [s], that leaves the limits."""
        slack = 1.0 + TOLERANCE
        for name, values, found, size in (
            ("position", q, self.outside(q), None),
            ("velocity", dq, _where(dq, -self.dq * slack, self.dq * slack), self.dq),
            ("acceleration", ddq, _where(ddq, -self.ddq * slack, self.ddq * slack), self.ddq),
        ):
            for joint, sample in found[:1]:
                allowed = self.interval(joint) if size is None else f"at most {size[joint]:g}"
                raise UsageFault(
                    f"the motion leaves its limits: at t = {t[sample]:.4g} s the {name} of joint "
                    f"{joint + 1} is {values[joint, sample]:.4g}, allowed is {allowed}"
                )


def _where(values: Array, low: Array, high: Array) -> list[list[int]]:
    """The places, joint and sample, of values that are not from low to high (joints)."""
    return np.argwhere(~((low <= values.T) & (high >= values.T)).T).tolist()
