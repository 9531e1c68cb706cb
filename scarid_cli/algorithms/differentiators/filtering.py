"""Filtering sliding-mode differentiator of Levant and Livne, for noise whose average is small.

Causal. Levant and Livne, Eur. J. Control (2020), doi 10.1016/j.ejcon.2019.08.006: Euler steps for
the filter and Taylor steps for the differentiator. The output is taken from the states after each
update. It withstands vibration and glitches better than all other methods here.
Delay: tens of milliseconds.
Matched by measured delays: position, velocity and torque are delayed by as much as the method
delays moves of 1 rad in 0.8 s or more, within its bounds, behind an encoder of 18 bit.
Within the bound the match is right to 2 degrees; motions beyond it are not followed: 112 degrees at
1 Hz and 0.5 rad with the default.
Rule: the bound is the largest derivative of order + 1 of the motion.
bound = 64 [1/s^(order+1)]: the largest jerk for order 2.
order = 2: the order of differentiation, 2 to 5.
filters = 2: the order of the filter, at least 1; both orders together are at most 7.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_between, require_positive
from scarid_cli.algorithms.filters.sliding import SlidingMode, gains
from scarid_cli.algorithms.processes.delays import Bounds
from scarid_cli.arrays import Array
from scarid_cli.kernels import levant


@dataclass(frozen=True)
class Differentiator(SlidingMode):
    bound: float = 64.0
    order: int = 2
    filters: int = 2

    TUNED: ClassVar = {"bound": Range(1.0, 1e6)}

    def check(self) -> None:
        require_positive(self, "bound")
        require_between(self, 2, 5, "order")
        require_between(self, 1, 7 - self.order, "filters")

    def bounds(self) -> Bounds:
        return ((self.order + 1, self.bound),)

    def start(self, x: float) -> Array:
        values = np.zeros(self.order + self.filters + 1)
        values[self.filters] = x
        return values

    def law(self, x: Array, v: Array, a: Array, values: Array, h: float) -> None:
        constant = gains(self.order + self.filters, self.bound)
        levant.differentiate(x, v, a, values, constant, self.filters, 1, h)
