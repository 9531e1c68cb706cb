"""The columns that a robot's regressor is made of.

Each term maps positions, velocities and accelerations, arrays (joints, samples), to the torque
per unit of its parameter: a dict from joint (from 0) to samples. Joints that are left out feel
nothing.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from scarid_cli.arrays import Array

Column = dict[int, Array]
Term = Callable[[Array, Array, Array, int], Column]


def viscous(_q: Array, dq: Array, _ddq: Array, joint: int) -> Column:
    """Viscous friction (eq. 2) [N m s/rad or N s/m]."""
    return {joint: dq[joint]}


def coulomb(_q: Array, dq: Array, _ddq: Array, joint: int) -> Column:
    """Dry friction (eq. 2) [N m or N]."""
    return {joint: np.sign(dq[joint])}


def offset(_q: Array, dq: Array, _ddq: Array, joint: int) -> Column:
    """Constant torque or force [N m or N]."""
    return {joint: np.ones_like(dq[joint])}


def mass(_q: Array, _dq: Array, ddq: Array, joint: int) -> Column:
    """Mass or inertia of an axis that moves alone [kg or kg m2]."""
    return {joint: ddq[joint]}


def zz1r(_q: Array, _dq: Array, ddq: Array, _joint: int) -> Column:
    """ZZ1 + M2 L1^2 of the planar arm [kg m2] (eq. 26)."""
    return {0: ddq[0]}


def zz2(_q: Array, _dq: Array, ddq: Array, _joint: int) -> Column:
    """Moment of inertia of the second link [kg m2] (eq. 26)."""
    both = ddq[0] + ddq[1]
    return {0: both, 1: both}


def l1mx2(q: Array, dq: Array, ddq: Array, _joint: int) -> Column:
    """First moment of link 2 along its x axis times L1 [kg m2] (eq. 26, row for joint 2 mended)."""
    c, s = np.cos(q[1]), np.sin(q[1])
    return {
        0: (2.0 * ddq[0] + ddq[1]) * c - dq[1] * (2.0 * dq[0] + dq[1]) * s,
        1: ddq[0] * c + dq[0] * dq[0] * s,
    }


def l1my2(q: Array, dq: Array, ddq: Array, _joint: int) -> Column:
    """First moment of link 2 along its y axis times L1 [kg m2] (eq. 26, row for joint 2 mended)."""
    c, s = np.cos(q[1]), np.sin(q[1])
    return {
        0: -(2.0 * ddq[0] + ddq[1]) * s - dq[1] * (2.0 * dq[0] + dq[1]) * c,
        1: -ddq[0] * s + dq[0] * dq[0] * c,
    }


# The two-link planar arm; these terms concern both its joints.
PLANAR_TERMS = ("ZZ1R", "ZZ2", "L1MX2", "L1MY2")
PLANAR_JOINTS = 2

TERMS: dict[str, Term] = {
    "viscous": viscous,
    "coulomb": coulomb,
    "offset": offset,
    "mass": mass,
    "ZZ1R": zz1r,
    "ZZ2": zz2,
    "L1MX2": l1mx2,
    "L1MY2": l1my2,
}
