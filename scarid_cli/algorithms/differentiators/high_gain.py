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
from math import exp, inf
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_between, require_positive
from scarid_cli.algorithms.filters.acceleration import discretised
from scarid_cli.algorithms.filters.kalman import KalmanState, Model
from scarid_cli.algorithms.filters.observer import ObserverMethod
from scarid_cli.arrays import Array


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
        m = self.states
        F, Q = discretised(m, 0.0, 0.0, h)
        model = Model(F, Q, np.array([1.0, inf]), np.ones(m))
        return model.at_rest(x).with_constant_gain(gain(m, exp(-self.bandwidth * h), h))


def gain(m: int, pole: float, h: float) -> Array:
    """The gain (m) of the measurement with which F (I - K H) has all eigenvalues at the pole.

    By Ackermann's formula; h [s].
    """
    F, _ = discretised(m, 0.0, 0.0, 1.0)  # in units of h, h^2, ...
    observability = np.array([np.linalg.matrix_power(F, k)[0] for k in range(m)])
    wanted = np.linalg.matrix_power(F - pole * np.eye(m), m)
    predicted = wanted @ np.linalg.solve(observability, np.eye(m)[-1])
    filtered: Array = np.linalg.solve(F, predicted) / h ** np.arange(m)
    return filtered
