"""Super-twisting differentiator, two in a row (Levant 1998; eq. 30 of the paper with fixed gains).

Causal; Automatica 34 (1998) 379. The second differentiates the velocity of the first. Explicit
Euler. Exact after convergence if the bounds hold; the acceleration chatters. Delay: with noise,
tens of milliseconds. Matched (--match): by the delays measured on quintic moves of 1 rad in 0.8 to
2 s at the settings given. Rule: the bounds are those of the motion; a quintic move of d in T has an
acceleration of 5.8 d / T^2 and a jerk of 60 d / T^3.
acceleration = 20 [1/s2], jerk = 150 [1/s3]: the largest of the motion; gains 1.5 and 1.1 of Levant.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.filters.sliding import gains
from scarid_cli.algorithms.processes.delays import Measured
from scarid_cli.algorithms.processes.process import Causal, Recursion
from scarid_cli.arrays import Array
from scarid_cli.kernels import levant


@dataclass(frozen=True)
class Differentiator(Causal):
    acceleration: float = 20.0
    jerk: float = 150.0

    TUNED: ClassVar = {"acceleration": Range(1.0, 300.0), "jerk": Range(10.0, 1e4)}

    def __post_init__(self) -> None:
        require_positive(self, "acceleration", "jerk")

    def init(self, x: float, h: float) -> Recursion:
        return Recursion(np.array([[x, 0.0], [0.0, 0.0]]), h)

    def step(self, state: Recursion, x: Array) -> tuple[Recursion, tuple[Array, ...]]:
        state = state.copy()
        v, a, unused = np.empty_like(x), np.empty_like(x), np.empty_like(x)
        first, second = gains(1, self.acceleration), gains(1, self.jerk)
        levant.differentiate(x, v, unused, state.values[0], first, 0, 0, state.h)
        levant.differentiate(v, a, unused, state.values[1], second, 0, 0, state.h)
        return state, (v, a)

    def matched(self) -> Measured:
        return Measured(self)
