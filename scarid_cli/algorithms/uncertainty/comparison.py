"""Whether two or more estimates of the same parameters differ by more than their errors allow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import exp

import numpy as np

from scarid_cli.algorithms.uncertainty.jackknife import quantile
from scarid_cli.algorithms.uncertainty.tails import log_tail_f, log_tail_t
from scarid_cli.arrays import Array

LEVEL = 0.05  # of false alarms in a comparison, over all of its tests
MOST_FREEDOM = 1000.0
FLAT = 1e-9  # of the largest eigenvalue of a correlation matrix


@dataclass(frozen=True)
class Estimate:
    """Estimates of some parameters: values, standard errors, and the covariance where known.

    `freedom` (parameters) are the degrees of freedom of the errors. A parameter without an error is
    nan there. An error is at least that of the covariance: the error of a single parameter may rest
    on few blocks of the log and be too small by chance.
    """

    values: Array
    errors: Array
    freedom: Array
    covariance: Array | None

    def __post_init__(self) -> None:
        if self.covariance is not None:
            least = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
            object.__setattr__(self, "errors", np.fmax(self.errors, least))


@dataclass(frozen=True)
class Joint:
    """The test of all differences together: F with `k` and `n` degrees of freedom (Hotelling)."""

    f: float
    k: int
    n: float
    p_value: float


@dataclass(frozen=True)
class Comparison:
    """The differences of two estimates, second minus first, with their standard errors.

    `p_values` (parameters) are two-sided, from Student's t, and corrected by Holm's method for the
    number of tests, which include the joint one; nan where an error is not known.
    """

    difference: Array
    errors: Array
    p_values: Array
    joint: Joint | None

    @property
    def differing(self) -> list[int]:
        """The parameters that differ, the clearest first."""
        found = np.flatnonzero(self.p_values < LEVEL)
        return sorted(found.tolist(), key=lambda i: float(-abs(self.counts[i])))

    @property
    def counts(self) -> Array:
        """The differences in standard errors (parameters)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(self.difference / self.errors, dtype=np.float64)

    @property
    def differ(self) -> bool:
        return bool(self.differing) or bool(self.joint and self.joint.p_value < LEVEL)


def comparison(first: Estimate, second: Estimate) -> Comparison:
    """Compare two estimates of the same parameters."""
    difference = second.values - first.values
    errors = np.hypot(first.errors, second.errors)
    freedom = np.minimum(first.freedom, second.freedom)
    joint = _joint(first, second, difference, freedom)
    tails = p_values(difference, errors, freedom)
    together = np.append(tails, joint.p_value if joint else np.nan)
    corrected = holm(together)
    if joint:
        joint = Joint(joint.f, joint.k, joint.n, float(corrected[-1]))
    return Comparison(difference, errors, corrected[:-1], joint)


def trend(estimates: Sequence[Estimate]) -> Comparison:
    """The change from one estimate to the next, by weighted least squares (at least three).

    It is not known, nan, for a parameter of which an error is zero or not known.
    """
    weights = np.array([1.0 / np.where(e.errors > 0.0, e.errors, np.nan) ** 2 for e in estimates])
    values = np.array([e.values for e in estimates])
    at = np.arange(len(estimates), dtype=np.float64)[:, None]
    about = at - (weights * at).sum(axis=0) / weights.sum(axis=0)
    information = (weights * about**2).sum(axis=0)
    slope = (weights * about * values).sum(axis=0) / information
    errors = 1.0 / np.sqrt(information)
    freedom = np.min([e.freedom for e in estimates], axis=0)
    return Comparison(slope, errors, holm(p_values(slope, errors, freedom)), None)


def p_values(differences: Array, errors: Array, freedom: Array) -> Array:
    """Two-sided p-values of Student's t; nan where the error is not known or zero."""
    found = np.full(len(differences), np.nan)
    for i in np.flatnonzero(errors > 0.0):
        found[i] = exp(log_tail_t(float(differences[i] / errors[i]), float(freedom[i])))
    return found


def holm(tails: Array) -> Array:
    """P-values corrected for their number (Holm 1979): the chance of any false alarm is kept."""
    known = np.flatnonzero(np.isfinite(tails))
    order = known[np.argsort(tails[known])]
    corrected = np.full(len(tails), np.nan)
    least = 0.0
    for rank, i in enumerate(order):
        least = max(least, min(1.0, float(tails[i]) * (len(order) - rank)))
        corrected[i] = least
    return corrected


def freedom_of(errors: Array, half: Array) -> Array:
    """Degrees of freedom, from standard errors and half the widths of their 95 % intervals.

    Those of the widest interval: all errors of a log come from its blocks, and intervals that are
    narrower allow for few blocks otherwise (`interval_quantiles` in jackknife.py).
    """
    known = _quantiles()
    with np.errstate(divide="ignore", invalid="ignore"):
        quantiles = np.nan_to_num(half / errors, nan=0.0, posinf=0.0)
    # the quantile falls with the degrees of freedom; half a percent is closer than the formula is
    places = np.searchsorted(-known, -quantiles)
    found = np.clip(places + 1, 1, MOST_FREEDOM)
    return np.full(len(errors), float(np.min(found, initial=MOST_FREEDOM)))


@cache  # a trend may have hundreds of tables
def _quantiles() -> Array:
    """The quantiles of 97.5 % for 1, 2, ... degrees of freedom."""
    return np.array([quantile(0.975, n) for n in range(1, int(MOST_FREEDOM) + 1)])


def _joint(first: Estimate, second: Estimate, difference: Array, freedom: Array) -> Joint | None:
    """The Mahalanobis distance of all differences, if both covariances are known."""
    if first.covariance is None or second.covariance is None:
        return None
    total = first.covariance + second.covariance
    known = np.flatnonzero(np.diag(total) > 0.0)
    if not len(known):
        return None
    errors = np.sqrt(np.diag(total)[known])
    scaled = difference[known] / errors
    values, vectors = np.linalg.eigh(total[np.ix_(known, known)] / np.outer(errors, errors))
    kept = values > FLAT * values[-1]
    k, n = int(kept.sum()), float(np.min(freedom[known]))
    f = float(np.sum((vectors[:, kept].T @ scaled) ** 2 / values[kept])) / k
    return Joint(f, k, n, exp(log_tail_f(f, k, n)))
