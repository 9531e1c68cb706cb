"""Terms of a motor that turns with two joints: with `other`, and `ratio` times with `joint`.

They act between the two joints; what the motor does at each of them alone is a term of that axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.robots.terms import INERTIA, TORQUE, VISCOUS, Column, JointMotion, Term
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class CoupledTerm(Term):
    """A term of two joints (from 1); `SYMBOL` names the parameter of the joint `other`, i."""

    SYMBOL: ClassVar[str]
    UNIT: ClassVar[str]
    joint: int
    other: int
    ratio: float

    @property
    def joints(self) -> tuple[int, ...]:
        return (self.joint, self.other)

    def speed(self, dq: Array) -> Array:
        """The velocity of the motor (samples), from those of the joints (joints, samples)."""
        return np.asarray(self.ratio * dq[self.joint - 1] + dq[self.other - 1])


class CoupledInertia(CoupledTerm):
    """Inertia of the motor."""

    NAME, SYMBOL, UNIT = "coupled-inertia", "Iam{i}", INERTIA[0]

    def column(self, samples: JointMotion) -> Column:
        one, two = self.joint - 1, self.other - 1
        return {one: self.ratio * samples.ddq[two], two: self.ratio * samples.ddq[one]}


class CoupledViscous(CoupledTerm):
    """Viscous friction of the motor."""

    NAME, SYMBOL, UNIT = "coupled-viscous", "fvm{i}", VISCOUS[0]
    FRICTION = True

    def column(self, samples: JointMotion) -> Column:
        one, two = self.joint - 1, self.other - 1
        return {one: self.ratio * samples.dq[two], two: self.ratio * samples.dq[one]}


class CoupledCoulomb(CoupledTerm):
    """Coulomb friction of the motor."""

    NAME, SYMBOL, UNIT = "coupled-coulomb", "fsm{i}", TORQUE[0]
    FRICTION = JUMPS = True

    def column(self, samples: JointMotion) -> Column:
        one, two = self.joint - 1, self.other - 1
        direction = np.sign(self.speed(samples.dq))
        return {one: self.ratio * direction, two: direction}


COUPLED_TERMS: tuple[type[CoupledTerm], ...] = (CoupledInertia, CoupledViscous, CoupledCoulomb)
