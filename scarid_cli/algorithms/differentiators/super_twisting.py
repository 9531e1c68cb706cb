"""Super-twisting differentiator of Levant, two in series.

Causal. Levant, Automatica 34 (1998) 379, in explicit Euler steps: equation 30 of the paper with
fixed gains. The second differentiates the velocity of the first. Without noise the error converges
to that of the sampling if the bounds hold; the acceleration chatters.
Delay: with noise, tens of milliseconds.
Matched by measured delays: position, velocity and torque are delayed by as much as the method
delays moves of 1 rad in 0.8 s or more, within its bounds, behind an encoder of 18 bit.
Within the bounds the match is right to 4 degrees; motions beyond them are not followed: 115 degrees
at 1 Hz and 1 rad with the default.
Rule: the bounds are those of the motion. A quintic move of d in the time T has an acceleration of
5.8 d / T^2 and a jerk of 60 d / T^3.
acceleration = 20 [1/s2], jerk = 150 [1/s3]: the largest of the motion, from which Levant's gains
follow with the factors 1.5 and 1.1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_positive
from scarid_cli.algorithms.filters.sliding import SlidingMode, gains
from scarid_cli.algorithms.processes.delays import Bounds
from scarid_cli.arrays import Array
from scarid_cli.kernels import levant


@dataclass(frozen=True)
class Differentiator(SlidingMode):
    acceleration: float = 20.0
    jerk: float = 150.0

    TUNED: ClassVar = {"acceleration": Range(1.0, 300.0), "jerk": Range(10.0, 1e4)}

    def check(self) -> None:
        require_positive(self, "acceleration", "jerk")

    def bounds(self) -> Bounds:
        return (2, self.acceleration), (3, self.jerk)

    def start(self, x: float) -> Array:
        return np.array([[x, 0.0], [0.0, 0.0]])

    def law(self, x: Array, v: Array, a: Array, values: Array, h: float) -> None:
        (first, second), unused = values, np.empty_like(x)
        levant.differentiate(x, v, unused, first, gains(1, self.acceleration), 0, 0, h)
        levant.differentiate(v, a, unused, second, gains(1, self.jerk), 0, 0, h)
