"""Criteria of optimal experiments (Pukelsheim 2006), with their gradients.

Each is a number that is smaller for a better experiment, in units of the logarithm of a standard
error or of a condition number. Its gradient is with respect to a symmetric matrix (parameters,
parameters): the moments W'W, or the information that weighs rows by the noise of their joints.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from scarid_cli.arrays import Array, Numbers
from scarid_cli.errors import UsageFault

# The mean over so high a power of the eigenvalues stands for the largest, and is smooth.
POWER = 16
# Directions whose torques are so small beside the largest, wherever the robot is within its limits,
# have no say in the condition number: no motion can tell what they are.
NEGLIGIBLE = 1e-3
ROUNDING = 1e-14  # of the largest eigenvalue
TINY = 1e-24  # of the largest square of a length: a column that is zero

Valued = tuple[float, Array]


@dataclass(frozen=True)
class Goal:
    """A weighted sum of criteria: (weight, whether it is one of the information, criterion)."""

    parts: tuple[tuple[float, bool, Callable[[Array], Valued]], ...]

    def of(self, moments: Array, information: Array) -> tuple[float, Array, Array]:
        """The value, and its gradients by both matrices."""
        value, by_moments, by_information = 0.0, np.zeros_like(moments), np.zeros_like(moments)
        for weight, weighted, criterion in self.parts:
            own, slope = criterion(information if weighted else moments)
            value += weight * own
            if weighted:
                by_information += weight * slope
            else:
                by_moments += weight * slope
        return value, by_moments, by_information


NAMES = ("balanced", "d", "a", "c", "scaled-c")


def goal(name: str, typical: Array, wanted: Sequence[int] = ()) -> Goal:
    """The criterion of this name.

    `typical` (parameters, parameters) are mean moments of states within the limits. With `wanted`
    parameters (indices), the others are nuisance parameters, and the criterion is that of the
    covariance of the former.
    """
    scales = np.sqrt(np.diag(typical))
    if wanted:
        chosen = {"d": _d_of, "a": _a_of}
        if name not in chosen:
            raise UsageFault(f"--criterion {name} has no form for some parameters; give d or a")
        some = np.array(wanted)
        return Goal(((1.0, True, lambda M: chosen[name](M, some, scales)),))
    every = np.arange(len(scales))
    raw, scaled = excitable(typical), excitable(_scaled(typical))

    def c(M: Array) -> Valued:
        return condition(M, raw)

    return {
        "balanced": Goal(((0.5, True, determinant), (0.5, False, c))),
        "d": Goal(((1.0, True, determinant),)),
        "a": Goal(((1.0, True, lambda M: _a_of(M, every, scales)),)),
        "c": Goal(((1.0, False, c),)),
        "scaled-c": Goal(((1.0, False, lambda M: scaled_condition(M, scaled)),)),
    }[name]


def determinant(M: Array) -> Valued:
    """D: the mean logarithm of the standard errors along the axes of the error ellipsoid."""
    _, logarithm = np.linalg.slogdet(M)
    return -0.5 * logarithm / len(M), -0.5 * np.linalg.inv(M) / len(M)


def excitable(typical: Array) -> Array:
    """The directions (parameters, directions) that motions within the limits can excite."""
    values, vectors = np.linalg.eigh(typical)
    found: Array = vectors[:, values > NEGLIGIBLE**2 * values[-1]]
    return found


def _scaled(M: Array) -> Array:
    lengths = np.sqrt(np.maximum(np.diag(M), TINY * np.diag(M).max()))
    scaled: Array = M / np.outer(lengths, lengths)
    return scaled


def condition(M: Array, within: Array) -> Valued:
    """C: the logarithm of the condition number of W, where M = W'W; smooth (POWER).

    It is that of the directions `within` (parameters, directions).
    """
    values, vectors = np.linalg.eigh(within.T @ M @ within)
    vectors = within @ vectors
    values = np.maximum(values, ROUNDING * values[-1])  # far beyond the limits it may be negative
    largest, smallest = values[-1], values[0]
    high, low = (values / largest) ** POWER, (smallest / values) ** POWER
    value = 0.5 * np.log(largest / smallest) + 0.5 * np.log(high.sum() * low.sum()) / POWER
    slopes = 0.5 * (high / high.sum() - low / low.sum()) / values
    return float(value), (vectors * slopes) @ vectors.T


def scaled_condition(M: Array, within: Array) -> Valued:
    """C of the columns of W divided by their lengths."""
    lengths = np.sqrt(np.diag(M))
    both = np.outer(lengths, lengths)
    value, slopes = condition(M / both, within)
    found = slopes / both
    found[np.diag_indices_from(found)] -= (found * M).sum(axis=1) / lengths**2
    return value, found


def _d_of(M: Array, some: Numbers, _: Array) -> Valued:
    """D of some parameters: the determinant of their covariance (Ds)."""
    covariance = np.linalg.inv(M)
    own = covariance[np.ix_(some, some)]
    _, logarithm = np.linalg.slogdet(own)
    across = covariance[:, some]
    slope = -0.5 * across @ np.linalg.solve(own, across.T) / len(some)
    return 0.5 * logarithm / len(some), slope


def _a_of(M: Array, some: Numbers, scales: Array) -> Valued:
    """A: the logarithm of the root-mean-square error of the torques that parameters stand for."""
    covariance = np.linalg.inv(M)
    squares = np.zeros(len(M))
    squares[some] = scales[some] ** 2
    total = float(squares @ np.diag(covariance))
    slope = -0.5 * (covariance * squares) @ covariance / total
    return 0.5 * np.log(total / len(some)), slope
