"""Proposed second-order sliding mode differentiator, with adaptive gains (paper eq. 7-9).

Explicit Euler; velocity is y0, acceleration y1. Nearly the linear observer with poles
s^2 + gamma0 s + gamma0 gamma1: the acceleration lags by 1 / gamma1 (50 ms), the velocity does
not. Rule: gamma1 = 1 / (wanted delay), gamma0 = 2 gamma1 or less. Matched (--match): velocity is
z1; position and torque pass through the same observer, linearised.
gamma0 = 25, gamma1 = 20: convergence gains [1/s] (Table 1).
eta0 = eta1 = eta2 = 0: initial adaptive gains.
leak = 0.1 [1/s], cap = 2, nu_max = 1 [s]: keep the adaptive gains (in 0..cap) and the integral of
the sign bounded. Eq. 9 alone lets them grow for ever, and diverges at standstill; preset table1
is that literal law.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.filters.sections import SectionState, advanced, at_rest
from scarid_cli.algorithms.recursion import Causal, Derivatives, Recursion
from scarid_cli.algorithms.settings import (
    require_not_negative,
    require_positive,
    require_positive_or_infinite,
)
from scarid_cli.arrays import Array
from scarid_cli.kernels import p2smd


@dataclass(frozen=True)
class Differentiator(Causal):
    gamma0: float = 25.0
    gamma1: float = 20.0
    eta0: float = 0.0
    eta1: float = 0.0
    eta2: float = 0.0
    leak: float = 0.1
    cap: float = 2.0
    nu_max: float = 1.0

    PRESETS: ClassVar = {"table1": {"leak": 0.0, "cap": inf, "nu_max": inf}}

    def __post_init__(self) -> None:
        require_positive(self, "gamma0", "gamma1")
        require_positive_or_infinite(self, "cap", "nu_max")
        require_not_negative(self, "eta0", "eta1", "eta2", "leak")

    def init(self, q: float, h: float) -> Recursion:
        return Recursion(np.array([q, 0.0, 0.0, self.eta0, self.eta1, self.eta2]), h)

    def step(self, state: Recursion, q: Array) -> tuple[Recursion, Derivatives]:
        state = state.copy()
        v, a = np.empty_like(q), np.empty_like(q)
        p2smd.differentiate(q, v, a, state.values, self._gains(), state.h)
        return state, (v, a)

    def matched(self) -> Matched:
        return Matched(self)

    def _gains(self) -> Array:
        # The literal law has no lower bound: eta2 of eq. 9 is free to change its sign.
        floor = 0.0 if self.cap < inf else -inf
        return np.array([self.gamma0, self.gamma1, self.leak, floor, self.cap, self.nu_max])


@dataclass(frozen=True)
class Matched(Causal):
    """Acceleration y1 as it is; velocity z1, brought to the instant of y1."""

    method: Differentiator

    @property
    def companion(self) -> Observer:
        return Observer(self.method.gamma0, self.method.gamma1)

    def init(self, q: float, h: float) -> Recursion:
        return self.method.init(q, h)

    def step(self, state: Recursion, q: Array) -> tuple[Recursion, Derivatives]:
        after, (_, a) = self.method.step(state, q)
        # z1 as the recursion runs through it, from sample to sample
        z1 = np.cumsum(np.concatenate((state.values[1:2], state.h * a)))
        return after, (z1[:-1] + 0.5 * state.h * a, a)


@dataclass(frozen=True)
class Observer:
    """gamma0 gamma1 / (s^2 + gamma0 s + gamma0 gamma1) in the explicit Euler steps of the method.

    Its output is the running sum of h z1, one sample on: where central differences of it are
    h-exactly the matched velocity and acceleration.
    """

    gamma0: float
    gamma1: float

    def init(self, x: float, h: float) -> SectionState:
        g0, g1 = self.gamma0 * h, self.gamma0 * self.gamma1 * h * h
        section = np.array([0.0, g1, 0.0, g0 - 2.0, 1.0 - g0 + g1])
        return at_rest(section[None, :], x)

    def step(self, state: SectionState, x: Array) -> tuple[SectionState, Array]:
        return advanced(state, x)
