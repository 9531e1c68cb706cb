"""Quintic smoothing spline (Reinsch; FITPACK through scipy), the noise estimated from the data.

Whole record. As few knots as leave a residual of the noise: scipy.interpolate.UnivariateSpline
with s = rows noise^2. No delay. Matched (--match): the torque passes the least-squares spline of
the same knots. Rule: none; give the noise if the encoder is coarser than the motion in a sample.
noise = 0: standard deviation of the position; 0: from its differences of high order.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from scarid_cli.algorithms.choices.settings import require_not_negative
from scarid_cli.algorithms.processes.process import Whole
from scarid_cli.algorithms.tuning.likelihood import noise_of
from scarid_cli.arrays import Array
from scarid_cli.errors import TooShort

DEGREE = 5


@dataclass(frozen=True)
class Spline(Whole):
    """Position, velocity and acceleration."""

    noise: float = 0.0

    def __post_init__(self) -> None:
        require_not_negative(self, "noise")

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        t = times(x, h)
        spline = smoothing(self.noise, x, h)
        return tuple(np.asarray(spline(t, order)) for order in range(3))


@dataclass(frozen=True)
class Differentiator(Spline):
    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        return Spline.over(self, x, h)[1:]

    def fitted(self, x: Array, h: float) -> Fitted:
        """With the knots that these positions need."""
        return Fitted(self.noise, tuple(smoothing(self.noise, x, h).get_knots()))


@dataclass(frozen=True)
class Fitted(Differentiator):
    """With known knots [s]."""

    knots: tuple[float, ...] = ()

    def matched(self) -> Matched:
        return Matched(self.noise, self.knots)


@dataclass(frozen=True)
class Matched(Spline):
    """All three as they are."""

    knots: tuple[float, ...] = ()

    @property
    def torque_filter(self) -> Projection:
        return Projection(self.knots)


@dataclass(frozen=True)
class Projection(Whole):
    """The least-squares spline of given knots [s]."""

    knots: tuple[float, ...]
    edges: ClassVar[tuple[int, int]] = (0, 0)

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        from scipy.interpolate import LSQUnivariateSpline

        t = times(x, h)
        if len(self.knots) >= len(x) - DEGREE:  # a knot for every row: the spline goes through them
            return (x,)
        return (np.asarray(LSQUnivariateSpline(t, x, self.knots[1:-1], k=DEGREE)(t)),)


def times(x: Array, h: float) -> Array:
    """From zero on [s]."""
    if len(x) <= DEGREE:
        raise TooShort(f"spline needs a log of more than {DEGREE} rows, not {len(x)}")
    return np.arange(float(len(x))) * h


def smoothing(noise: float, x: Array, h: float) -> Any:
    """FITPACK's spline whose residual is as large as the noise."""
    from scipy.interpolate import UnivariateSpline

    sigma = noise or noise_of(x)
    return UnivariateSpline(times(x, h), x, k=DEGREE, s=len(x) * sigma**2)
