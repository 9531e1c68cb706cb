"""Adaptive input and state estimation (AISE) of Verma, Sanjeevini, Sumer and Bernstein.

Causal. Int. J. Control 97 (2024) 2962. The motion is a double integrator with an unknown input, the
acceleration. A Kalman filter, whose two variances follow from the errors of its forecasts, gives
the velocity. The acceleration is a combination of past accelerations and past errors, whose
coefficients recursive least squares adapts so that the errors would have been least (retrospective
cost). See docs/theory.md, section "Adaptive input and state estimation".
It finds its bandwidth only in part: the weight of the squared acceleration in the cost limits it.
It is 3 to 4.5 times less accurate than kalman, and high orders diverge: 3 of 12 test records with
an order of 8, 11 of 12 with 25.
Delay: 10 to 20 ms at 100 and 200 Hz, once the coefficients have adapted (a few moves); 94 ms at
1 kHz.
Matched by measured delays: position, velocity and torque are delayed by as much as the method
delays quintic moves of 1 rad in 0.8 to 2 s behind an encoder of 18 bit.
Rule: choose the bandwidth by the noise, and double it at 1 kHz.
bandwidth = 90 [rad/s]: the weight of the squared acceleration is bandwidth^-4.
order = 1: number of past accelerations, and of past errors besides the present one.
window = 0.1 [s]: time over which past accelerations are corrected in retrospect.
prior = 1e-11: weight of the squared coefficients.
low = 1e-10, high = 1: bounds of the variance of the input's error.
share = 0.9: from 0 to 1: of the two extremes of the measurement noise, the weight of the least.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_between, require_positive
from scarid_cli.algorithms.processes.delays import MeasuredMethod
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.kernels import aise

LONGEST = 2000  # samples of the window; each takes a time of its own at every step


@dataclass(frozen=True)
class AdaptiveState:
    """The numbers of the recursion, as kernels/aise.py takes them, and the period h [s]."""

    numbers: tuple[Array, ...]
    h: float


@dataclass(frozen=True)
class Differentiator(MeasuredMethod):
    bandwidth: float = 90.0
    order: int = 1
    window: float = 0.1
    prior: float = 1e-11
    low: float = 1e-10
    high: float = 1.0
    share: float = 0.9

    TUNED: ClassVar = {"bandwidth": Range(10.0, 300.0)}

    def check(self) -> None:
        require_positive(self, "bandwidth", "window", "prior", "low", "high")
        require_between(self, 1, 50, "order")
        if not 0.0 <= self.share <= 1.0:
            raise UsageFault(f"share must be from 0 to 1, not {self.share:g}")
        if self.high < self.low:
            raise UsageFault(f"high must be at least low, not {self.high:g} below {self.low:g}")

    def init(self, x: float, h: float) -> AdaptiveState:
        size = 2 * self.order + 1
        state = np.zeros(8)
        state[0] = x
        window = round(self.window / h)
        if not 2 <= window <= LONGEST:
            raise UsageFault(f"window must be 2 to {LONGEST} samples, not {self.window / h:.3g}")
        past = np.zeros((2, self.order + window + 1))
        information = np.eye(size) / self.prior
        numbers = state, np.zeros(size), information, past, np.zeros((window + 1, 2))
        return AdaptiveState(numbers, h)

    def step(self, state: AdaptiveState, x: Array) -> tuple[AdaptiveState, tuple[Array, ...]]:
        numbers = tuple(array.copy() for array in state.numbers)
        v, a, work = np.empty_like(x), np.empty_like(x), np.empty((3, 2 * self.order + 1))
        weights = np.array([self.low, self.high, self.share, self.bandwidth**-4.0])
        aise.differentiate(x, v, a, *numbers, work, weights, state.h)
        return replace(state, numbers=numbers), (v, a)
