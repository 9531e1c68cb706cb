"""The square-root information of a linear regression, and the estimates it holds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.kernels import information


class NotIdentifiableError(ValueError):
    """The data leave a combination of parameters free; `direction` is it, of unit length."""

    def __init__(self, direction: Array) -> None:
        super().__init__("the data do not determine all parameters")
        self.direction = direction


@dataclass(frozen=True)
class Information:
    """What the rows so far say: |R theta - z|^2 + residual, with R and z in one triangle.

    `weight` is the number of rows, each weighted by what forgetting left of it.
    """

    triangle: Array
    residual: float = 0.0
    weight: float = 0.0

    @property
    def parameters(self) -> int:
        return len(self.triangle)


@dataclass(frozen=True)
class Fit:
    """Estimates, their covariance for a residual variance of 1 (eq. 33), and the residual.

    `variance` is that of the residual, s^2 = |rho|^2 / (r - c); nan without redundancy.
    `condition` is the condition number of the observation matrix.
    """

    estimates: Array
    unit_covariance: Array
    variance: float
    condition: float

    def standard_errors(self, *, unit_variance: bool = False) -> Array:
        """Square roots of the diagonal of the covariance; with unit variance, eq. 32-33."""
        variance = 1.0 if unit_variance else self.variance
        errors: Array = np.sqrt(variance * np.diag(self.unit_covariance))
        return errors


def empty(parameters: int) -> Information:
    """Nothing known."""
    return Information(np.zeros((parameters, parameters + 1)))


def prior(estimates: Array, p0: float) -> Information:
    """Initial parameters with covariance P0 = p0 I."""
    root = np.eye(len(estimates)) / np.sqrt(p0)
    return Information(np.column_stack((root, root @ estimates)))


def absorb(
    state: Information,
    W: Array,
    y: Array,
    *,
    forgetting: float = 1.0,
    floor: float = 0.0,
    trace: bool = False,
) -> tuple[Information, Array]:
    """Take rows in; with `trace`, also the estimates after each sample.

    `floor` is the least that forgetting leaves on the diagonal of the triangle.
    """
    samples, _, parameters = W.shape
    triangle = state.triangle.copy()
    sums = np.array([state.residual, state.weight])
    estimates = np.empty((samples if trace else 0, parameters))
    work = np.empty(parameters + 1)
    information.update(W, y, triangle, work, sums, estimates, forgetting, floor)
    return Information(triangle, float(sums[0]), float(sums[1])), estimates


def solve(state: Information) -> Fit:
    """Estimates and statistics; NotIdentifiableError if the triangle is singular to rounding."""
    p = state.parameters
    R, z = state.triangle[:, :p], state.triangle[:, p]
    _check_rank(R, max(p, state.weight))
    singular = np.linalg.svd(R, compute_uv=False)
    inverse = np.linalg.inv(R)
    freedom = state.weight - p
    return Fit(
        estimates=np.asarray(np.linalg.solve(R, z), dtype=np.float64),
        unit_covariance=inverse @ inverse.T,
        variance=state.residual / freedom if freedom > 0 else float("nan"),
        condition=float(singular[0] / singular[-1]),
    )


def _check_rank(R: Array, rows: float) -> None:
    """By the singular values of R with columns of unit length, so that units do not matter."""
    length = np.sqrt((R * R).sum(axis=0))
    if not np.all(length > 0.0):
        free = np.where(length > 0.0, 0.0, 1.0)
        raise NotIdentifiableError(free / np.linalg.norm(free))
    _, singular, directions = np.linalg.svd(R / length)
    if not singular[-1] > singular[0] * rows * np.finfo(float).eps:
        free = directions[-1] / length
        raise NotIdentifiableError(free / np.linalg.norm(free))
