"""Curves that are linear in their coefficients, from rest at home to rest at home.

The basis of a curve has functions that are zero at both ends, with their first two derivatives.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array

CHECKED = 400  # instants in the time scale of a basis
MILLISECOND = 1e-3


class Basis(Protocol):
    """The functions of time that a curve is a sum of."""

    @property
    def duration(self) -> float:
        """The time [s] from rest to rest."""
        ...

    @property
    def size(self) -> int:
        """The number of functions."""
        ...

    @property
    def scale(self) -> float:
        """The time [s] in which the functions change."""
        ...

    @property
    def summary(self) -> str:
        """What they are, in a few words for the user: `spline of 20 intervals`."""
        ...

    def values(self, t: Array, order: int) -> Array:
        """A derivative of each function (size, samples) at the times t [s]; order 0 to 4."""
        ...


@dataclass(frozen=True)
class Curve:
    """The motion home + coefficients * basis; coefficients are (joints, functions)."""

    basis: Basis
    home: Array
    coefficients: Array

    @property
    def duration(self) -> float:
        return self.basis.duration

    @property
    def summary(self) -> str:
        return self.basis.summary

    def sample(self, t: Array) -> tuple[Array, Array, Array]:
        """Positions, velocities and accelerations, each (joints, samples), at the times t [s]."""
        q, dq, ddq = (self._derivative(t, order) for order in range(3))
        return self.home[:, None] + q, dq, ddq

    def scaled(self, factors: Array) -> Curve:
        """The curve with each joint nearer to home by its factor (joints)."""
        return replace(self, coefficients=factors[:, None] * self.coefficients)

    def largest(self) -> tuple[Array, Array, Array, Array]:
        """How far each joint goes below home and above it, its largest |dq| and |ddq| (joints).

        They hold at every instant: between two checked instants a signal exceeds its values there
        by at most an eighth of its second derivative times the square of the step.
        """
        count = round(CHECKED * self.duration / self.basis.scale) + 1
        t, step = np.linspace(0.0, self.duration, count, retstep=True)
        signals = [self._derivative(t, order) for order in range(5)]
        margins = [step**2 / 8.0 * np.abs(second).max(axis=1) for second in signals[2:]]
        q, dq, ddq = signals[:3]
        return (
            margins[0] - q.min(axis=1),
            margins[0] + q.max(axis=1),
            margins[1] + np.abs(dq).max(axis=1),
            margins[2] + np.abs(ddq).max(axis=1),
        )

    def _derivative(self, t: Array, order: int) -> Array:
        # Summed term by term: a matrix product would round differently with the number of rows.
        values = self.basis.values(t, order)
        total = np.zeros((len(self.home), len(t)))
        for function, row in zip(values, self.coefficients.T, strict=True):
            total += row[:, None] * function
        return total


def instants(duration: float) -> Array:
    """Instants [s] from 0 to the duration, at most a millisecond apart."""
    return np.linspace(0.0, duration, int(np.ceil(duration / MILLISECOND)) + 1)


def random_curve(basis: Basis, home: Array, limits: Limits, rng: np.random.Generator) -> Curve:
    """A curve with normal coefficients, each joint as far as its limits allow."""
    curve = Curve(basis, home, rng.standard_normal((len(home), basis.size)))
    return curve.scaled(room(curve, limits))


def room(curve: Curve, limits: Limits) -> Array:
    """The largest factor for each joint that keeps its limits (joints)."""
    below, above, dq, ddq = curve.largest()
    with np.errstate(divide="ignore"):
        ratios = (
            (curve.home - limits.lower) / np.maximum(below, 0.0),
            (limits.upper - curve.home) / np.maximum(above, 0.0),
            limits.dq / dq,
            limits.ddq / ddq,
        )
    factors: Array = np.min(np.where(np.isnan(ratios), np.inf, ratios), axis=0)
    return np.where(np.isfinite(factors), factors, 0.0)
