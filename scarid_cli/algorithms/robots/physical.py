"""Physically consistent link inertias nearest to identified base parameters (extra `urdf`: cvxpy).

Ten standard parameters are those of a body with positive mass density if, and only if, its
pseudo-inertia [[S, h], [h', m]] is positive definite, with S = trace(I) 1 / 2 - I (Wensing, Kim and
Slotine, IEEE RA-L 3 (2018) 60). These bodies form a convex set, so the nearest base parameters are
the solution of a semidefinite program, as in Sousa and Cortesao (Int. J. Robotics Research 33
(2014) 931). Base parameters leave much of the bodies open: of all bodies that have them, those
closest to the bodies of the URDF are taken.

The distance is the Mahalanobis distance with the classical covariance C = s^2 (W'W)^-1 of the
estimates, up to a factor. Its square is |W (theta - estimates)|^2 / s^2, the growth of the sum of
squared residuals in units of the residual variance: the nearest parameters are the constrained
least-squares fit. And because the set is convex and contains the true parameters, the nearest
parameters predict the torques of the identification motion no worse than the estimates do,
compared with the true torques, whatever the noise.
"""

from __future__ import annotations

import contextlib
import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.rigid import SYMBOLS
from scarid_cli.arrays import Array, Numbers
from scarid_cli.errors import BadData, UsageFault

LENGTH = 0.1  # m: with lengths in decimetres the entries of a pseudo-inertia are of similar size
LEAST_EIGENVALUE = 1e-4  # of a pseudo-inertia whose diagonal is 1 for the link as described,
SMALLER = 0.5  # or this part of what a flat link has as described
ACCURACY = 1e-6  # of such an eigenvalue that the solver finds
LIGHT = 0.01  # kg: the scale of lighter links; that of links without a mass is 1 kg
POINT = 1e-3  # of the mass: the least scale of an inertia, a radius of 3 mm
PRICE = 1e-4  # squared errors per square of the distance from the URDF's bodies, in their masses:
# decides what the base parameters leave open, and keeps masses finite where the nearest ones would
# be infinite
SOLVER_ROUNDING = 1e-12  # kg m2: smaller values are left over by the solver
# Of an estimate, and of the largest one: smaller errors are beyond the solver's accuracy.
RESOLUTIONS = (1e-6, 0.0), (1e-6, 1e-6), (1e-5, 1e-5)
YIELD = 1.0  # squared errors: by one standard deviation the zeros of dropped parameters may move
# the estimates, beyond what dropping them did
NEGLIGIBLE = 1e-4  # errors: a dropped parameter that is smaller is zero
CONFIDENCE = 0.95
POSITIVE = re.compile(r"(Ia|fv|fs)m?\d+[+-]?")  # motor inertias and friction cannot be negative
POWERS = {"kg m2": 2, "kg m": 1}  # of LENGTH in the units of inertial parameters


@dataclass(frozen=True)
class Physical:
    """Physically consistent link inertias and axis terms, and their base parameters.

    `bodies` (joints, 10) in the order of SYMBOLS, about the frame of each link [kg m2, kg m, kg];
    `axes` motor inertias, friction and offsets by name; `base` (parameters) in the units of the
    robot's parameters; `distance` is the Mahalanobis distance from the estimates.
    """

    bodies: Array
    axes: dict[str, float]
    base: Array
    distance: float


def nearest(
    robot: Robot, estimates: Array, covariance: Array, dropped: Sequence[int] = ()
) -> Physical:
    """The physically consistent parameters at the smallest Mahalanobis distance.

    `covariance` (parameters, parameters) is positive semidefinite except for rows and columns of
    nan: a parameter with a nan variance is free. The `dropped` parameters (indices) are kept at
    zero where that is possible (see `_smallest`): without other constraints this is least squares
    without their columns, if `estimates` and `covariance` are those of all parameters.

    Where the solver gives up, as with the errors of a log without noise, errors are taken to be
    larger, a little more each time.
    """
    for resolution in RESOLUTIONS[:-1]:
        with contextlib.suppress(BadData):
            return _nearest(robot, estimates, covariance, dropped, resolution)
    return _nearest(robot, estimates, covariance, dropped, RESOLUTIONS[-1])


