"""Entries for the positions, and for signals that are not of one instant.

Their columns stand beside a regressor from differences of the positions (effects/parallel.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.phenomenon import Found, Phenomenon
from scarid_cli.algorithms.beyond.sensitivities import (
    Sensitivities,
    eccentric_columns,
    elastic_columns,
    zero_columns,
)
from scarid_cli.algorithms.beyond.signals import diagonal
from scarid_cli.algorithms.regression.rows import Rows, delay_column
from scarid_cli.arrays import Array
from scarid_cli.interval import plus_minus
from scarid_cli.words import listed


@dataclass(frozen=True)
class Differences:
    """A run whose `rows` have the motion from differences of the positions.

    All torques, those of the links, those that pass through the gears and those without
    acceleration are (samples, joints). `delayed` is whether a delay of all torques is fitted.
    """

    rows: Rows
    model: Model
    sensitivities: Sensitivities
    whole: Array
    links: Array
    transmitted: Array
    still: Array
    delayed: bool

    @property
    def motion(self) -> Array:
        """Positions, velocities and accelerations (3, joints, samples)."""
        return self.rows.motion[:3]

    @cached_property
    def carried(self) -> tuple[Array, Array]:
        """The first two derivatives of what passes through the gears, each (samples, joints)."""
        speed = np.gradient(self.transmitted, self.rows.h, axis=0)
        return speed, np.gradient(speed, self.rows.h, axis=0)


class OfPositions(Phenomenon):
    """An entry with columns of its own beside such a regressor."""

    BESIDE: ClassVar[tuple[str, ...]] = ()  # entries whose columns belong to it as well

    @staticmethod
    def columns(x: Differences) -> Array:
        """The columns (samples, joints, k) of a run."""
        raise NotImplementedError


class OwnDelays(OfPositions):
    """The torque of a joint behind a low-pass or a delay of its own.

    For each joint, the first derivative of the torque of inertia, the second one of the torque that
    it transmits and, unless a delay is fitted, the first one of the other torques.
    """

    NAME = "signals"
    IMPERFECTIONS = ("torque-bandwidth",)

    @staticmethod
    def columns(x: Differences) -> Array:
        first = np.gradient(x.whole - x.still, x.rows.h, axis=0)
        columns = [diagonal(first), diagonal(x.carried[1])]
        if not x.delayed:
            columns.append(diagonal(delay_column(x.rows, x.still)))
        return np.concatenate(columns, axis=2)


class Zeros(OfPositions):
    """Another zero of a joint."""

    NAME = "zeros"
    UNIT = "{position}"
    LACKS = (
        "where the log has a position of 0, {zeros} (state it as `zero` in the TOML file of the "
        "robot, with which `scarid convert` mends the log)"
    )
    CHANGE = "zero"
    TOGETHER = True  # of one calibration

    @staticmethod
    def columns(x: Differences) -> Array:
        return zero_columns(x.sensitivities)

    @classmethod
    def facts(cls, found: Found) -> dict[str, str]:
        zeros = [f"joint {j + 1} is at {_zero(found, j)}" for j in found.joints]
        return {"zeros": listed(zeros)}


class Encoders(OfPositions):
    """An eccentric encoder, whose error is a sine of the angle, beside another zero."""

    NAME = "encoders"
    UNIT = "rad"
    LACKS = (
        "the position of {joints} has an error that depends on the angle, as of an eccentric "
        "encoder"
    )
    IMPERFECTIONS = ("encoder-eccentricity",)
    BESIDE = ("zeros",)

    @staticmethod
    def columns(x: Differences) -> Array:
        return eccentric_columns(x.model, x.sensitivities, x.motion)


class Late(OfPositions):
    """Positions, then torques, of single joints that are late, whose size is the delay [s]."""

    NAME = "late"
    UNIT = "s"
    LACKS = "the signals of {joints} are not of the same instant as those of the others"
    IMPERFECTIONS = ("position-delay", "torque-delay")

    @staticmethod
    def columns(x: Differences) -> Array:
        """A position that is late by T is that of the joint before T dq.

        What is no torque of a link is friction or inertia of the motor, and depends on the motion
        of its own joint.
        """
        _, dq, ddq = x.motion
        jerk = np.gradient(ddq, x.rows.h, axis=1)
        own = delay_column(x.rows, x.whole - x.links)
        errors = np.stack((dq, ddq, jerk)).swapaxes(0, 1)
        of = x.sensitivities
        moved = np.stack([of.column(k, error) for k, error in enumerate(errors)], axis=2)
        late = diagonal(delay_column(x.rows, x.whole))
        return np.concatenate((moved + diagonal(own), -late), axis=2)


class Elasticity(OfPositions):
    """An elastic transmission behind an encoder on the motor."""

    NAME = "elasticity"
    UNIT = "{position}/({torque})"
    LACKS = "the transmission of {joints} is elastic (a gear or a belt between encoder and link)"
    IMPERFECTIONS = ("flexibility", "encoder-side")

    @staticmethod
    def columns(x: Differences) -> Array:
        torque = np.stack([part.T for part in (x.transmitted, *x.carried)])
        return elastic_columns(x.sensitivities, torque)


def _zero(found: Found, joint: int) -> str:
    """`-0.102 +- 0.0018 rad`."""
    error = plus_minus(found.noise[joint])
    return f"{found.amounts[joint]:.3g} {error} {found.robot.joints[joint].unit}"
