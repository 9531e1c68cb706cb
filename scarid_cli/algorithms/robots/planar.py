"""The terms of a planar arm of two links (paper eq. 26, its row for joint 2 corrected)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.robots.terms import Column, JointMotion, Term
from scarid_cli.arrays import Array


class PlanarTerm(Term):
    """A term of both joints of the arm."""

    @property
    def joints(self) -> tuple[int, ...]:
        return (1, 2)


class ZZ1R(PlanarTerm):
    """ZZ1 + M2 L1^2 [kg m2]: the inertia of link 1, and of the mass of link 2 at its end."""

    NAME = "ZZ1R"

    def column(self, samples: JointMotion) -> Column:
        return {0: samples.ddq[0]}


class ZZ2(PlanarTerm):
    """Moment of inertia of link 2 [kg m2]."""

    NAME = "ZZ2"

    def column(self, samples: JointMotion) -> Column:
        both = samples.ddq[0] + samples.ddq[1]
        return {0: both, 1: both}


def _first_moment(samples: JointMotion, c: Array, s: Array) -> Column:
    """The torques of a first moment of link 2 whose axis has the direction (c, s) in link 1."""
    dq, ddq = samples.dq, samples.ddq
    return {
        0: (2.0 * ddq[0] + ddq[1]) * c - dq[1] * (2.0 * dq[0] + dq[1]) * s,
        1: ddq[0] * c + dq[0] * dq[0] * s,
    }


class L1MX2(PlanarTerm):
    """First moment of link 2 along its x axis, times the length L1 of link 1 [kg m2]."""

    NAME = "L1MX2"

    def column(self, samples: JointMotion) -> Column:
        return _first_moment(samples, np.cos(samples.q[1]), np.sin(samples.q[1]))


class L1MY2(PlanarTerm):
    """First moment of link 2 along its y axis, times the length L1 of link 1 [kg m2]."""

    NAME = "L1MY2"

    def column(self, samples: JointMotion) -> Column:
        return _first_moment(samples, -np.sin(samples.q[1]), np.cos(samples.q[1]))


@dataclass(frozen=True)
class MX1R(PlanarTerm):
    """First moment of link 1, and of the mass of link 2 at its end, in gravity [kg m].

    The arm hangs at q = 0; `gravity` is the acceleration of gravity [m/s2].
    """

    NAME = "MX1R"
    gravity: float = 0.0

    def column(self, samples: JointMotion) -> Column:
        return {0: self.gravity * np.sin(samples.q[0])}


@dataclass(frozen=True)
class MX2(PlanarTerm):
    """First moment of link 2 [kg m], in gravity: L1 times the column of L1MX2, and its weight.

    `length` is that of link 1 [m].
    """

    NAME = "MX2"
    length: float = 0.0
    gravity: float = 0.0

    def column(self, samples: JointMotion) -> Column:
        weight = self.gravity * np.sin(samples.q[0] + samples.q[1])
        inertial = L1MX2().column(samples)
        return {joint: self.length * inertial[joint] + weight for joint in (0, 1)}


PLANAR_TERMS = {term.NAME: term for term in PlanarTerm.__subclasses__()}
