"""Inertias that bodies can have, nearest to identified base parameters (extra `urdf`: cvxpy).

A body's ten standard parameters are those of some distribution of positive mass if, and only if,
its pseudo-inertia [[S, h], [h', m]] is positive definite, S = trace(I) 1 / 2 - I (Wensing, Kim and
Slotine, IEEE RA-L 3 (2018) 60). The base parameters are moved by as few of their errors as that
needs; of all bodies with these base parameters, those next to the description's own are taken,
since base parameters leave much of them open.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.rigid import SYMBOLS
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, UsageFault

LENGTH = 0.1  # m: with lengths in decimetres the entries of a pseudo-inertia are of one size
MARGIN = 1e-4  # kg: smallest eigenvalue with such lengths
PRICE = 1e-4  # squared errors for a kg2 away from the description's bodies: tells apart what the
# base parameters leave open, and keeps masses finite where they would rather be endless
ROUNDING = 1e-12  # kg m2: less is the solver's
POSITIVE = re.compile(r"(Ia|fv|fs)\d+[+-]?")  # names of what an axis cannot have less than none of


@dataclass(frozen=True)
class Physical:
    """Bodies and axes that can be, and their base parameters.

    `bodies` (joints, 10) in the order of SYMBOLS, about the frame of each link; `axes` by name;
    `base` (parameters); `moved` (parameters): by how many errors from the estimates.
    """

    bodies: Array
    axes: dict[str, float]
    base: Array
    moved: Array


def nearest(robot: Robot, estimates: Array, errors: Array) -> Physical:
    """Nearest in errors; a parameter whose error is nan is free."""
    cvxpy = _cvxpy()
    assert robot.body
    joints = len(robot.joints)
    standard = [f"{symbol}{i}" for i in range(1, joints + 1) for symbol in SYMBOLS]
    names = dict.fromkeys(name for p in robot.parameters for name, _ in p.parts)
    axes = [name for name in names if name not in standard]
    B, A = _combinations(robot, standard), _combinations(robot, axes)
    weights = 1.0 / np.where(np.isfinite(errors), errors, np.inf)
    weights = weights if weights.any() else np.ones(len(estimates))
    pseudo = [cvxpy.Variable((4, 4), symmetric=True) for _ in range(joints)]
    bodies = [_standard(J, cvxpy.hstack) for J in pseudo]
    beside = cvxpy.Variable(len(axes))
    away = cvxpy.multiply(weights, B @ cvxpy.hstack(bodies) + A @ beside - estimates)
    positive = [i for i, name in enumerate(axes) if POSITIVE.fullmatch(name)]
    bounds = [beside[positive] >= 0.0] if positive else []
    inside = [J >> MARGIN * np.eye(4) for J in pseudo]
    own = np.array(robot.body.standard).reshape(joints, 10)
    apart = [cvxpy.sum_squares(J - pseudo_inertia(x)) for J, x in zip(pseudo, own, strict=True)]
    beyond = sum(apart) + cvxpy.sum_squares(beside)
    smallest = cvxpy.Minimize(cvxpy.sum_squares(away) + PRICE * beyond)
    _solved(cvxpy.Problem(smallest, [*bounds, *inside]))
    found = np.array([np.asarray(body.value, dtype=np.float64) for body in bodies])
    found[np.abs(found) < ROUNDING] = 0.0
    values = np.asarray(beside.value, dtype=np.float64)
    theta = B @ found.ravel() + A @ values
    with np.errstate(invalid="ignore"):
        moved = (theta - estimates) / errors
    return Physical(found, dict(zip(axes, values.tolist(), strict=True)), theta, moved)


def inertia_of(body: Array) -> Array:
    """The inertia tensor of standard parameters in the order of SYMBOLS [kg m2]."""
    Ixx, Ixy, Ixz, Iyy, Iyz, Izz = body[:6]
    return np.array([[Ixx, Ixy, Ixz], [Ixy, Iyy, Iyz], [Ixz, Iyz, Izz]])


def pseudo_inertia(body: Array) -> Array:
    """Of standard parameters in the order of SYMBOLS, with lengths in LENGTH [kg]."""
    inertia, h, m = inertia_of(body), body[6:9], body[9]
    pseudo = np.empty((4, 4))
    pseudo[:3, :3] = (0.5 * np.trace(inertia) * np.eye(3) - inertia) / LENGTH**2
    pseudo[:3, 3] = pseudo[3, :3] = h / LENGTH
    pseudo[3, 3] = m
    return pseudo


def _standard(J: Any, stack: Any) -> Any:
    """The other way, for cvxpy's expressions."""
    S = LENGTH**2 * J[:3, :3]
    inertia = [S[1, 1] + S[2, 2], -S[0, 1], -S[0, 2], S[0, 0] + S[2, 2], -S[1, 2]]
    moments = [LENGTH * J[k, 3] for k in range(3)]
    return stack([*inertia, S[0, 0] + S[1, 1], *moments, J[3, 3]])


def _combinations(robot: Robot, names: list[str]) -> Array:
    """How the base parameters are made up of these."""
    place = {name: k for k, name in enumerate(names)}
    matrix = np.zeros((len(robot.parameters), len(names)))
    for row, parameter in enumerate(robot.parameters):
        for name, factor in parameter.parts:
            if name in place:
                matrix[row, place[name]] = factor
    return matrix


def _solved(problem: Any) -> None:
    problem.solve(solver="CLARABEL")
    if problem.status not in ("optimal", "optimal_inaccurate"):
        raise BadData(f"no bodies were found that come near these parameters: {problem.status}")


def _cvxpy() -> Any:
    try:
        import cvxpy
    except ImportError:
        raise UsageFault(
            "physical consistency needs cvxpy and Pinocchio: pip install 'scarid[urdf]'"
        ) from None
    return cvxpy
