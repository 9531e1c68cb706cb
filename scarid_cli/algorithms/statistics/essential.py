"""Essential parameters: those that the data know well enough to keep (Gautier and Khalil).

The worst known is removed while its relative deviation is at least 30 times that of the best.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.information import Fit
from scarid_cli.arrays import Array

RATIO = 30.0


@dataclass(frozen=True)
class Essential:
    """The fit without what was dropped (estimates 0, no errors), and what that cost.

    `dropped` are numbers of parameters in the order they went; `cost` is how much greater the
    deviation of the residual became, in parts of it.
    """

    fit: Fit
    dropped: tuple[int, ...]
    cost: float


def essential(fit: Fit, rows: float) -> Essential:
    """By the ratio rule, from a fit to so many rows; the rest is fitted again each time."""
    theta, covariance = fit.estimates.copy(), fit.unit_covariance.copy()
    kept = list(range(len(theta)))
    dropped: list[int] = []
    squares = fit.variance * (rows - len(theta))
    first = squares
    while len(kept) > 1:
        with np.errstate(divide="ignore"):
            relative = np.sqrt(np.diag(covariance)[kept]) / np.abs(theta[kept])
        if not relative.max() >= RATIO * relative.min():
            break
        worst = kept[int(np.argmax(relative))]
        squares += theta[worst] ** 2 / covariance[worst, worst]
        theta, covariance = without(theta, covariance, worst)
        kept.remove(worst)
        dropped.append(worst)
    freedom = rows - len(kept)
    variance = squares / freedom if freedom > 0 else float("nan")
    for i in dropped:
        covariance[i, i] = np.nan
    cost = float(np.sqrt(squares / first) - 1.0) if first > 0.0 else 0.0
    found = replace(fit, estimates=theta, unit_covariance=covariance, variance=variance)
    return Essential(found, tuple(dropped), cost)


def without(theta: Array, covariance: Array, i: int) -> tuple[Array, Array]:
    """Estimates and covariance of least squares with one parameter held at 0."""
    gain = covariance[:, i] / covariance[i, i]
    reduced = covariance - np.outer(gain, covariance[i])
    moved = theta - gain * theta[i]
    moved[i] = 0.0
    reduced[i, :] = reduced[:, i] = 0.0
    return moved, reduced