def _nearest(
    robot: Robot,
    estimates: Array,
    covariance: Array,
    dropped: Sequence[int],
    resolution: tuple[float, float],
) -> Physical:
    arm = Arm.of(robot)
    away, tie = whitened(arm.base, estimates, covariance, resolution)
    differences = arm.cvxpy.hstack([away, *(np.sqrt(PRICE) * x for x in arm.beyond)])
    constraints = [*arm.constraints, *tie]
    zero, penalty = np.empty(0, dtype=np.int64), 0.0
    if len(dropped):
        at = np.array(dropped)
        price = YIELD + _reduction(estimates, covariance, at)
        scaled = arm.cvxpy.multiply(1.0 / _scales(robot, covariance, at), arm.base[at])
        smallest = _smallest(arm, scaled, differences, constraints, price)
        penalty = arm.cvxpy.sum_squares(arm.cvxpy.multiply(1.0 / smallest, scaled))
        zero = at[smallest <= NEGLIGIBLE]
    cost = arm.cvxpy.sum_squares(differences) + penalty
    solved(arm.cvxpy.Problem(arm.cvxpy.Minimize(cost), constraints))
    distance = float(np.linalg.norm(away.value)) if away.size else 0.0
    return _rounded(robot, arm, zero, distance)


def chi_square(freedom: int) -> float:
    """The 95 % point of the chi-square distribution.

    The true parameters are physically consistent, so the nearest ones are no farther from the
    estimates than the true ones: a squared Mahalanobis distance that exceeds this point for the
    number of estimates cannot be explained by their uncertainty.
    """
    from scipy.special import chdtri

    return float(chdtri(freedom, 1.0 - CONFIDENCE))


@dataclass(frozen=True)
class Arm:
    """The unknowns of the semidefinite program, and what is linear or quadratic in them.

    `base` = of_bodies @ bodies + of_axes @ beside; `beyond` is the difference of the bodies from
    those of the URDF, in their masses, and `beside`, in SI units over the mass of the arm [kg].
    """

    cvxpy: Any
    bodies: list[Any]
    beside: Any
    axes: list[str]
    of_bodies: Array
    of_axes: Array
    constraints: list[Any]
    beyond: list[Any]

    @classmethod
    def of(cls, robot: Robot) -> Arm:
        cvxpy = _cvxpy()
        assert robot.body
        links = robot.body.link_numbers
        standard = [f"{symbol}{i}" for i in links for symbol in SYMBOLS]
        names = dict.fromkeys(name for p in _parts(robot) for name, _ in p)
        axes = [name for name in names if name not in standard]
        own = np.array(robot.body.standard).reshape(len(links), 10)
        scales = [_scale(x) for x in own]
        scaled = [cvxpy.Variable((4, 4), symmetric=True) for _ in links]
        pseudo = [cvxpy.multiply(s, K) for s, K in zip(scales, scaled, strict=True)]
        beside = cvxpy.Variable(len(axes))
        positive = [i for i, name in enumerate(axes) if POSITIVE.fullmatch(name)]
        bounds = [beside[positive] >= 0.0] if positive else []
        apart = [
            cvxpy.vec(J - pseudo_inertia(x), order="F") / s[3, 3]
            for J, s, x in zip(pseudo, scales, own, strict=True)
        ]
        return cls(
            cvxpy,
            [standard_of(J, cvxpy.hstack) for J in pseudo],
            beside,
            axes,
            _combinations(robot, standard),
            _combinations(robot, axes),
            [
                *bounds,
                *(
                    K >> _least(pseudo_inertia(x) / s) * np.eye(4)
                    for K, s, x in zip(scaled, scales, own, strict=True)
                ),
            ],
            [*apart, beside / max(own[:, 9].sum(), 1.0)],  # which grow with the weight
        )

    @property
    def base(self) -> Any:
        """The base parameters."""
        return self.of_bodies @ self.cvxpy.hstack(self.bodies) + self.of_axes @ self.beside


