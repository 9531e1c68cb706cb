"""What hangs on the flange: the ten inertial parameters of a payload, from two identifications.

The base parameters of the arm with the payload, less those of the bare arm, are a linear function
of the ten standard parameters of the payload as a part of the last link (Khalil and Dombre 2002,
section 9.7). Friction and offsets may differ as well: only rows of inertial parameters count, with
their covariance. What both identifications have in common, such as an error of the soft sensor,
drops out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.changes.body import nearest
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.physical import inertia_of, is_possible
from scarid_cli.algorithms.robots.rigid import SYMBOLS, Frame
from scarid_cli.arrays import Array
from scarid_cli.interval import HALF

KNOWN = 1e-6  # share of a parameter that must be in the rows, as a projection
MASS, MOMENTS, INERTIA = 9, [6, 7, 8], slice(6)
PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))  # of the axes, in the order of SYMBOLS
AS_GOOD = 0.01  # standard deviations, up to which a body is the estimate itself
NAMES = ("mass", "x", "y", "z", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz")
UNITS = ("kg", *("m",) * 3, *("kg m2",) * 6)


@dataclass(frozen=True)
class Payload:
    """Mass [kg], centre [m] and inertia about the centre [kg m2] in a frame, as in NAMES.

    `values` and `errors` (10); an error is nan where the motion does not tell the value. `body`
    (10) are the values of the nearest body that there can be, so many standard deviations `away`:
    nan and inf if less hangs there than on the bare robot.
    """

    values: Array
    errors: Array
    body: Array
    away: float

    @property
    def possible(self) -> bool:
        """Whether a body can have these values, of which it may have any that are not told."""
        return self.away < AS_GOOD

    @property
    def shown(self) -> bool:
        """Whether there is a mass, without which there is neither a centre nor an inertia."""
        return bool(abs(self.values[0]) > HALF * self.errors[0])

    @property
    def vague(self) -> list[str]:
        """The names of the moments and products of inertia that are not apart from 0."""
        known = zip(NAMES[4:], self.values[4:], self.errors[4:], strict=True)
        return [name for name, x, error in known if np.isfinite(error) and HALF * error > abs(x)]

    @property
    def told(self) -> Array:
        """The values (10) of the body, which are the estimates if there can be such a body.

        nan where the motion does not tell the value.
        """
        return np.where(np.isfinite(self.errors), self.body, np.nan)


@dataclass(frozen=True)
class Standard:
    """The ten standard parameters of a payload as a part of the last link.

    `phi` (10) with its `covariance` (10, 10), nan where the rows do not tell one. Their information
    is factor' factor (rows, 10).
    """

    phi: Array
    covariance: Array
    factor: Array


def directions(robot: Robot) -> Array:
    """How the base parameters (parameters, 10) depend on the standard ones of the last link."""
    assert robot.body
    last = robot.body.link_numbers[-1]
    found = np.zeros((len(robot.parameters), len(SYMBOLS)))
    for row, parameter in enumerate(robot.parameters):
        parts = dict(parameter.parts)
        found[row] = [parts.get(f"{symbol}{last}", 0.0) for symbol in SYMBOLS]
    return found


def standard(B: Array, difference: Array, covariance: Array) -> Standard:
    """The ten standard parameters.

    By generalised least squares: `difference` (parameters) of base parameters, with its
    `covariance` (parameters, parameters), nan for those that are not known.
    """
    rows = np.flatnonzero(np.any(B != 0.0, axis=1) & np.isfinite(np.diag(covariance)))
    C = covariance[np.ix_(rows, rows)]
    scale = np.sqrt(np.diag(C))
    values, vectors = np.linalg.eigh(C / np.outer(scale, scale))
    white = (vectors / np.sqrt(np.maximum(values, values[-1] * 1e-12))).T / scale
    U, s, Vt = np.linalg.svd(white @ B[rows], full_matrices=False)
    kept = s > KNOWN * s[0]
    inverse = Vt[kept].T / s[kept]
    phi = inverse @ (U[:, kept].T @ (white @ difference[rows]))
    spread = inverse @ inverse.T
    unknown = np.sum(Vt[kept] ** 2, axis=0) < 1.0 - KNOWN
    spread[unknown, :] = spread[:, unknown] = np.nan
    return Standard(phi, spread, s[kept, None] * Vt[kept])


def in_frame(found: Standard, frame: Frame) -> Payload:
    """The payload in a frame that is fixed to the last axis."""
    values, errors = located(found.phi, found.covariance, frame)
    free = Payload(values, errors, values, 0.0)
    if not free.shown:
        return replace(free, errors=np.array([errors[0], *[np.nan] * 9]))
    if values[0] < 0.0:  # what was taken away: no body hangs there
        return replace(free, body=np.full(10, np.nan), away=np.inf)
    if is_possible(found.phi):
        return free
    nearby, away = nearest(found.phi, found.factor)
    return replace(free, body=_of_centre(nearby, frame), away=away)


def located(phi: Array, covariance: Array, frame: Frame) -> tuple[Array, Array]:
    """Mass, centre and inertia about it in a frame, and their errors to first order (10).

    Of the standard parameters and their covariance, which is nan where one is not told: an error
    that depends on it is nan.
    """
    known = np.isfinite(np.diag(covariance))
    J = _slopes(phi, frame)
    spread = np.where(np.isfinite(covariance), covariance, 0.0)
    errors = np.sqrt(np.diag(J @ spread @ J.T))
    told = np.all((J[:, ~known] == 0.0), axis=1) if not known.all() else np.ones(10, dtype=bool)
    return _of_centre(phi, frame), np.where(told, errors, np.nan)


def _slopes(phi: Array, frame: Frame) -> Array:
    """The derivatives of the values by the standard parameters (10, 10)."""
    steps = 1e-6 * np.maximum(np.abs(phi), 1e-3 * max(abs(phi[MASS]), 1e-3))
    return np.column_stack(
        [
            (_of_centre(phi + step * e, frame) - _of_centre(phi - step * e, frame)) / (2.0 * step)
            for step, e in zip(steps, np.eye(10), strict=True)
        ]
    )


def _of_centre(phi: Array, frame: Frame) -> Array:
    """Mass, centre and inertia about the centre, from the standard parameters."""
    m = phi[MASS]
    centre = phi[MOMENTS] / m
    about = inertia_of(phi) - m * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    turned = frame.turn.T @ about @ frame.turn
    place = frame.turn.T @ (centre - frame.origin)
    return np.array([m, *place, *(turned[i, j] for i, j in PAIRS)])
