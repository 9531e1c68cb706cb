"""A payload as the controllers of robots take it: UR's URScript, Franka's libfranka, KUKA's KRL."""

from __future__ import annotations

from math import atan2, degrees, hypot

import numpy as np

from scarid_cli.algorithms.robots.physical import inertia_of
from scarid_cli.arrays import Array

PRINCIPAL = [4, 7, 9]  # the moments of inertia among the values


def settings(values: Array, lows: Array) -> dict[str, str]:
    """A line for each controller, from mass [kg], centre [m] and inertia about it [kg m2] (10).

    Values that are not told are nan, and `lows` (10) are the lower ends of their intervals. There
    are no lines without a mass above 0 and its centre. An inertia that is not told as a whole, or
    with a moment that may be 0, is left out, or 0 where there must be one.
    """
    if not (np.isfinite(values[:4]).all() and lows[0] > 0.0):
        return {}
    inertia = (
        values[4:] if np.isfinite(values[4:]).all() and (lows[PRINCIPAL] > 0.0).all() else None
    )
    return {
        "UR": _ur(values[0], values[1:4], inertia),
        "Franka": _franka(values[0], values[1:4], inertia),
        "KUKA": _kuka(values[0], values[1:4], inertia),
    }


def _ur(mass: float, centre: Array, inertia: Array | None) -> str:
    """URScript: kg, m, and kg m2 about the centre (xx, yy, zz, xy, xz, yz)."""
    further = f", {_list(inertia[[0, 3, 5, 1, 2, 4]])}" if inertia is not None else ""
    return f"set_target_payload({mass:.4g}, {_list(centre)}{further})"


def _franka(mass: float, centre: Array, inertia: Array | None) -> str:
    """libfranka: kg, m, and the matrix about the centre [kg m2], column by column."""
    every = np.zeros((3, 3)) if inertia is None else inertia_of(inertia)
    columns = _list(every.T.ravel())
    return f"robot.setLoad({mass:.4g}, {_braced(_list(centre))}, {_braced(columns)})"


def _kuka(mass: float, centre: Array, inertia: Array | None) -> str:
    """KRL: kg, mm, the directions of the principal axes [deg] and their moments [kg m2]."""
    moments, turn = np.zeros(3), np.eye(3)
    if inertia is not None:
        moments, turn = np.linalg.eigh(inertia_of(inertia))
        turn[:, 2] *= np.sign(np.linalg.det(turn))
    x, y, z = (f"{1e3 * c:.4g}" for c in centre)
    a, b, c = (f"{degrees(angle) + 0.0:.4g}" for angle in _zyx(turn))
    first, second, third = (f"{moment:.4g}" for moment in moments)
    return (
        f"{{M {mass:.4g}, CM {{X {x}, Y {y}, Z {z}, A {a}, B {b}, C {c}}}, "
        f"J {{X {first}, Y {second}, Z {third}}}}}"
    )


def _zyx(turn: Array) -> tuple[float, float, float]:
    """The angles [rad] about z, y and x, one after the other, of a rotation."""
    b = -atan2(turn[2, 0], hypot(turn[0, 0], turn[1, 0]))
    return atan2(turn[1, 0], turn[0, 0]), b, atan2(turn[2, 1], turn[2, 2])


def _list(values: Array) -> str:
    return f"[{', '.join(f'{x + 0.0:.4g}' for x in values)}]"


def _braced(text: str) -> str:
    return f"{{{text[1:-1]}}}"
