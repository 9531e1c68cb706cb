"""Adaptive super-twisting differentiator, two blocks in a row (paper eq. 30-31, mended; Shtessel).

The second block differentiates the velocity of the first. Causal, explicit Euler. Delay: depends on
the gain, tens of milliseconds. Matched (--match): by the delays measured on quintic moves of 1 rad
in 0.8 to 2 s at the settings given. Rule: gamma a few encoder steps above the error at rest.
epsilon = 1, alpha1 = 50, alpha0 = 0.1, mu1 = 2: as in Table 1.
gamma = 0.015, k0m = 5: the position error [rad] below which the gain k0 shrinks, and the least
gain. Table 1 prints 1.5 and 0.01 (preset table1): no error exceeds 1.5 rad, so the gain never
rises and nothing is estimated; and a gain that may fall to 0.01 loses the signal at every calm
moment. The velocity can follow accelerations up to epsilon k0; the acceleration stays noisy.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.processes.delays import Measured
from scarid_cli.algorithms.processes.process import Causal, Recursion
from scarid_cli.arrays import Array
from scarid_cli.kernels import astd


@dataclass(frozen=True)
class Differentiator(Causal):
    epsilon: float = 1.0
    alpha1: float = 50.0
    alpha0: float = 0.1
    mu1: float = 2.0
    gamma: float = 0.015
    k0m: float = 5.0

    PRESETS: ClassVar = {"table1": {"gamma": 1.5, "k0m": 0.01}}
    TUNED: ClassVar = {"gamma": Range(1e-4, 0.3), "k0m": Range(0.1, 100.0)}

    def __post_init__(self) -> None:
        require_positive(self, "epsilon", "alpha1", "alpha0", "mu1", "gamma", "k0m")

    def init(self, x: float, h: float) -> Recursion:
        return Recursion(np.array([[x, 0.0, self.k0m], [0.0, 0.0, self.k0m]]), h)

    def step(self, state: Recursion, x: Array) -> tuple[Recursion, tuple[Array, ...]]:
        state = state.copy()
        v, a = np.empty_like(x), np.empty_like(x)
        growth = self.alpha1 * sqrt(self.mu1 / 2.0)
        gains = np.array([self.epsilon, growth, self.alpha0, self.gamma, self.k0m])
        astd.differentiate(x, v, state.values[0], gains, state.h)
        astd.differentiate(v, a, state.values[1], gains, state.h)
        return state, (v, a)

    def matched(self) -> Measured:
        return Measured(self)