def _scale(body: Array) -> Array:
    """The scale (4, 4) [kg] of a pseudo-inertia, by which its diagonal is about 1 as described.

    A link of next to no mass, or the mass of a point, may be a placeholder, and is no scale.
    """
    diagonal = np.diag(pseudo_inertia(body)).copy()
    diagonal[3] = max(diagonal[3], LIGHT) if diagonal[3] > 0.0 else 1.0
    diagonal[:3] = np.maximum(diagonal[:3], POINT * diagonal[3])
    size = np.sqrt(diagonal)
    return np.outer(size, size)


def _least(own: Array) -> float:
    """The smallest eigenvalue that a link may have whose scaled pseudo-inertia is its own."""
    described = float(np.linalg.eigvalsh(own)[0])
    return min(LEAST_EIGENVALUE, max(SMALLER * described, ACCURACY))


def whitened(
    base: Any, estimates: Array, covariance: Array, resolution: tuple[float, float] = RESOLUTIONS[0]
) -> tuple[Any, list[Any]]:
    """The whitened difference z with base - estimates = C^(1/2) z, and this constraint.

    Errors are at least the `resolution` of estimates (see RESOLUTIONS). C^(1/2) instead of
    C^(-1/2): the equation stays well scaled when C is nearly singular.
    """
    cvxpy = _cvxpy()
    known = np.flatnonzero(np.isfinite(np.diag(covariance)))
    away = cvxpy.Variable(len(known))
    if not len(known):
        return away, []
    sizes = np.abs(estimates[known])
    rounding = np.maximum(resolution[0] * sizes, resolution[1] * sizes.max())
    C = covariance[np.ix_(known, known)] + np.diag(rounding**2)
    errors = np.sqrt(np.diag(C))
    values, vectors = np.linalg.eigh(C / np.outer(errors, errors))
    rounded = len(values) * np.finfo(float).eps * values[-1]
    root = vectors * np.sqrt(np.maximum(values, rounded))
    return away, [cvxpy.multiply(1.0 / errors, base[known] - estimates[known]) == root @ away]


def _smallest(
    arm: Arm, scaled: Any, differences: Any, constraints: list[Any], price: float
) -> Array:
    """The smallest absolute values of dropped parameters (`scaled`), at least NEGLIGIBLE.

    Some cannot be zero: Izz5 + Iyy6 of two bodies is positive. The smallest sum of absolute values
    finds them, over all bodies that cost no more than the `price` beyond the nearest: what was
    estimated comes before what was dropped. As errors they keep each one as small as it can be.
    """
    cvxpy = arm.cvxpy
    cost = cvxpy.Problem(cvxpy.Minimize(cvxpy.sum_squares(differences)), constraints)
    # As a cone: a sum of squares that may be 1e4 is beyond the accuracy of the solver.
    near = cvxpy.norm(differences) <= np.sqrt(solved(cost) + price)
    solved(cvxpy.Problem(cvxpy.Minimize(cvxpy.norm1(scaled)), [*constraints, near]))
    smallest: Array = np.maximum(np.abs(scaled.value), NEGLIGIBLE)
    return smallest


def _rounded(robot: Robot, arm: Arm, zero: Numbers, distance: float) -> Physical:
    """The solution, with zeros for what the solver leaves of them."""
    bodies = np.array([np.asarray(body.value, dtype=np.float64) for body in arm.bodies])
    bodies[np.abs(bodies) < SOLVER_ROUNDING] = 0.0
    alone = {name for i in zero for (name, _), *more in [_parts(robot)[i]] if not more}
    values = np.asarray(arm.beside.value, dtype=np.float64)
    values[[name in alone for name in arm.axes]] = 0.0
    base = arm.of_bodies @ bodies.ravel() + arm.of_axes @ values
    base[zero] = 0.0
    return Physical(bodies, dict(zip(arm.axes, values.tolist(), strict=True)), base, distance)


