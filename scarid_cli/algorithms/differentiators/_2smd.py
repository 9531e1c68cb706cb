"""Second-order sliding mode differentiator (paper eq. 6 with its exponent mended; Levant 2003).

Causal, explicit Euler, output at the posterior states. Exact after convergence if eta2 exceeds the
jerk; then the delay is that of the sampling, else tens of milliseconds. Matched (--match): by the
delays measured on quintic moves of 1 rad in 0.8 to 2 s at the settings given.
Rule: eta0 = 2 L^(1/3), eta1 = 1.5 L^(1/2), eta2 = 1.1 L, with L the largest jerk [1/s3].
eta0 = 10: as in Table 1.
eta1 = 12, eta2 = 70: the rule for L = 64 rad/s3, what moves of 1 rad in a second need. Table 1
prints 8 and 5 (preset table1), which cannot follow a jerk above 4.5 rad/s3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.processes.delays import Measured
from scarid_cli.algorithms.processes.process import Causal, Recursion
from scarid_cli.arrays import Array
from scarid_cli.kernels import smd2


@dataclass(frozen=True)
class Differentiator(Causal):
    eta0: float = 10.0
    eta1: float = 12.0
    eta2: float = 70.0

    PRESETS: ClassVar = {"table1": {"eta1": 8.0, "eta2": 5.0}}
    TUNED: ClassVar = {
        "eta0": Range(1.0, 100.0),
        "eta1": Range(1.0, 300.0),
        "eta2": Range(1.0, 10000.0),
    }

    def __post_init__(self) -> None:
        require_positive(self, "eta0", "eta1", "eta2")

    def init(self, x: float, h: float) -> Recursion:
        return Recursion(np.array([x, 0.0, 0.0]), h)

    def step(self, state: Recursion, x: Array) -> tuple[Recursion, tuple[Array, ...]]:
        state = state.copy()
        v, a = np.empty_like(x), np.empty_like(x)
        gains = np.array([self.eta0, self.eta1, self.eta2])
        smd2.differentiate(x, v, a, state.values, gains, state.h)
        return state, (v, a)

    def matched(self) -> Measured:
        return Measured(self)
