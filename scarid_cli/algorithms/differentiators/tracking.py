"""Tracking differentiator: a second-order system that follows in the shortest time (Han).

Causal; two in a row, the second follows the velocity of the first. Han, IEEE Trans. Ind. Electron.
56 (2009) 900, in discrete time (fhan), which does not chatter. Delay: 2 smoothing a stage while the
acceleration stays below the limit. Matched (--match): by its linearisation below the limit, two
critically damped stages; velocity, position and torque pass both. Rule: limit well above speed /
smoothing; then the smoothing by noise or delay.
smoothing = 0.02 [s]: h0 of fhan, the time constant below the limit.
limit = 1000 [1/s2]: largest acceleration of the first stage (r of fhan).
jerk = 100000 [1/s3]: the same of the second stage.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.filters.sections import SectionState, advanced, at_rest
from scarid_cli.algorithms.processes.process import Causal, Recursion
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.kernels import tracking


@dataclass(frozen=True)
class Differentiator(Causal):
    smoothing: float = 0.02
    limit: float = 1000.0
    jerk: float = 100000.0

    TUNED: ClassVar = {"smoothing": Range(0.005, 0.3)}

    def __post_init__(self) -> None:
        require_positive(self, "smoothing", "limit", "jerk")

    def init(self, x: float, h: float) -> Recursion:
        if self.smoothing < h:
            raise UsageFault(f"smoothing must be at least the period, {h:g} s")
        return Recursion(np.array([[x, 0.0], [0.0, 0.0]]), h)

    def step(self, state: Recursion, x: Array) -> tuple[Recursion, tuple[Array, ...]]:
        state, first, second = self.stages(state, x)
        return state, (first[1], second[1])

    def stages(self, state: Recursion, x: Array) -> tuple[Recursion, list[Array], list[Array]]:
        """What each stage follows with, and its derivative."""
        state = state.copy()
        first, second = np.empty((2, len(x))), np.empty((2, len(x)))
        gains = [np.array([r, self.smoothing]) for r in (self.limit, self.jerk)]
        tracking.follow(x, first[0], first[1], state.values[0], gains[0], state.h)
        tracking.follow(first[1], second[0], second[1], state.values[1], gains[1], state.h)
        return state, list(first), list(second)

    def matched(self) -> Matched:
        return Matched(self)


@dataclass(frozen=True)
class MatchedState:
    """The stages, and the position on its way through their linearisation."""

    own: Recursion
    position: SectionState


@dataclass(frozen=True)
class Matched(Causal):
    """The velocity as the second stage follows it, brought to the instant of its derivative."""

    method: Differentiator

    @property
    def torque_filter(self) -> Linear:
        return Linear(self.method.smoothing)

    def init(self, x: float, h: float) -> MatchedState:
        return MatchedState(self.method.init(x, h), self.torque_filter.init(x, h))

    def step(self, state: MatchedState, x: Array) -> tuple[MatchedState, tuple[Array, ...]]:
        own, _, (v, a) = self.method.stages(state.own, x)
        position, (q,) = self.torque_filter.step(state.position, x)
        return MatchedState(own, position), (q, v + 0.5 * own.h * a, a)


@dataclass(frozen=True)
class Linear(Causal):
    """Both stages below their limits: 1 / (1 + smoothing s)^4 in the steps of the method."""

    smoothing: float

    def init(self, x: float, h: float) -> SectionState:
        pole = h / self.smoothing
        poles = [2.0 * (pole - 1.0), (1.0 - pole) ** 2]
        return at_rest(np.array([[pole**2, 0.0, 0.0, *poles], [0.0, pole**2, 0.0, *poles]]), x)

    def step(self, state: SectionState, x: Array) -> tuple[SectionState, tuple[Array, ...]]:
        state, y = advanced(state, x)
        return state, (y,)
