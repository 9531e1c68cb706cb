"""Levant's sliding-mode differentiator of arbitrary order.

Causal. Levant, Int. J. Control 76 (2003) 924, in the homogeneous discrete form of Livne and Levant
(Automatica 50 (2014) 2026), or in Euler steps. The output is taken from the states after each
update, brought back to the present sample. Without noise the error converges to that of the
sampling if the bound holds.
Delay: with noise, tens of milliseconds at the default.
Matched by measured delays: position, velocity and torque are delayed by as much as the method
delays moves of 1 rad in 0.8 s or more, within its bounds, behind an encoder of 18 bit.
Within the bound the match is right to 3 degrees; motions beyond it are not followed: 70 degrees at
1 Hz and 0.5 rad with the default.
Rule: the bound is the largest derivative of order + 1 of the motion. A quintic move of d in the
time T has a jerk of 60 d / T^3 and a snap of 360 d / T^4.
bound = 400 [1/s^(order+1)]: the largest snap for order 3.
order = 3: the order of differentiation, 1 to 5; for 1 a second differentiator of the same bound
differentiates the velocity.
euler = 0: 1 for Euler steps, in which the error of every derivative is proportional to the period.
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
    bound: float = 400.0
    order: int = 3
    euler: int = 0

    TUNED: ClassVar = {"bound": Range(1.0, 1e6)}

    def check(self) -> None:
        require_positive(self, "bound")
        require_between(self, 1, 5, "order")
        require_between(self, 0, 1, "euler")

    def bounds(self) -> Bounds:
        if self.order == 1:  # the second differentiates the velocity
            return (2, self.bound), (3, self.bound)
        return ((self.order + 1, self.bound),)

    def start(self, x: float) -> Array:
        values = np.zeros((2, self.order + 1))
        values[0, 0] = x
        return values

    def law(self, x: Array, v: Array, a: Array, values: Array, h: float) -> None:
        first, second = values
        constant, taylor = gains(self.order, self.bound), not self.euler
        levant.differentiate(x, v, a, first, constant, 0, taylor, h)
        if self.order == 1:
            levant.differentiate(v, a, np.empty_like(x), second, constant, 0, taylor, h)
