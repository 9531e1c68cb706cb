"""High-gain observer of a chain of integrators, with all poles in one place.

Causal. Khalil and Praly, Int. J. Robust Nonlinear Control 24 (2014) 993, discretised exactly.
Delay: none at constant jerk (4 states). On quintic moves of 0.8 to 2 s the acceleration lags by
35 ms at the default, and by 10 ms at 60 rad/s.
Matched (exact): position and torque pass the low-pass between position and highest derivative,
which does not overshoot.
Rule: choose the bandwidth by the delay. More states mean less delay and more noise.
bandwidth = 30 [rad/s]: distance of all poles from the origin.
states = 4: number of states, 3 to 5.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_between, require_positive
from scarid_cli.algorithms.filters.kalman import KalmanState
from scarid_cli.algorithms.filters.observer import ObserverMethod
from scarid_cli.algorithms.filters.placement import observer_of


@dataclass(frozen=True)
class Differentiator(ObserverMethod):
    bandwidth: float = 30.0
    states: int = 4

    TUNED: ClassVar = {"bandwidth": Range(3.0, 300.0)}

    def check(self) -> None:
        require_positive(self, "bandwidth")
        require_between(self, 3, 5, "states")

    def init(self, x: float, h: float) -> KalmanState:
        return self.observer(x, h)

    def observer(self, x: float, h: float) -> KalmanState:
        """The observer at rest at x, with the gain that puts all poles at exp(-bandwidth h)."""
        return observer_of(np.full(self.states, exp(-self.bandwidth * h)), x, h)
