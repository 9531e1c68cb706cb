"""The columns that a robot's regressor is made of.

Each term maps positions, velocities and accelerations, arrays (joints, samples), to the torque
per unit of its parameter: a dict from joint (from 0) to samples. Joints that are left out feel
nothing. The last argument has the constants of the term: the joint it is on (from 1), a velocity
[rad/s or m/s] that shapes dry friction, a length [m], the acceleration of gravity
[m/s2], and the joint that a coupled term is coupled to, with the ratio.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from scarid_cli.arrays import Array

Column = dict[int, Array]


class Constants(Protocol):
    """Of a term; 0 where it has none."""

    @property
    def joint(self) -> int: ...
    @property
    def velocity(self) -> float: ...
    @property
    def length(self) -> float: ...
    @property
    def gravity(self) -> float: ...
    @property
    def other(self) -> int: ...
    @property
    def ratio(self) -> float: ...


Term = Callable[[Array, Array, Array, Constants], Column]


def viscous(_q: Array, dq: Array, _ddq: Array, its: Constants) -> Column:
    """Viscous friction (eq. 2) [N m s/rad or N s/m]."""
    joint = its.joint - 1
    return {joint: dq[joint]}


def coulomb(_q: Array, dq: Array, _ddq: Array, its: Constants) -> Column:
    """Dry friction (eq. 2) [N m or N]; with a velocity, tanh(dq / velocity) for the sign."""
    joint = its.joint - 1
    return {joint: np.tanh(dq[joint] / its.velocity) if its.velocity > 0.0 else np.sign(dq[joint])}


def stribeck(_q: Array, dq: Array, _ddq: Array, its: Constants) -> Column:
    """What dry friction has more at low speed, sign(dq) exp(-(dq / velocity)^2) [N m or N]."""
    joint = its.joint - 1
    ratio = dq[joint] / its.velocity
    return {joint: np.sign(dq[joint]) * np.exp(-ratio * ratio)}


def viscous_forward(_q: Array, dq: Array, _ddq: Array, its: Constants) -> Column:
    """Viscous friction of positive velocities alone [N m s/rad or N s/m]."""
    joint = its.joint - 1
    return {joint: np.maximum(dq[joint], 0.0)}


def viscous_backward(_q: Array, dq: Array, _ddq: Array, its: Constants) -> Column:
    """Viscous friction of negative velocities alone [N m s/rad or N s/m]."""
    joint = its.joint - 1
    return {joint: np.minimum(dq[joint], 0.0)}


def coulomb_forward(_q: Array, dq: Array, _ddq: Array, its: Constants) -> Column:
    """Dry friction of positive velocities alone [N m or N]."""
    joint = its.joint - 1
    return {joint: (dq[joint] > 0.0).astype(np.float64)}


def coulomb_backward(_q: Array, dq: Array, _ddq: Array, its: Constants) -> Column:
    """Dry friction of negative velocities alone [N m or N]."""
    joint = its.joint - 1
    return {joint: -(dq[joint] < 0.0).astype(np.float64)}


def offset(_q: Array, dq: Array, _ddq: Array, its: Constants) -> Column:
    """Constant torque or force [N m or N]."""
    joint = its.joint - 1
    return {joint: np.ones_like(dq[joint])}


def mass(_q: Array, _dq: Array, ddq: Array, its: Constants) -> Column:
    """Mass or inertia of an axis that moves alone [kg or kg m2]."""
    joint = its.joint - 1
    return {joint: ddq[joint]}


def coupled_inertia(_q: Array, _dq: Array, ddq: Array, its: Constants) -> Column:
    """Inertia of a motor that turns with joint `other`, and `ratio` as much with another [kg m2].

    What it does between the two: its own column is that of an axis.
    """
    one, two = its.joint - 1, its.other - 1
    return {one: its.ratio * ddq[two], two: its.ratio * ddq[one]}


def coupled_viscous(_q: Array, dq: Array, _ddq: Array, its: Constants) -> Column:
    """Viscous friction of such a motor, likewise [N m s/rad]."""
    one, two = its.joint - 1, its.other - 1
    return {one: its.ratio * dq[two], two: its.ratio * dq[one]}


def coupled_coulomb(_q: Array, dq: Array, _ddq: Array, its: Constants) -> Column:
    """Dry friction of such a motor [N m]."""
    one, two = its.joint - 1, its.other - 1
    direction = np.sign(its.ratio * dq[one] + dq[two])
    return {one: its.ratio * direction, two: direction}


def zz1r(_q: Array, _dq: Array, ddq: Array, _its: Constants) -> Column:
    """ZZ1 + M2 L1^2 of the planar arm [kg m2] (eq. 26)."""
    return {0: ddq[0]}


def zz2(_q: Array, _dq: Array, ddq: Array, _its: Constants) -> Column:
    """Moment of inertia of the second link [kg m2] (eq. 26)."""
    both = ddq[0] + ddq[1]
    return {0: both, 1: both}


def l1mx2(q: Array, dq: Array, ddq: Array, _its: Constants) -> Column:
    """First moment of link 2 along its x axis times L1 [kg m2] (eq. 26, row for joint 2 mended)."""
    c, s = np.cos(q[1]), np.sin(q[1])
    return {
        0: (2.0 * ddq[0] + ddq[1]) * c - dq[1] * (2.0 * dq[0] + dq[1]) * s,
        1: ddq[0] * c + dq[0] * dq[0] * s,
    }


def l1my2(q: Array, dq: Array, ddq: Array, _its: Constants) -> Column:
    """First moment of link 2 along its y axis times L1 [kg m2] (eq. 26, row for joint 2 mended)."""
    c, s = np.cos(q[1]), np.sin(q[1])
    return {
        0: -(2.0 * ddq[0] + ddq[1]) * s - dq[1] * (2.0 * dq[0] + dq[1]) * c,
        1: -ddq[0] * s + dq[0] * dq[0] * c,
    }


def mx1r(q: Array, _dq: Array, _ddq: Array, its: Constants) -> Column:
    """First moment of link 1 and of M2 at its end, in gravity, hanging at q = 0 [kg m]."""
    return {0: its.gravity * np.sin(q[0])}


def mx2(q: Array, dq: Array, ddq: Array, its: Constants) -> Column:
    """First moment of link 2 [kg m]: what L1MX2 is with L1, and its weight."""
    weight = its.gravity * np.sin(q[0] + q[1])
    inertial = l1mx2(q, dq, ddq, its)
    return {joint: its.length * inertial[joint] + weight for joint in (0, 1)}


# The two-link planar arm; these terms concern both its joints.
PLANAR_TERMS = ("ZZ1R", "ZZ2", "L1MX2", "L1MY2")
GRAVITY_TERMS = ("MX1R", "MX2")
PLANAR_JOINTS = 2

TERMS: dict[str, Term] = {
    "viscous": viscous,
    "coulomb": coulomb,
    "stribeck": stribeck,
    "viscous-forward": viscous_forward,
    "viscous-backward": viscous_backward,
    "coulomb-forward": coulomb_forward,
    "coulomb-backward": coulomb_backward,
    "offset": offset,
    "mass": mass,
    "coupled-inertia": coupled_inertia,
    "coupled-viscous": coupled_viscous,
    "coupled-coulomb": coupled_coulomb,
    "ZZ1R": zz1r,
    "ZZ2": zz2,
    "L1MX2": l1mx2,
    "L1MY2": l1my2,
    "MX1R": mx1r,
    "MX2": mx2,
}
