"""Linear least squares in information form: accumulating rows, and solving for the estimates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.kernels import information

# Variance of the residual: with r - c degrees of freedom, 1 as printed in eq. 32-33, with r - 1.
RESIDUAL, UNIT, SAMPLE = "residual", "unit", "sample"
ROUNDING = 1e-15  # the relative error of the largest eigenvalue of a matrix
RUNNING = 4  # numbers of the running residual of a joint, see the kernel
EXACT = 1e-6  # of the largest residual, below which that of another joint is rounding
PART = 4096  # rows that are reflected at a time: those of 100 columns take 3 MB
NOTHING = 1e-150  # a standard deviation whose square is not a number any more


class NotIdentifiableError(ValueError):
    """The data do not determine a combination of parameters; `direction` is its unit vector.

    `added` are the names of parameters that come after the robot's own.
    """

    def __init__(self, direction: Array, added: Sequence[str] = ()) -> None:
        super().__init__("the data do not determine all parameters")
        self.direction = direction
        self.added = tuple(added)


@dataclass(frozen=True)
class Information:
    """The information of the rows so far, as the kernel keeps it: R as a weighted unit triangle.

    `weighted` (parameters, parameters + 1) has the weights on its diagonal. `residual` is the
    residual sum of squares. `weight` is the number of rows and `count` that of the samples, each
    reduced by forgetting.
    """

    weighted: Array
    residual: float = 0.0
    weight: float = 0.0
    count: float = 0.0

    @property
    def parameters(self) -> int:
        return len(self.weighted)

    @property
    def triangle(self) -> Array:
        """[R z], such that the sum of squares is |R theta - z|^2 + residual."""
        unit = self.weighted.copy()
        np.fill_diagonal(unit, 1.0)
        triangle: Array = np.sqrt(np.diag(self.weighted))[:, None] * unit
        return triangle


@dataclass(frozen=True)
class Fit:
    """The numbers of a linear fit.

    `estimates` (parameters) have the covariance `unit_covariance` if the variance of the residual
    is 1 (eq. 33). `variance` is that of the residual, s^2 = |rho|^2 / (r - c), nan if there are no
    more rows than parameters; `sample_variance` is |rho|^2 / (r - 1). `condition` is the condition
    number of the observation matrix.
    """

    estimates: Array
    unit_covariance: Array
    variance: float
    condition: float
    sample_variance: float = float("nan")

    def standard_errors(self, variance: str = RESIDUAL) -> Array:
        """Standard errors (parameters), with the variance RESIDUAL, UNIT or SAMPLE."""
        size = {UNIT: 1.0, RESIDUAL: self.variance, SAMPLE: self.sample_variance}[variance]
        errors: Array = np.sqrt(size * np.diag(self.unit_covariance))
        return errors

    def part(self, kept: slice | list[int]) -> Fit:
        """The fit of some of the parameters, with the residual of the fit of all of them."""
        estimates, covariance = self.estimates[kept], self.unit_covariance[kept][:, kept]
        condition = self.condition
        if len(estimates) < len(self.estimates):
            condition = condition_number(covariance)
        return replace(self, estimates=estimates, unit_covariance=covariance, condition=condition)


def condition_number(covariance: Array) -> float:
    """The condition number of the observation matrix, from the covariance of its estimates.

    Of the triangle of the covariance, as that of the covariance is its square, of which half the
    digits are left; inf if there is none.
    """
    try:
        return float(np.linalg.cond(np.linalg.cholesky(covariance)))
    except np.linalg.LinAlgError:
        return float("inf")


def empty(parameters: int) -> Information:
    """The information of no rows."""
    return Information(np.zeros((parameters, parameters + 1)))


def prior(estimates: Array, p0: float) -> Information:
    """The information of initial parameters with covariance P0 = p0 I."""
    return Information(np.column_stack((np.eye(len(estimates)) / p0, estimates)))


def absorb(
    state: Information,
    W: Array,
    y: Array,
    scales: Array | None = None,
    *,
    forgetting: Array | None = None,
    floor: float = 0.0,
    residuals: Array | None = None,
    apart: float = 1.0,
    trace: bool = False,
) -> tuple[Information, Array]:
    """The information after these rows, each multiplied by its scale.

    With `trace` the estimates after each sample (samples, parameters) are returned as well.
    `forgetting` (parameters) are factors per sample; `floor` is the information on each parameter
    that forgetting leaves in the long run. `residuals` (joints, RUNNING), if given, are the running
    residuals by which joints are weighted, and are changed in place; `apart` is the number of rows
    for each that is independent.
    """
    samples, _, parameters = W.shape
    weighted = state.weighted.copy()
    sums = np.array([state.residual, state.weight, state.count])
    estimates = np.empty((samples if trace else 0, parameters))
    information.update(
        W,
        y,
        np.ones(y.shape) if scales is None else scales,
        weighted,
        np.empty(parameters + 1),
        sums,
        estimates,
        np.ones(parameters) if forgetting is None else forgetting,
        floor,
        np.empty((0, RUNNING)) if residuals is None else residuals,
        apart,
    )
    return Information(weighted, *map(float, sums)), estimates


def condensed(W: Array, y: Array, scales: Array) -> Information:
    """The information of rows (samples, parameters) that are there as a whole, to rounding.

    By Householder's reflections of many rows at a time (LAPACK), and without the columns that are
    zero, as in the rows of the last joints of an arm.
    """
    there = np.flatnonzero(W.any(axis=0))
    used = [*there.tolist(), W.shape[1]]
    triangle = np.zeros((0, len(used)))
    for start in range(0, len(y), PART):
        part = slice(start, start + PART)
        rows = np.column_stack((W[part, there], y[part])) * scales[part, None]
        triangle = np.asarray(np.linalg.qr(np.concatenate((triangle, rows)), mode="r"))
    wide = np.zeros((len(triangle), 1, W.shape[1] + 1))
    wide[:, 0, used] = triangle
    found, _ = absorb(
        empty(W.shape[1]), np.ascontiguousarray(wide[:, :, :-1]), wide[:, :, -1].copy()
    )
    return replace(found, weight=float(np.count_nonzero(scales)), count=float(len(y)))


def merged(parts: Sequence[Information], scales: Sequence[float]) -> Information:
    """The information of several sets of rows together, each set multiplied by its scale."""
    total = empty(parts[0].parameters)
    for part, scale in zip(parts, scales, strict=True):
        triangle = part.triangle
        W, y = triangle[:, None, :-1], triangle[:, None, -1]
        both, _ = absorb(total, np.ascontiguousarray(W), y.copy(), np.full(y.shape, scale))
        total = Information(
            both.weighted,
            both.residual + scale**2 * part.residual,
            total.weight + part.weight,
            total.count + part.count,
        )
    return total


def solve(state: Information) -> Fit:
    """Estimates and statistics; NotIdentifiableError if R is singular to working precision."""
    p = state.parameters
    triangle = state.triangle
    R, z = triangle[:, :p], triangle[:, p]
    _check_rank(R, max(p, state.weight))
    singular = np.linalg.svd(R, compute_uv=False)
    inverse = np.linalg.inv(R)
    freedom = state.weight - p
    with np.errstate(divide="ignore"):
        condition = float(singular[0] / singular[-1])
    return Fit(
        estimates=np.asarray(np.linalg.solve(R, z), dtype=np.float64),
        unit_covariance=inverse @ inverse.T,
        variance=state.residual / freedom if freedom > 0 else float("nan"),
        sample_variance=state.residual / (state.weight - 1.0) if freedom > 0 else float("nan"),
        condition=condition,
    )


def least_squares(W: Array, y: Array, scales: Array | None = None) -> Fit:
    """The least-squares fit of these rows, each multiplied by its scale."""
    whole = (None if x is None else np.ascontiguousarray(x) for x in (W, y, scales))
    state, _ = absorb(empty(W.shape[2]), *whole)  # type: ignore[arg-type]
    return solve(state)


def residual_deviation(state: Information) -> float:
    """The standard deviation of the residual of the best fit; 0 if the fit is exact.

    Parameters that the rows do not determine are allowed, and not counted.
    """
    R = state.triangle[:, :-1]
    length = np.sqrt((R * R).sum(axis=0))
    rank = np.linalg.matrix_rank(R / np.where(length > 0.0, length, 1.0))
    return float(np.sqrt(state.residual / max(state.weight - rank, 1.0)))


def inverse_deviations(deviations: Array) -> Array:
    """The weights of joints whose residuals have these standard deviations.

    A joint that is fitted exactly, such as one without torque, must not outweigh all others: it
    counts as much as the joint with the largest residual.
    """
    largest = deviations.max()
    if not largest > NOTHING:
        return np.ones(len(deviations))
    exact = deviations < EXACT * largest
    return np.asarray(1.0 / np.where(exact, largest, deviations), dtype=np.float64)


def weakest(covariance: Array) -> tuple[float, Array]:
    """The condition number of W with columns of unit length, and its least determined direction.

    Both are computed from the covariance of the estimates and do not depend on units.
    """
    errors = np.sqrt(np.diag(covariance))
    gram = _inverse(covariance / np.outer(errors, errors))
    length = np.sqrt(np.diag(gram))
    values, directions = np.linalg.eigh(gram / np.outer(length, length))
    free = directions[:, 0] / length * errors
    return float(np.sqrt(values[-1] / max(values[0], 1e-300))), free / np.linalg.norm(free)


def _inverse(correlation: Array) -> Array:
    """The inverse of a correlation matrix, positive definite even where rounding left it singular.

    Eigenvalues below the rounding error of the largest one are replaced by that error.
    """
    values, vectors = np.linalg.eigh(correlation)
    inverse: Array = (vectors / np.maximum(values, ROUNDING * values[-1])) @ vectors.T
    return inverse


def _check_rank(R: Array, rows: float) -> None:
    """Raise NotIdentifiableError if R, with columns scaled to unit length, is singular."""
    length = np.sqrt((R * R).sum(axis=0))
    if not np.all(length > 0.0):
        free = np.where(length > 0.0, 0.0, 1.0)
        raise NotIdentifiableError(free / np.linalg.norm(free))
    _, singular, directions = np.linalg.svd(R / length)
    if not singular[-1] > singular[0] * rows * np.finfo(float).eps:
        free = directions[-1] / length
        raise NotIdentifiableError(free / np.linalg.norm(free))
