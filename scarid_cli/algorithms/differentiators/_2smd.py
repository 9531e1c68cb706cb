"""Second-order sliding-mode differentiator (2SMD) of Levant.

Causal. It runs the recursion of Levant (Int. J. Control 76 (2003) 924) in explicit Euler steps.
That is equation 6 of the paper with its exponent corrected to 2/3. The output is taken from the
states after each update, brought back to the present sample.
Delay: that of the sampling if eta2 exceeds the largest jerk of the motion, otherwise tens of
milliseconds.
Matched by measured delays: position, velocity and torque are delayed by as much as the method
delays moves of 1 rad in 0.8 s or more, within its bounds, behind an encoder of 18 bit.
Within the bound of its gains the match is right to 3 degrees; motions beyond it are not followed:
99 degrees at 1 Hz and 0.5 rad with the default.
Rule: for the largest jerk L [1/s3], take eta0 = 2 L^(1/3), eta1 = 1.5 L^(1/2) and eta2 = 1.1 L.
eta0 = 10: first gain, as in Table 1 of the paper.
eta1 = 12, eta2 = 70: second and third gain, by the rule for L = 64 rad/s3, which moves of 1 rad in
a second need. Table 1 prints 8 and 5 (preset table1), which cannot follow a jerk above 4.5 rad/s3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.filters.sliding import LAMBDA, SlidingMode
from scarid_cli.algorithms.processes.delays import Bounds
from scarid_cli.arrays import Array
from scarid_cli.kernels import smd2


@dataclass(frozen=True)
class Differentiator(SlidingMode):
    eta0: float = 10.0
    eta1: float = 12.0
    eta2: float = 70.0

    PRESETS: ClassVar = {"table1": {"eta1": 8.0, "eta2": 5.0}}
    TUNED: ClassVar = {
        "eta0": Range(1.0, 100.0),
        "eta1": Range(1.0, 300.0),
        "eta2": Range(1.0, 10000.0),
    }

    def check(self) -> None:
        require_positive(self, "eta0", "eta1", "eta2")

    def bounds(self) -> Bounds:
        return ((3, self.eta2 / LAMBDA[1][2]),)

    def start(self, x: float) -> Array:
        return np.array([x, 0.0, 0.0])

    def law(self, x: Array, v: Array, a: Array, values: Array, h: float) -> None:
        smd2.differentiate(x, v, a, values, np.array([self.eta0, self.eta1, self.eta2]), h)
