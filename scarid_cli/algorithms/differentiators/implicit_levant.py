"""Arbitrary-order sliding mode differentiator in implicit Euler steps: no chattering, any gain.

Causal; Mojallizadeh, Brogliato, Acary, Int. J. Robust Nonlinear Control 31 (2021), with an output
map that takes the states for what they are, backward differences (cf. Seeber 2024). Exact after
convergence if the bound holds. Delay: with noise, tens of milliseconds at the default. Matched
(--match): by the delays measured on quintic moves of 1 rad in 0.8 to 2 s at the settings given.
Rule: the bound is the largest derivative of order + 1 of the motion (see levant).
bound = 400 [1/s^(order+1)]: of the snap for order 3.
order = 3: 2 to 5.
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
from scarid_cli.kernels import implicit_levant


@dataclass(frozen=True)
class Differentiator(Causal):
    bound: float = 400.0
    order: int = 3

    TUNED: ClassVar = {"bound": Range(1.0, 1e6)}

    def __post_init__(self) -> None:
        require_positive(self, "bound")
        require_between(self, 2, 5, "order")

    def init(self, x: float, h: float) -> Recursion:
        states = np.zeros(int(self.order) + 1)
        states[0] = x
        return Recursion(states, h)

    def step(self, state: Recursion, x: Array) -> tuple[Recursion, tuple[Array, ...]]:
        state = state.copy()
        v, a = np.empty_like(x), np.empty_like(x)
        constant = gains(int(self.order), self.bound)
        implicit_levant.differentiate(x, v, a, state.values, constant, state.h)
        return state, (v, a)

    def matched(self) -> Measured:
        return Measured(self)
