"""Quintic smoothing spline through the whole record, with the noise estimated from the data.

Whole record. Reinsch, Numer. Math. 10 (1967) 177, as implemented in FITPACK: the spline
scipy.interpolate.UnivariateSpline with s = rows noise^2 has as few knots as leave a residual of the
size of the noise.
Delay: none.
Matched (to second order in the period): the torque passes the least-squares spline of the same
knots.
Rule: none is needed; but give the noise if an encoder step is coarser than the motion within a
sample.
noise = 0: standard deviation of the position; 0 to estimate it from differences of high order.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from scarid_cli.algorithms.choices.settings import require_not_negative
from scarid_cli.algorithms.filters.likelihood import noise_of
from scarid_cli.algorithms.processes.method import Matching
from scarid_cli.algorithms.processes.process import WholeRecord
from scarid_cli.algorithms.processes.records import RecordMethod
from scarid_cli.arrays import Array
from scarid_cli.errors import TooShort

DEGREE = 5


@dataclass(frozen=True)
class Differentiator(RecordMethod):
    noise: float = 0.0

    MATCHING = Matching.SECOND_ORDER
    TUNES_ITSELF = True
    FOLLOWS_NOISE = True

    def check(self) -> None:
        require_not_negative(self, "noise")

    def smoothed(self, x: Array, h: float) -> tuple[Array, ...]:
        t = times(x, h)
        spline = smoothing(self.noise, x, h)
        return tuple(np.asarray(spline(t, order)) for order in range(3))

    def fitted(self, x: Array, h: float) -> FittedSpline:
        return FittedSpline(self.noise, tuple(smoothing(self.noise, x, h).get_knots()))

    def torque_filter(self) -> SplineProjection:
        raise NotImplementedError("the knots for the torque are known once the spline is fitted")


@dataclass(frozen=True)
class FittedSpline(Differentiator):
    """The method with the knots [s] that the positions of a record need."""

    knots: tuple[float, ...] = ()

    def torque_filter(self) -> SplineProjection:
        return SplineProjection(self.knots)


@dataclass(frozen=True)
class SplineProjection(WholeRecord):
    """The least-squares spline of given knots [s]."""

    knots: tuple[float, ...]

    SETTLING_ROWS: ClassVar = (0, 0)

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        from scipy.interpolate import LSQUnivariateSpline

        t = times(x, h)
        if len(self.knots) >= len(x) - DEGREE:  # a knot for every row: the spline goes through them
            return (x,)
        return (np.asarray(LSQUnivariateSpline(t, x, self.knots[1:-1], k=DEGREE)(t)),)


def times(x: Array, h: float) -> Array:
    """The times [s] of the rows, from zero on; TooShort if they are too few for a spline."""
    if len(x) <= DEGREE:
        raise TooShort(f"spline needs a log of more than {DEGREE} rows, not {len(x)}")
    return np.arange(float(len(x))) * h


def smoothing(noise: float, x: Array, h: float) -> Any:
    """The spline of FITPACK whose residual is as large as the noise."""
    from scipy.interpolate import UnivariateSpline

    sigma = noise or noise_of(x)
    return UnivariateSpline(times(x, h), x, k=DEGREE, s=len(x) * sigma**2)
