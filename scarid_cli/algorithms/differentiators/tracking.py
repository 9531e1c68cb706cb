"""Tracking differentiator of Han: a second-order system that follows in the shortest time.

Causal. Han, IEEE Trans. Ind. Electron. 56 (2009) 900, with the discrete-time law fhan, which does
not chatter. Two are run in series: the second follows the velocity of the first.
Delay: twice the smoothing time per stage, as long as the acceleration stays below the limit.
Matched by its linearisation below the limit, two critically damped stages: velocity, position and
torque pass both.
Rule: choose the limit well above speed / smoothing, then the smoothing by the noise or the delay.
smoothing = 0.02 [s]: h0 of fhan, the time constant below the limit.
limit = 1000 [1/s2]: the largest acceleration of the first stage (r of fhan).
jerk = 100000 [1/s3]: the same of the second stage.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.filters.sections import SectionFilter
from scarid_cli.algorithms.processes.linearised import LinearisedMethod
from scarid_cli.algorithms.processes.process import Recursion
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.kernels import tracking


@dataclass(frozen=True)
class Differentiator(LinearisedMethod):
    smoothing: float = 0.02
    limit: float = 1000.0
    jerk: float = 100000.0

    TUNED: ClassVar = {"smoothing": Range(0.005, 0.3, narrows=True)}

    def check(self) -> None:
        require_positive(self, "smoothing", "limit", "jerk")

    def init(self, x: float, h: float) -> Recursion:
        if self.smoothing < h:
            raise UsageFault(f"smoothing must be at least the period, {h:g} s")
        return Recursion(np.array([[x, 0.0], [0.0, 0.0]]), h)

    def step(self, state: Recursion, x: Array) -> tuple[Recursion, tuple[Array, ...]]:
        state, (_, v), (_, a) = self.stages(state, x)
        return state, (v, a)

    def stages(self, state: Recursion, x: Array) -> tuple[Recursion, Array, Array]:
        """The state after the positions x, and for each stage what it tracks and its derivative.

        Both are arrays (2, rows).
        """
        state = state.copy()
        first, second = np.empty((2, len(x))), np.empty((2, len(x)))
        gains = [np.array([r, self.smoothing]) for r in (self.limit, self.jerk)]
        tracking.follow(x, *first, state.values[0], gains[0], state.h)
        tracking.follow(first[1], *second, state.values[1], gains[1], state.h)
        return state, first, second

    def linearisation(self) -> CriticallyDamped:
        return CriticallyDamped(self.smoothing)

    def paired(self, state: Recursion, x: Array) -> tuple[Recursion, Array, Array]:
        after, _, (v, a) = self.stages(state, x)
        return after, v, a


@dataclass(frozen=True)
class CriticallyDamped(SectionFilter):
    """Both stages below their limits: 1 / (1 + smoothing s)^4 in the steps of the method."""

    smoothing: float

    def sections(self, h: float) -> Array:
        pole = h / self.smoothing
        poles = [2.0 * (pole - 1.0), (1.0 - pole) ** 2]
        return np.array([[pole**2, 0.0, 0.0, *poles], [0.0, pole**2, 0.0, *poles]])
