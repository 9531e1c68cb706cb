"""Friction and motor terms as laws of the motion of a shaft, with their slopes.

A shaft turns with one joint, or with two joints that a motor couples.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.robots.coupled import CoupledCoulomb, CoupledTerm, CoupledViscous
from scarid_cli.algorithms.robots.terms import AxisTerm, Mass, Term
from scarid_cli.arrays import Array, Numbers

Law = Callable[[Array], Array]
STEP = 1e-4  # rad/s or m/s, for the slopes
PLACES = ("joint", "other", "ratio")  # what terms with the same law may differ in
VELOCITY, ACCELERATION = 1, 2  # the places of the signals in a motion q, dq, ddq


@dataclass(frozen=True)
class Part:
    """The column of a parameter (from 0) on the joint (from 0) that it `acts` on.

    It is `gain` times the law of the motion of a shaft, which `turns` (joints) with the joints.
    """

    law: Law
    signal: int
    column: int
    acts: int
    turns: Array
    gain: float = 1.0
    jumps: bool = False


@dataclass(frozen=True)
class Shafts:
    """Parts with the same law, computed together: one element or row for each."""

    law: Law
    jumps: bool
    signal: int
    columns: Numbers
    acts: Numbers
    gains: Array
    turns: Array

    @classmethod
    def of(cls, parts: Sequence[Part]) -> Shafts:
        return cls(
            parts[0].law,
            parts[0].jumps,
            parts[0].signal,
            np.array([part.column for part in parts]),
            np.array([part.acts for part in parts]),
            np.array([[part.gain] for part in parts]),
            np.array([part.turns for part in parts]),
        )

    def torque(self, u: Array, smooth: float) -> Array:
        """The torques per unit of the parameters (parts, samples), at the motion u of the shafts.

        A jump at rest is spread over velocities of the size of `smooth` [rad/s or m/s].
        """
        if not self.jumps:
            return self.gains * self.law(u)
        ahead = 0.5 * (1.0 + np.tanh(u / smooth))
        size = np.abs(u)
        return self.gains * (ahead * self.law(size) + (1.0 - ahead) * self.law(-size))

    def slope(self, u: Array, smooth: float) -> Array:
        """The derivative of `torque` by u (parts, samples).

        The slope of a law is a difference of second order, on either side of its jump, so that a
        new friction term needs no derivative.
        """
        if not self.jumps:
            return self.gains * (self.law(u + STEP) - self.law(u - STEP)) / (2.0 * STEP)
        turned, size = np.tanh(u / smooth), np.abs(u)
        ahead = 0.5 * (1.0 + turned)
        after, before = _slope(self.law, size, STEP), _slope(self.law, -size, -STEP)
        jump = (1.0 - turned**2) * (self.law(size) - self.law(-size)) / (2.0 * smooth)
        return self.gains * (jump + np.sign(u) * (ahead * after - (1.0 - ahead) * before))


def _slope(law: Law, u: Array, step: float) -> Array:
    """The slope at u, from values at u and on the side of the step."""
    slope: Array = (4.0 * law(u + step) - 3.0 * law(u) - law(u + 2.0 * step)) / (2.0 * step)
    return slope


def shafts(terms: Sequence[Term], joints: int) -> tuple[Shafts, ...]:
    """The friction and motor terms of a robot; those with the same law together."""
    groups: dict[str, list[Part]] = defaultdict(list)
    for column, term in enumerate(terms):
        for part in _parts(column, term, np.eye(joints)):
            constants = {key: x for key, x in vars(term).items() if key not in PLACES}
            groups[f"{term.NAME} {constants}"].append(part)
    return tuple(Shafts.of(parts) for parts in groups.values())


def _parts(column: int, term: Term, axis: Array) -> Iterator[Part]:
    """The parts of a term; none for a term of the chain of links."""
    if isinstance(term, AxisTerm):
        own = term.joint - 1
        if isinstance(term, Mass):
            yield Part(_same, ACCELERATION, column, own, axis[own])
        else:
            yield Part(term.torque, VELOCITY, column, own, axis[own], jumps=term.JUMPS)
    elif isinstance(term, CoupledTerm):
        one, two, ratio = term.joint - 1, term.other - 1, term.ratio
        if isinstance(term, CoupledCoulomb):
            both = ratio * axis[one] + axis[two]
            yield Part(np.sign, VELOCITY, column, one, both, gain=ratio, jumps=True)
            yield Part(np.sign, VELOCITY, column, two, both, jumps=True)
        else:
            signal = VELOCITY if isinstance(term, CoupledViscous) else ACCELERATION
            yield Part(_same, signal, column, one, ratio * axis[two])
            yield Part(_same, signal, column, two, ratio * axis[one])


def _same(u: Array) -> Array:
    return u