def _reduction(estimates: Array, covariance: Array, dropped: Numbers) -> float:
    """The squared distance by which these zeros alone move the estimates."""
    block = covariance[np.ix_(dropped, dropped)]
    if not np.isfinite(block).all():
        return 0.0
    values = estimates[dropped]
    return float(values @ np.linalg.lstsq(block, values, rcond=None)[0])


def _scales(robot: Robot, covariance: Array, dropped: Numbers) -> Array:
    """The errors of dropped parameters, or what makes them as large as a pseudo-inertia."""
    errors = np.sqrt(np.diag(covariance)[dropped])
    sizes = [LENGTH ** POWERS.get(robot.parameters[i].unit, 0) for i in dropped]
    return np.where(np.isfinite(errors), errors, sizes)


def inertia_of(body: Array) -> Array:
    """The inertia tensor of standard parameters in the order of SYMBOLS [kg m2]."""
    Ixx, Ixy, Ixz, Iyy, Iyz, Izz = body[:6]
    return np.array([[Ixx, Ixy, Ixz], [Ixy, Iyy, Iyz], [Ixz, Iyz, Izz]])


def is_possible(body: Array) -> bool:
    """Whether a body can have these standard parameters, in the order of SYMBOLS."""
    return bool(np.linalg.eigvalsh(pseudo_inertia(body))[0] > 0.0)


def pseudo_inertia(body: Array) -> Array:
    """The pseudo-inertia of standard parameters in the order of SYMBOLS, lengths in LENGTH [kg]."""
    inertia, h, m = inertia_of(body), body[6:9], body[9]
    pseudo = np.empty((4, 4))
    pseudo[:3, :3] = (0.5 * np.trace(inertia) * np.eye(3) - inertia) / LENGTH**2
    pseudo[:3, 3] = pseudo[3, :3] = h / LENGTH
    pseudo[3, 3] = m
    return pseudo


def standard_of(J: Any, stack: Any) -> Any:
    """The standard parameters of a pseudo-inertia, joined by `stack` (of numpy, or of cvxpy)."""
    S = LENGTH**2 * J[:3, :3]
    inertia = [S[1, 1] + S[2, 2], -S[0, 1], -S[0, 2], S[0, 0] + S[2, 2], -S[1, 2]]
    moments = [LENGTH * J[k, 3] for k in range(3)]
    return stack([*inertia, S[0, 0] + S[1, 1], *moments, J[3, 3]])


def _parts(robot: Robot) -> list[tuple[tuple[str, float], ...]]:
    """What each parameter stands for; a term added by an estimator stands for itself."""
    return [p.parts or ((p.name, 1.0),) for p in robot.parameters]


def _combinations(robot: Robot, names: list[str]) -> Array:
    """The base parameters as combinations (parameters, names) of the named parameters."""
    place = {name: k for k, name in enumerate(names)}
    matrix = np.zeros((len(robot.parameters), len(names)))
    for row, parts in enumerate(_parts(robot)):
        for name, factor in parts:
            if name in place:
                matrix[row, place[name]] = factor
    return matrix


def solved(problem: Any) -> float:
    """The minimum; an answer of reduced accuracy will do."""
    from cvxpy.error import SolverError

    with warnings.catch_warnings(), contextlib.suppress(SolverError):
        warnings.filterwarnings("ignore", "Solution may be inaccurate", UserWarning)
        problem.solve(solver="CLARABEL")
    if problem.status not in ("optimal", "optimal_inaccurate"):
        raise BadData(
            "no physically consistent link inertias were found near these parameters "
            f"(solver: {problem.status}); identify them from a log that excites every joint"
        )
    return float(problem.value)


def _cvxpy() -> Any:
    try:
        import cvxpy
    except ImportError:
        raise UsageFault(
            "physical consistency needs cvxpy and Pinocchio: pip install 'scarid[urdf]'"
        ) from None
    return cvxpy
