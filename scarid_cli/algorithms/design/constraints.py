"""What a motion must keep: intervals of positions, velocities, accelerations and torques.

Every constraint is a violation that must not be above 0, relative to its limit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from scarid_cli.algorithms.design.information import Samples
from scarid_cli.algorithms.design.model import SMOOTH, Model, Motion
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array, Marks, Numbers

Pull = Callable[[Array], Array]
ABRUPT = 1e-12  # rad/s or m/s: friction that jumps
NEAR = 0.2  # of a limit: what is further from it is not watched


class Constraint(Protocol):
    """A constraint on the coefficients (joints, functions) of a curve."""

    def evaluate(self, coefficients: Array) -> tuple[Array, Pull]:
        """The violations, and from their multipliers the gradient by the coefficients."""
        ...

    def watched(self, coefficients: Array) -> Constraint:
        """The constraint at those places that matter near these coefficients."""
        ...


@dataclass(frozen=True)
class Kinematic:
    """Limits of position, velocity and acceleration; violations are (4, joints, samples).

    Positions count relative to half of their interval.
    """

    samples: Samples
    limits: Limits

    def evaluate(self, coefficients: Array) -> tuple[Array, Pull]:
        away, dq, ddq = (coefficients @ values for values in self.samples.values)
        half = 0.5 * (self.limits.upper - self.limits.lower)[:, None]
        above = (self.limits.upper - self.samples.home)[:, None]
        below = (self.samples.home - self.limits.lower)[:, None]
        fast, hard = self.limits.dq[:, None], self.limits.ddq[:, None]
        violations = np.array(
            [
                (away - above) / half,
                (-away - below) / half,
                np.abs(dq) / fast - 1.0,
                np.abs(ddq) / hard - 1.0,
            ]
        )

        def pull(m: Array) -> Array:
            slopes = ((m[0] - m[1]) / half, m[2] * np.sign(dq) / fast, m[3] * np.sign(ddq) / hard)
            return self.samples.pulled(slopes)

        return violations, pull

    def watched(self, coefficients: Array) -> Kinematic:  # noqa: ARG002
        return self


class Law(Protocol):
    """A constraint on the motion at each instant."""

    @property
    def names(self) -> list[str]:
        """What each row of violations limits: `torque of joint 1`."""
        ...

    def violations(self, motion: Motion) -> Array:
        """The violations (names, samples)."""
        ...

    def slopes(self, motion: Motion, multipliers: Array) -> Motion:
        """The derivatives of sum(multipliers * violations) by q, dq and ddq."""
        ...

    @property
    def exact(self) -> Law:
        """The law itself, where this one is smooth for the sake of its slopes."""
        ...


@dataclass(frozen=True)
class Along:
    """A law along a curve, at those samples that are `near` its limits."""

    samples: Samples
    law: Law
    near: Marks

    @classmethod
    def of(cls, samples: Samples, law: Law) -> Along:
        return cls(samples, law, np.ones(samples.values.shape[2], dtype=bool))

    def evaluate(self, coefficients: Array) -> tuple[Array, Pull]:
        violations = np.full((len(self.law.names), len(self.near)), -1.0)
        places = np.flatnonzero(self.near)
        violations[:, places] = self.law.violations(self._at(places).motion(coefficients))

        def pull(multipliers: Array) -> Array:
            pressed = np.flatnonzero(multipliers.any(axis=0))
            there = self._at(pressed)
            slopes = self.law.slopes(there.motion(coefficients), multipliers[:, pressed])
            return there.pulled(slopes)

        return violations, pull

    def watched(self, coefficients: Array) -> Along:
        violations, _ = Along.of(self.samples, self.law).evaluate(coefficients)
        near: Marks = np.asarray(np.any(violations > -NEAR, axis=0))
        return replace(self, near=near)

    def _at(self, places: Numbers) -> Samples:
        return replace(self.samples, values=self.samples.values[:, :, places])


@dataclass(frozen=True)
class Torque:
    """Limits (joints) on the torques of the a priori model [N m or N]."""

    model: Model
    limits: Array
    smooth: float = SMOOTH

    @property
    def names(self) -> list[str]:
        return [f"torque of joint {i}" for i in range(1, len(self.limits) + 1)]

    def violations(self, motion: Motion) -> Array:
        found: Array = np.abs(self._torques(motion)) / self.limits[:, None] - 1.0
        return found

    def slopes(self, motion: Motion, multipliers: Array) -> Motion:
        signed = multipliers * np.sign(self._torques(motion)) / self.limits[:, None]
        return self.model.gradient(motion, signed.T[:, :, None] * self.model.theta)

    @property
    def exact(self) -> Torque:
        return replace(self, smooth=ABRUPT)

    def _torques(self, motion: Motion) -> Array:
        torques: Array = (self.model.regressor(motion, self.smooth) @ self.model.theta).T
        return torques
