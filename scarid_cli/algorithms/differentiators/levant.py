"""Arbitrary-order sliding mode differentiator (Levant 2003; Livne and Levant 2014).

Causal; Automatica 50 (2014) 2026. Homogeneous discrete form, or Euler's; output at the posterior
states. Exact after convergence if the bound holds. Delay: with noise, tens of milliseconds at the
default. Matched (--match): by the delays measured on quintic moves of 1 rad in 0.8 to 2 s at the
settings given. Rule: the bound is the largest derivative of order + 1 of the motion; a quintic move
of d in T has a jerk of 60 d / T^3 and a snap of 360 d / T^4.
bound = 400 [1/s^(order+1)]: of the snap for order 3.
order = 3: 1 to 5; with 1 a second one of the same bound differentiates the velocity.
euler = 0: 1 for Euler's steps, whose error is proportional to the period for every derivative.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_between, require_positive
from scarid_cli.algorithms.filters.sliding import gains
from scarid_cli.algorithms.processes.delays import Measured
from scarid_cli.algorithms.processes.process import Causal, Recursion
from scarid_cli.arrays import Array
from scarid_cli.kernels import levant


@dataclass(frozen=True)
class Differentiator(Causal):
    bound: float = 400.0
    order: int = 3
    euler: int = 0

    TUNED: ClassVar = {"bound": Range(1.0, 1e6)}

    def __post_init__(self) -> None:
        require_positive(self, "bound")
        require_between(self, 1, 5, "order")
        require_between(self, 0, 1, "euler")

    def init(self, x: float, h: float) -> Recursion:
        states = np.zeros((2, int(self.order) + 1))
        states[0, 0] = x
        return Recursion(states, h)

    def step(self, state: Recursion, x: Array) -> tuple[Recursion, tuple[Array, ...]]:
        state = state.copy()
        v, a, unused = np.empty_like(x), np.empty_like(x), np.empty_like(x)
        constant, taylor, h = gains(int(self.order), self.bound), not self.euler, state.h
        levant.differentiate(x, v, a, state.values[0], constant, 0, taylor, h)
        if self.order == 1:
            levant.differentiate(v, a, unused, state.values[1], constant, 0, taylor, h)
        return state, (v, a)

    def matched(self) -> Measured:
        return Measured(self)
