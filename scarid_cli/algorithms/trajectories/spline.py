"""Quintic B-splines between evenly spaced knots (de Boor, A Practical Guide to Splines, 1978)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scarid_cli.arrays import Array

DEGREE = 5
AT_REST = 3  # functions at each end that are left out: position, velocity, acceleration


@dataclass(frozen=True)
class SplineBasis:
    """The B-splines that are at rest at both ends, each with a peak acceleration of 1.

    A coefficient of a curve is then the acceleration [rad/s2 or m/s2] that it adds.
    """

    duration: float
    intervals: int

    @property
    def size(self) -> int:
        return self.intervals + DEGREE - 2 * AT_REST

    @property
    def scale(self) -> float:
        return self.duration / self.intervals

    @property
    def summary(self) -> str:
        return f"spline of {self.intervals} intervals"

    def values(self, t: Array, order: int) -> Array:
        """A derivative of each function (size, samples) at the times t [s]."""
        values: Array = self._scales[:, None] * self._derivative(t, order)[AT_REST:-AT_REST]
        return values

    @cached_property
    def _knots(self) -> Array:
        inner = np.linspace(0.0, self.duration, self.intervals + 1)
        return np.concatenate((np.zeros(DEGREE), inner, np.full(DEGREE, self.duration)))

    @cached_property
    def _scales(self) -> Array:
        t = np.linspace(0.0, self.duration, 100 * self.intervals + 1)
        scales: Array = 1.0 / np.abs(self._derivative(t, 2)[AT_REST:-AT_REST]).max(axis=1)
        return scales

    def _derivative(self, t: Array, order: int) -> Array:
        """Of all B-splines (intervals + DEGREE, samples), by the recursion over the degree.

        At each time only DEGREE + 1 of them are not zero.
        """
        knots = self._knots
        last = DEGREE + self.intervals - 1
        inside = np.clip(np.searchsorted(knots, t, side="right") - 1, DEGREE, last)
        local = np.ones((1, len(t)))  # of the functions from inside - degree to inside
        for degree in range(1, DEGREE + 1):
            at = inside - degree + np.arange(degree + 1)[:, None]
            share = np.zeros((degree + 2, len(t)))
            share[1:-1] = local * (1.0 / (knots[at[1:] + degree] - knots[at[1:]]))
            if degree > DEGREE - order:
                local = degree * (share[:-1] - share[1:])
            else:
                rising = (t - knots[at]) * share[:-1]
                local = rising + (knots[at + degree + 1] - t) * share[1:]
        values = np.zeros((self.intervals + DEGREE, len(t)))
        np.put_along_axis(values, inside - DEGREE + np.arange(DEGREE + 1)[:, None], local, 0)
        return values
