"""A robot as the commands see it: joints, parameters with their a priori values, regressor."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from scarid_cli.algorithms.robots.joints import Joint
from scarid_cli.algorithms.robots.logs import Log
from scarid_cli.algorithms.robots.terms import TERMS
from scarid_cli.arrays import Array

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.rigid import Body


@dataclass(frozen=True)
class Parameter:
    """One base parameter: its term of the regressor, the joint (from 1) of a friction term.

    `parts` are the parameters it stands for, with their factors; `column` is its place among the
    standard parameters of a URDF, `other` the joint that a coupled term is coupled to by `ratio`.
    `velocity` [rad/s or m/s], `length` [m] and `gravity` [m/s2] shape the term: see terms.py.
    """

    name: str
    term: str
    unit: str
    apriori: float
    joint: int = 0
    velocity: float = 0.0
    length: float = 0.0
    gravity: float = 0.0
    other: int = 0
    ratio: float = 1.0
    column: int = -1
    parts: tuple[tuple[str, float], ...] = ()

    @property
    def stands_for(self) -> str:
        """What it is a combination of, written out; empty for a parameter of one name."""
        rest = "".join(
            f" {'-' if x < 0.0 else '+'} {abs(x):.6g} {name}"
            for name, x in self.parts
            if name != self.name
        )
        return f"{self.name}{rest}" if rest else ""


@dataclass(frozen=True)
class Control:
    """Gains per joint of eq. 29 [N m/rad, N m s/rad, N m/(rad s)]; smoothing of dq [Hz]."""

    kp: tuple[float, ...]
    kd: tuple[float, ...]
    ki: tuple[float, ...]
    velocity_cutoff: float


@dataclass(frozen=True)
class Robot:
    """A robot whose torques are linear in its parameters: tau = W(q, dq, ddq) theta (eq. 3)."""

    name: str
    title: str
    joints: tuple[Joint, ...]
    parameters: tuple[Parameter, ...]
    control: Control | None
    body: Body | None = None
    log: Log | None = None

    @property
    def names(self) -> list[str]:
        return [parameter.name for parameter in self.parameters]

    @property
    def apriori(self) -> Array:
        """A priori values, in the order of the parameters."""
        return np.array([parameter.apriori for parameter in self.parameters])

    def value(self, term: str, joint: int = 0) -> float:
        """The a priori value of a term; 0 if the robot has no such parameter."""
        found = (p.apriori for p in self.parameters if (p.term, p.joint) == (term, joint))
        return next(found, 0.0)

    def smoothed(self, velocity: float) -> Robot:
        """The robot whose dry friction changes over this velocity [rad/s or m/s], not at once."""
        parameters = (
            replace(p, velocity=velocity) if p.term == "coulomb" else p for p in self.parameters
        )
        return replace(self, parameters=tuple(parameters))

    def with_stribeck(self, velocities: dict[int, float]) -> Robot:
        """The robot with more dry friction at low speed, on joints (from 1) by their velocity."""
        added = (
            Parameter(f"Fst{i}", "stribeck", self.joints[i - 1].torque_unit, 0.0, i, velocity)
            for i, velocity in velocities.items()
        )
        return replace(self, parameters=(*self.parameters, *added))

    def regressor(self, q: Array, dq: Array, ddq: Array) -> Array:
        """W (samples, joints, parameters) from motions (joints, samples); sources in terms.py."""
        joints, samples = q.shape
        W = np.zeros((samples, joints, len(self.parameters)))
        standard = [(i, p.column) for i, p in enumerate(self.parameters) if p.column >= 0]
        if self.body and standard:
            places, columns = zip(*standard, strict=True)
            W[:, :, list(places)] = self.body.columns(q, dq, ddq)[:, :, list(columns)]
        for index, parameter in enumerate(self.parameters):
            if parameter.column >= 0:
                continue
            column = TERMS[parameter.term](q, dq, ddq, parameter)
            for joint, values in column.items():
                W[:, joint, index] = values
        return W

    def torques(self, W: Array, theta: Array) -> Array:
        """W theta as (joints, samples), summed in the order of the parameters.

        A matrix product would round differently with the number of rows in a batch.
        """
        total = W[:, :, 0] * theta[0]
        for index in range(1, len(theta)):
            total += W[:, :, index] * theta[index]
        return np.ascontiguousarray(total.T)
