"""Filtering sliding mode differentiator: filters out noise of small average (Levant, Livne 2020).

Causal; Eur. J. Control, doi 10.1016/j.ejcon.2019.08.006. Euler's steps for the filter, Taylor's for
the differentiator; output at the posterior states. Bears vibration and glitches best of all.
Delay: tens of milliseconds. Matched (--match): by the delays measured on quintic moves of 1 rad in
0.8 to 2 s at the settings given. Rule: the bound is the largest derivative of order + 1.
bound = 64 [1/s^(order+1)]: of the jerk for order 2.
order = 2: of differentiation, 2 to 5.
filters = 2: order of the filter, at least 1; both orders are 7 at most.
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
    bound: float = 64.0
    order: int = 2
    filters: int = 2

    TUNED: ClassVar = {"bound": Range(1.0, 1e6)}

    def __post_init__(self) -> None:
        require_positive(self, "bound")
        require_between(self, 2, 5, "order")
        require_between(self, 1, 7 - self.order, "filters")

    def init(self, x: float, h: float) -> Recursion:
        states = np.zeros(int(self.order + self.filters) + 1)
        states[int(self.filters)] = x
        return Recursion(states, h)

    def step(self, state: Recursion, x: Array) -> tuple[Recursion, tuple[Array, ...]]:
        state = state.copy()
        v, a = np.empty_like(x), np.empty_like(x)
        constant = gains(int(self.order + self.filters), self.bound)
        levant.differentiate(x, v, a, state.values, constant, int(self.filters), 1, state.h)
        return state, (v, a)

    def matched(self) -> Measured:
        return Measured(self)
