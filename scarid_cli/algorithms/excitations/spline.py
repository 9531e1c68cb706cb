"""Quintic splines: random ones, or with --optimise the best ones that are found.

All joints move together, without coming to rest on the way. The limits hold at every instant.

interval = 0 [s]: time from one knot to the next. 0 takes the time in which the joints can cross
their position limits, sqrt(half the interval of q / limit of ddq), but at most 200 intervals.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.choices.settings import Validated, require_not_negative
from scarid_cli.algorithms.trajectories.curve import Curve, random_curve
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.spline import SplineBasis
from scarid_cli.arrays import Array

FEWEST, MOST = 2, 200  # intervals


@dataclass(frozen=True)
class Excitation(Validated):
    interval: float = 0.0

    def check(self) -> None:
        require_not_negative(self, "interval")

    def basis(self, limits: Limits, duration: float) -> SplineBasis:
        """The functions of a motion of this duration [s]."""
        interval = self.interval or max(crossing_time(limits), duration / MOST)
        return SplineBasis(duration, max(FEWEST, round(duration / interval)))

    def trajectory(
        self, limits: Limits, home: Array, duration: float, rng: np.random.Generator
    ) -> Curve:
        """A random motion of this duration [s] from home (joints) back to home."""
        return random_curve(self.basis(limits, duration), home, limits, rng)


def crossing_time(limits: Limits) -> float:
    """The time [s] in which joints can cross their position limits, the median over the joints."""
    times = np.sqrt(0.5 * (limits.upper - limits.lower) / limits.ddq)
    return float(np.median(times))
