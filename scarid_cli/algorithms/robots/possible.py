"""The estimates nearest to identified ones that rigid bodies can have, with their intervals.

The estimates are those of `physical.nearest`. The interval of a parameter has all of its values for
which rigid bodies are hardly farther away than the nearest ones: the squared Mahalanobis distance
grows by at most the square of the quantile that makes an interval without the constraint, so that
both intervals are the same where the constraint does not bind (a profile likelihood interval). Its
ends are the least and the greatest value in a convex set.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.physical import Arm, chi_square, nearest, solved, whitened
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData


@dataclass(frozen=True)
class Possible:
    """Estimates that rigid bodies can have, and the ends of their intervals (parameters).

    `distance` is the Mahalanobis distance from the free estimates, and `explained` what their
    errors explain of it, in 95 of 100 logs. `moved` (joints) is the rms torque by which they differ
    from the free ones, over that of the motion.
    """

    estimates: Array
    low: Array
    high: Array
    distance: float
    explained: float
    moved: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def reached(self) -> bool:
        """Whether the errors explain that the free estimates are no rigid bodies."""
        return self.distance <= self.explained


def possible(
    robot: Robot,
    estimates: Array,
    covariance: Array,
    dropped: Sequence[int],
    quantile: float,
) -> Possible:
    """The nearest possible estimates; the arguments are those of `nearest`.

    `quantile` is half of the width of an interval in errors.
    """
    found = nearest(robot, estimates, covariance, dropped)
    known = np.isfinite(np.diag(covariance))
    low, high = _ends(robot, estimates, covariance, np.hypot(found.distance, quantile))
    kept = known & ~np.isin(np.arange(len(known)), np.array(dropped, dtype=int))
    low, high = (np.where(kept, end, np.nan) for end in (low, high))
    explained = float(np.sqrt(chi_square(int(known.sum()))))
    within = np.minimum(low, found.base), np.maximum(high, found.base)  # but for rounding
    return Possible(found.base, *within, found.distance, explained)


def _ends(
    robot: Robot, estimates: Array, covariance: Array, distance: float
) -> tuple[Array, Array]:
    """The least and the greatest value of each parameter with an error, up to this distance."""
    arm = Arm.of(robot)
    cvxpy = arm.cvxpy
    away, tie = whitened(arm.base, estimates, covariance)
    direction = cvxpy.Parameter(len(estimates))
    near = cvxpy.norm(away) <= distance
    apart = direction @ (arm.base - estimates)
    problem = cvxpy.Problem(cvxpy.Maximize(apart), [*arm.constraints, *tie, near])
    ends = np.full((2, len(estimates)), np.nan)
    errors = np.sqrt(np.diag(covariance))
    for i in np.flatnonzero(np.isfinite(errors)):
        for end, sign in zip(ends, (-1.0, 1.0), strict=True):
            unit = np.zeros(len(estimates))
            unit[i] = sign / errors[i] if errors[i] > 0.0 else sign
            direction.value = unit
            try:
                solved(problem)
                end[i] = float(arm.base.value[i])
            except BadData:  # the solver gave up: the interval of the errors alone
                end[i] = estimates[i] + sign * distance * errors[i]
    return ends[0], ends[1]
