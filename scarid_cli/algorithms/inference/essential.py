"""Essential parameters: those that the data determine well enough to keep (Gautier and Khalil).

The least certain parameter is removed as long as its relative standard deviation is at least 30
times that of the most certain one, and as long as the loss can be due to noise: zero must lie
within the 95 % confidence region, under the full model, of all removed parameters together. Where
one parameter is very certain, the ratio alone would remove parameters that are known to a percent.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.information import Fit, condition_number
from scarid_cli.arrays import Array

RATIO = 30.0
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Essential:
    """The fit of the essential parameters, and what dropping the others cost.

    `kept` and `dropped` are indices of parameters, the latter in the order in which they were
    dropped. `cost` is the relative increase of the standard deviation of the residual, and
    `allowed` the increase that noise alone can explain.
    """

    fit: Fit
    kept: list[int]
    dropped: tuple[int, ...]
    cost: float
    allowed: float


@dataclass(frozen=True)
class Noise:
    """The uncertainty of a fit with autocorrelated residuals.

    `rows` is the number of fitted rows. `inflation` is the ratio of the robust variances of the
    estimates to those for white residuals, from this number of independent `blocks`.
    """

    rows: float
    inflation: float
    blocks: float

    def growth(self, dropped: int, variance: float) -> float:
        """How much the residual sum of squares may grow: an F test for autocorrelated residuals."""
        from scipy.special import fdtri

        point = fdtri(dropped, self.blocks - 1, CONFIDENCE)
        return float(dropped * point * self.inflation * variance)


def essential(fit: Fit, noise: Noise, own: int) -> Essential:
    """Drop those of the first `own` parameters that are not essential, one by one.

    After each of them the remaining parameters are fitted again.
    """
    theta, covariance = fit.estimates.copy(), fit.unit_covariance.copy()
    kept = list(range(len(theta)))
    dropped: list[int] = []
    first = squares = fit.variance * (noise.rows - len(theta))
    allowed = 0.0
    while (worst := _worst(theta, covariance, [i for i in kept if i < own])) is not None:
        grown = squares + theta[worst] ** 2 / covariance[worst, worst]
        growth = noise.growth(len(dropped) + 1, fit.variance)
        if not (np.isfinite(growth) and grown - first <= growth):
            break
        squares, allowed = grown, growth
        theta, covariance = without(theta, covariance, worst)
        kept.remove(worst)
        dropped.append(worst)
    cost, limit = (_relative(part, first) for part in (squares - first, allowed))
    if not dropped:
        return Essential(fit, kept, (), cost, limit)
    freedom = noise.rows - len(kept)
    variance = squares / freedom if freedom > 0 else float("nan")
    reduced = replace(
        fit,
        estimates=theta[kept],
        unit_covariance=covariance[np.ix_(kept, kept)],
        variance=variance,
        sample_variance=variance * freedom / (noise.rows - 1.0),
        condition=condition_number(covariance[np.ix_(kept, kept)]),
    )
    return Essential(reduced, kept, tuple(dropped), cost, limit)


def _worst(theta: Array, covariance: Array, kept: list[int]) -> int | None:
    """The least certain parameter, if it is 30 times less certain than the most certain one."""
    if len(kept) < 2:
        return None
    with np.errstate(divide="ignore"):
        relative = np.sqrt(np.diag(covariance)[kept]) / np.abs(theta[kept])
    return kept[int(np.argmax(relative))] if relative.max() >= RATIO * relative.min() else None


def _relative(growth: float, first: float) -> float:
    """The relative growth of the deviation of the residual, from that of its sum of squares."""
    return float(np.sqrt(1.0 + growth / first) - 1.0) if first > 0.0 else 0.0


def without(theta: Array, covariance: Array, i: int) -> tuple[Array, Array]:
    """Estimates and covariance of least squares with parameter i held at zero."""
    gain = covariance[:, i] / covariance[i, i]
    reduced = covariance - np.outer(gain, covariance[i])
    moved = theta - gain * theta[i]
    moved[i] = 0.0
    reduced[i, :] = reduced[:, i] = 0.0
    return moved, reduced
