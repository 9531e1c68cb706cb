"""Adaptive super-twisting differentiator (ASTD), two blocks in series.

Causal. The first block follows the position, the second differentiates the velocity of the first.
Equations 30 and 31 of the paper, corrected after Shtessel, Taleb and Plestan (Automatica 48 (2012)
759), in explicit Euler steps.
Delay: tens of milliseconds, depending on the gain.
Matched by measured delays: position, velocity and torque are delayed by as much as the method
delays quintic moves of 1 rad in 0.8 to 2 s behind an encoder of 18 bit.
The match is of no use where the acceleration is not that of the motion, which is the rule.
Rule: choose gamma a few encoder steps above the error at rest. The velocity can follow
accelerations up to epsilon k0; the acceleration stays noisy.
epsilon = 1, alpha1 = 50, alpha0 = 0.1, mu1 = 2: gains and rates, as in Table 1 of the paper.
gamma = 0.015, k0m = 5: the position error [rad] below which the gain k0 shrinks, and the least
gain. Table 1 prints 1.5 and 0.01 (preset table1), and then nothing is estimated: no error exceeds
1.5 rad, so the gain never rises, and a gain as low as 0.01 loses the signal in every calm moment.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.filters.sliding import SlidingMode
from scarid_cli.arrays import Array
from scarid_cli.kernels import astd


@dataclass(frozen=True)
class Differentiator(SlidingMode):
    epsilon: float = 1.0
    alpha1: float = 50.0
    alpha0: float = 0.1
    mu1: float = 2.0
    gamma: float = 0.015
    k0m: float = 5.0

    PRESETS: ClassVar = {"table1": {"gamma": 1.5, "k0m": 0.01}}
    TUNED: ClassVar = {"gamma": Range(1e-4, 0.3), "k0m": Range(0.1, 100.0)}

    def check(self) -> None:
        require_positive(self, "epsilon", "alpha1", "alpha0", "mu1", "gamma", "k0m")

    def start(self, x: float) -> Array:
        return np.array([[x, 0.0, self.k0m], [0.0, 0.0, self.k0m]])

    def law(self, x: Array, v: Array, a: Array, values: Array, h: float) -> None:
        growth = self.alpha1 * sqrt(self.mu1 / 2.0)
        gains = np.array([self.epsilon, growth, self.alpha0, self.gamma, self.k0m])
        first, second = values
        astd.differentiate(x, v, first, gains, h)
        astd.differentiate(v, a, second, gains, h)
