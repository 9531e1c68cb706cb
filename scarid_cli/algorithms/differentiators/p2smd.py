"""Second-order sliding-mode differentiator with adaptive gains, proposed by the paper (P2SMD).

Causal. Equations 7 to 9 of the paper; the velocity is y0 and the acceleration y1. Without its
adaptive terms it is the linear observer with the poles of s^2 + gamma0 s + gamma0 gamma1.
Delay: the velocity has none. Without the adaptive terms the acceleration lags by 1 / gamma1 less a
period (45 ms at 200 Hz); with them by 40 to 43 ms at 1 to 3 rad/s, and by 31 ms at 0.3 rad/s.
Matched by its linearisation, without the adaptive terms: the velocity is z1, and position and
torque pass the linear observer. What remains of the phase grows with frequency and amplitude: 0.5
degrees at 0.5 Hz and 0.5 rad, 2 at 1 Hz, 5 at 2 Hz and 0.1 rad. With the preset table1 the adaptive
gains grow, and with them the rest: 6 degrees at 1 Hz and 0.5 rad, 28 at 2 Hz, and 16 at 1 Hz after
600 s.
Rule: choose gamma1 = 1 / (wanted delay), and gamma0 = 2 gamma1 or less.
gamma0 = 25, gamma1 = 20: convergence gains [1/s], as in Table 1 of the paper.
eta0 = eta1 = eta2 = 0: initial adaptive gains.
leak = 0.1 [1/s], cap = 2, nu_max = 1 [s]: keep the adaptive gains between 0 and cap, and the
integral of the sign bounded. Equation 9 alone lets them grow without bound and diverges at
standstill; the preset table1 is that literal law.
implicit = 0: 1 for implicit Euler steps, which are stable with every gain; 0 for the explicit steps
of the paper.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import (
    require_between,
    require_not_negative,
    require_positive,
    require_positive_or_infinite,
)
from scarid_cli.algorithms.filters.sections import SectionFilter
from scarid_cli.algorithms.filters.sliding import SlidingMode
from scarid_cli.algorithms.processes.linearised import LinearisedMethod
from scarid_cli.algorithms.processes.process import Recursion
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.kernels import p2smd

# What the numbers of the recursion are (see kernels/p2smd.py).
Z0, Z1, NU, ETA0, ETA1, ETA2 = range(6)


@dataclass(frozen=True)
class Differentiator(LinearisedMethod, SlidingMode):
    gamma0: float = 25.0
    gamma1: float = 20.0
    eta0: float = 0.0
    eta1: float = 0.0
    eta2: float = 0.0
    leak: float = 0.1
    cap: float = 2.0
    nu_max: float = 1.0
    implicit: int = 0

    PRESETS: ClassVar = {"table1": {"leak": 0.0, "cap": inf, "nu_max": inf}}
    TUNED: ClassVar = {"gamma0": Range(2.0, 300.0), "gamma1": Range(2.0, 300.0)}

    def check(self) -> None:
        require_positive(self, "gamma0", "gamma1")
        require_positive_or_infinite(self, "cap", "nu_max")
        require_not_negative(self, "eta0", "eta1", "eta2", "leak")
        require_between(self, 0, 1, "implicit")
        if self.implicit and self.cap == inf:
            raise UsageFault("implicit must be 0 with an infinite cap: its law needs gains above 0")

    def start(self, x: float) -> Array:
        return np.array([x, 0.0, 0.0, self.eta0, self.eta1, self.eta2])

    def law(self, x: Array, v: Array, a: Array, values: Array, h: float) -> None:
        # The literal law has no lower bound: eta2 of equation 9 may change its sign.
        floor = 0.0 if self.cap < inf else -inf
        gains = np.array([self.gamma0, self.gamma1, self.leak, floor, self.cap, self.nu_max])
        run = p2smd.implicit if self.implicit else p2smd.differentiate
        run(x, v, a, values, gains, h)

    def linearisation(self) -> LinearObserver:
        return LinearObserver(self.gamma0, self.gamma1, implicit=bool(self.implicit))

    def paired(self, state: Recursion, x: Array) -> tuple[Recursion, Array, Array]:
        after, (_, a) = self.step(state, x)
        z1 = np.cumsum(np.concatenate((state.values[Z1 : Z1 + 1], after.h * a)))
        return after, z1[:-1], a


@dataclass(frozen=True)
class LinearObserver(SectionFilter):
    """gamma0 gamma1 / (s^2 + gamma0 s + gamma0 gamma1) in the Euler steps of the method.

    Its output is the running sum of h z1. The sum is taken at the sample where its central
    differences are exactly the matched velocity and acceleration: that of the next sample for
    explicit steps, that of the last one for implicit steps.
    """

    gamma0: float
    gamma1: float
    implicit: bool

    def sections(self, h: float) -> Array:
        g0, g1 = self.gamma0 * h, self.gamma0 * self.gamma1 * h * h
        if self.implicit:
            a0 = 1.0 + g0 + g1
            return np.array([[0.0, g1, 0.0, -2.0 - g0, 1.0]]) / a0
        return np.array([[0.0, g1, 0.0, g0 - 2.0, 1.0 - g0 + g1]])
