"""Separable least squares with Stribeck friction (Golub and Pereyra 1973; the paper's ref. 46).

Each joint with Coulomb friction gets a further term that decays with speed,
Fst sign(dq) exp(-(dq / vs)^2). The Stribeck velocities vs are found by a search; all other
parameters are linear and are solved for in each trial. Joints are weighted by their residuals. All
rows are held in memory. No settings.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from scarid_cli.algorithms.regression.estimation import (
    Estimation,
    HoldingEstimator,
    RobotEstimator,
    Scores,
)
from scarid_cli.algorithms.regression.information import (
    NotIdentifiableError,
    inverse_deviations,
    least_squares,
)
from scarid_cli.algorithms.regression.rows import Rows, joined
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.terms import Coulomb, Stribeck
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

GRID = 15  # trials of each velocity before the simplex search
RANGE = (0.01, 1.0)  # of the velocities, relative to the root-mean-square velocity
FADED = 3.0  # velocities after which this friction has faded to 1e-4: no row would show it


@dataclass(frozen=True)
class Estimator(RobotEstimator, HoldingEstimator):
    ALIGNS: ClassVar[bool] = False

    def for_robot(self, robot: Robot) -> Self:
        if not any(isinstance(p.term, Coulomb) for p in robot.parameters):
            raise UsageFault(
                f"separable: robot {robot.name} has no joint with Coulomb friction; use another "
                "estimator"
            )
        return super().for_robot(robot)

    def fit(self, state: list[Rows]) -> Estimation:
        joints = [p.term.joint for p in self.robot.parameters if isinstance(p.term, Coulomb)]
        units = [self.robot.joints[j - 1] for j in joints]
        added = (
            *((f"Fst{j}", u.torque_unit) for j, u in zip(joints, units, strict=True)),
            *((f"vs{j}", f"{u.unit}/s") for j, u in zip(joints, units, strict=True)),
        )
        try:
            return replace(_solved(joined(state), joints), added=added)
        except NotIdentifiableError as error:
            raise NotIdentifiableError(error.direction, [name for name, _ in added]) from None


def _solved(rows: Rows, joints: list[int]) -> Estimation:
    """With the velocities that leave the least residual."""
    inverse = _inverse_deviations(rows)
    velocities = _searched(rows, joints, inverse)
    linear = _with_columns(rows, [_column(rows, j, v) for j, v in velocities.items()])
    theta = least_squares(linear.W, linear.y, rows.scales * inverse).estimates
    # Linearised at the solution, the velocities are parameters like all others.
    peaks = theta[-len(joints) :]
    slopes = [
        (j, peak * slope)
        for (j, v), peak in zip(velocities.items(), peaks, strict=True)
        for slope in [_slope(rows, j, v)]
    ]
    found = np.array(list(velocities.values()))
    y = linear.y.copy()
    for (j, slope), v in zip(slopes, found, strict=True):
        y[:, j - 1] += slope * v
    whole = replace(_with_columns(linear, slopes), y=y)
    fit = least_squares(whole.W, whole.y, rows.scales * inverse)
    scores = Scores(whitening=np.diag(inverse), rows=whole)
    return Estimation(replace(fit, estimates=np.concatenate((theta, found))), scores)


def _column(rows: Rows, joint: int, velocity: float) -> tuple[int, Array]:
    """The joint, and the column of its Stribeck friction with this velocity vs."""
    return joint, Stribeck(joint, velocity).torque(rows.motion[1][joint - 1])


def _slope(rows: Rows, joint: int, velocity: float) -> Array:
    """The derivative of the column by the Stribeck velocity."""
    dq = rows.motion[1][joint - 1]
    slope: Array = _column(rows, joint, velocity)[1] * 2.0 * dq * dq / velocity**3
    return slope


def _with_columns(rows: Rows, columns: list[tuple[int, Array]]) -> Rows:
    """The rows with more columns, each of which acts on one joint (from 1)."""
    added = np.zeros((*rows.y.shape, len(columns)))
    for k, (joint, values) in enumerate(columns):
        added[:, joint - 1, k] = values
    return replace(rows, W=np.ascontiguousarray(np.concatenate((rows.W, added), axis=2)))


def _inverse_deviations(rows: Rows) -> Array:
    """The inverse standard deviation of each joint's residual without Stribeck friction."""
    theta = least_squares(rows.W, rows.y, rows.scales).estimates
    residual = (rows.y - rows.W @ theta) * rows.scales
    rms = np.sqrt((residual**2).sum(axis=0) / np.maximum((rows.scales > 0.0).sum(axis=0), 1))
    return inverse_deviations(rms)


def _searched(rows: Rows, joints: list[int], inverse: Array) -> dict[int, float]:
    """The velocities with the smallest residual: first each by itself, then all together."""
    from scipy.optimize import minimize

    cost = _cost(rows, joints, inverse)
    sizes = [float(np.sqrt(np.mean(rows.motion[1][j - 1] ** 2))) or 1.0 for j in joints]
    grids = [np.log(np.geomspace(*RANGE, GRID) * size) for size in sizes]
    best = np.array([grid[GRID // 2] for grid in grids])
    for k, grid in enumerate(grids):
        tries = np.tile(best, (GRID, 1))
        tries[:, k] = grid
        best = tries[int(np.argmin([cost(x) for x in tries]))]
    options = {"xatol": 1e-6, "fatol": 1e-12, "maxiter": 400}
    found = minimize(cost, best, method="Nelder-Mead", options=options)
    least = [
        max(RANGE[0] / 10.0 * size, _slowest(rows, j) / FADED)
        for j, size in zip(joints, sizes, strict=True)
    ]
    most = [max(RANGE[1] * 10.0 * size, low) for size, low in zip(sizes, least, strict=True)]
    x = np.clip(found.x, np.log(least), np.log(most))
    return dict(zip(joints, np.exp(x).tolist(), strict=True))


def _slowest(rows: Rows, joint: int) -> float:
    """The velocity of a joint (from 1) in the slowest of its rows that count."""
    counts = rows.scales[:, joint - 1] > 0.0
    return float(np.abs(rows.motion[1][joint - 1, counts]).min()) if counts.any() else 0.0


def _cost(rows: Rows, joints: list[int], inverse: Array) -> Callable[[Array], float]:
    """The relative residual sum of squares, as a function of the logarithms of the velocities."""
    scales = rows.scales * inverse
    p = rows.W.shape[2]
    W = (rows.W * scales[:, :, None]).reshape(-1, p)
    y = (rows.y * scales).ravel()
    gram, with_y, squares = W.T @ W, W.T @ y, float(y @ y)

    def cost(x: Array) -> float:
        size = p + len(joints)
        A, b = np.zeros((size, size)), np.zeros(size)
        A[:p, :p], b[:p] = gram, with_y
        for k, (joint, log_velocity) in enumerate(zip(joints, x, strict=True), start=p):
            _, column = _column(rows, joint, float(np.exp(log_velocity)))
            column = column * scales[:, joint - 1]
            A[:p, k] = A[k, :p] = (rows.W[:, joint - 1] * scales[:, joint - 1, None]).T @ column
            A[k, k] = column @ column
            b[k] = column @ (rows.y[:, joint - 1] * scales[:, joint - 1])
        size_of = np.sqrt(np.diag(A))
        size_of[size_of == 0.0] = 1.0
        solution = np.linalg.lstsq(A / np.outer(size_of, size_of), b / size_of, rcond=1e-12)[0]
        return float(1.0 - solution @ (b / size_of) / squares)

    return cost
