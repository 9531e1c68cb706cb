"""The terms of a robot's torques: each is one column of the regressor (docs/theory.md).

A new friction term is a subclass of `AxisTerm`: descriptions with and without a URDF then take it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.arrays import Array

Column = dict[int, Array]  # from a joint (from 0) to samples; other joints are not affected

# Units of parameters, of a revolute and of a prismatic joint.
INERTIA = ("kg m2", "kg")
VISCOUS = ("N m s/rad", "N s/m")
SQUARE = ("N m s2/rad2", "N s2/m2")
TORQUE = ("N m", "N")


@dataclass(frozen=True)
class JointMotion:
    """Positions, velocities and accelerations, each (joints, samples) in rad or m, s."""

    q: Array
    dq: Array
    ddq: Array


@dataclass(frozen=True)
class Term:
    """What the torques are per unit of one parameter; a subclass has its own constants.

    `FRICTION`: a joint does not transmit it. `NEVER_NEGATIVE`: a negative parameter would drive the
    robot. `JUMPS`: the torque jumps where the velocity changes its sign.
    """

    NAME: ClassVar[str]
    FRICTION: ClassVar[bool] = False
    NEVER_NEGATIVE: ClassVar[bool] = False
    JUMPS: ClassVar[bool] = False

    @property
    def joints(self) -> tuple[int, ...]:
        """The joints (from 1) that it depends on or acts on."""
        raise NotImplementedError

    def column(self, samples: JointMotion) -> Column:
        """The torque or force on each joint, per unit of the parameter."""
        raise NotImplementedError


@dataclass(frozen=True)
class StandardTerm(Term):
    """One of the ten standard parameters of each link of a URDF, at its place among all of them.

    Its column is that of Body.columns.
    """

    NAME = "standard"
    place: int

    @property
    def joints(self) -> tuple[int, ...]:
        return ()


# Terms of one axis


@dataclass(frozen=True)
class AxisTerm(Term):
    """A term of one joint (from 1) that depends on its own motion alone.

    `SYMBOL` names the parameter of joint i in robots with a URDF; `UNITS` are those of a revolute
    and of a prismatic joint.
    """

    SYMBOL: ClassVar[str]
    UNITS: ClassVar[tuple[str, str]]
    joint: int

    @property
    def joints(self) -> tuple[int, ...]:
        return (self.joint,)

    def column(self, samples: JointMotion) -> Column:
        axis = self.joint - 1
        return {axis: self.torque(samples.dq[axis])}

    def torque(self, dq: Array) -> Array:
        """The torque or force per unit of the parameter, from the velocity of the joint."""
        raise NotImplementedError


class Viscous(AxisTerm):
    """Viscous friction, proportional to the velocity (paper eq. 2)."""

    NAME, SYMBOL, UNITS = "viscous", "fv{i}", VISCOUS
    FRICTION = NEVER_NEGATIVE = True

    def torque(self, dq: Array) -> Array:
        return dq


@dataclass(frozen=True)
class Coulomb(AxisTerm):
    """Coulomb friction, sign(dq) (paper eq. 2).

    With a `velocity` [rad/s or m/s] above 0 it is smooth: tanh(dq / velocity).
    """

    NAME, SYMBOL, UNITS = "coulomb", "fs{i}", TORQUE
    FRICTION = NEVER_NEGATIVE = JUMPS = True
    velocity: float = 0.0

    def __post_init__(self) -> None:
        if not self.velocity >= 0.0:
            raise ValueError("velocity is negative")

    def torque(self, dq: Array) -> Array:
        direction: Array = np.tanh(dq / self.velocity) if self.velocity > 0.0 else np.sign(dq)
        return direction


@dataclass(frozen=True)
class Stribeck(AxisTerm):
    """Friction that Coulomb friction has more at low speed: sign(dq) exp(-(dq / velocity)^2)."""

    NAME, SYMBOL, UNITS = "stribeck", "Fst{i}", TORQUE
    FRICTION = True
    velocity: float  # rad/s or m/s

    def __post_init__(self) -> None:
        if not self.velocity > 0.0:
            raise ValueError("velocity is not positive")

    def torque(self, dq: Array) -> Array:
        ratio = dq / self.velocity
        friction: Array = np.sign(dq) * np.exp(-ratio * ratio)
        return friction


class Quadratic(AxisTerm):
    """Friction with the square of the velocity, as of a fan or of thick oil: dq |dq|."""

    NAME, SYMBOL, UNITS = "quadratic", "fq{i}", SQUARE
    FRICTION = True

    def torque(self, dq: Array) -> Array:
        return dq * np.abs(dq)


class ViscousForward(AxisTerm):
    """Viscous friction at positive velocities only."""

    NAME, SYMBOL, UNITS = "viscous-forward", "fv{i}+", VISCOUS
    FRICTION = NEVER_NEGATIVE = True

    def torque(self, dq: Array) -> Array:
        return np.maximum(dq, 0.0)


class ViscousBackward(AxisTerm):
    """Viscous friction at negative velocities only."""

    NAME, SYMBOL, UNITS = "viscous-backward", "fv{i}-", VISCOUS
    FRICTION = NEVER_NEGATIVE = True

    def torque(self, dq: Array) -> Array:
        return np.minimum(dq, 0.0)


class CoulombForward(AxisTerm):
    """Coulomb friction at positive velocities only."""

    NAME, SYMBOL, UNITS = "coulomb-forward", "fs{i}+", TORQUE
    FRICTION = NEVER_NEGATIVE = JUMPS = True

    def torque(self, dq: Array) -> Array:
        return (dq > 0.0).astype(np.float64)


class CoulombBackward(AxisTerm):
    """Coulomb friction at negative velocities only."""

    NAME, SYMBOL, UNITS = "coulomb-backward", "fs{i}-", TORQUE
    FRICTION = NEVER_NEGATIVE = JUMPS = True

    def torque(self, dq: Array) -> Array:
        return -(dq < 0.0).astype(np.float64)


class Offset(AxisTerm):
    """A constant torque or force, such as the offset of a torque sensor."""

    NAME, SYMBOL, UNITS = "offset", "off{i}", TORQUE

    def torque(self, dq: Array) -> Array:
        return np.ones_like(dq)


class Mass(AxisTerm):
    """Mass or inertia of an axis that moves alone, or of the motor of an axis."""

    NAME, SYMBOL, UNITS = "mass", "Ia{i}", INERTIA

    def column(self, samples: JointMotion) -> Column:
        return {self.joint - 1: samples.ddq[self.joint - 1]}


# The terms that [[parameter]] may name, in the order of this file; planar.py has those of its arm.
AXIS_TERMS = {term.NAME: term for term in AxisTerm.__subclasses__()}
