"""High-gain observer of a chain of integrators, all poles in one place (Khalil and Praly 2014).

Causal. Int. J. Robust Nonlinear Control 24, 993; discretised exactly. Delay: none at constant jerk
(4 states); of the acceleration on quintic moves of 0.8 to 2 s 35 ms at the default, 10 ms at
60 rad/s. Matched (--match, exact): position and torque pass the low-pass between position and
highest derivative, which does not overshoot. Rule: bandwidth by the delay; more states, less delay
and more noise.
bandwidth = 30 [rad/s]: of the poles.
states = 4: 3 to 5.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, inf
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_between, require_positive
from scarid_cli.algorithms.filters import kalman
from scarid_cli.algorithms.filters.observer import Lowpass
from scarid_cli.algorithms.processes.matching import Differences
from scarid_cli.algorithms.processes.process import Causal
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Differentiator(Causal):
    bandwidth: float = 30.0
    states: int = 4

    TUNED: ClassVar = {"bandwidth": Range(3.0, 300.0)}

    def __post_init__(self) -> None:
        require_positive(self, "bandwidth")
        require_between(self, 3, 5, "states")

    def init(self, x: float, h: float) -> kalman.State:
        return self.observer(x, h)

    def step(self, state: kalman.State, x: Array) -> tuple[kalman.State, tuple[Array, ...]]:
        state, rows = kalman.filtered(state, x)
        return state, (np.ascontiguousarray(rows[:, 1]), np.ascontiguousarray(rows[:, 2]))

    def matched(self) -> Differences:
        return Differences(Lowpass(self))

    def observer(self, x: float, h: float) -> kalman.State:
        """At rest at x, with the gain that puts all poles to exp(-bandwidth h)."""
        m = int(self.states)
        F, Q = kalman.discretised(m, 0.0, 0.0, h)
        model = kalman.Model(F, Q, np.array([1.0, inf]), np.ones(m))
        state = model.at_rest(x)
        settled = state.work
        settled[1] = 1.0
        return kalman.State(state.x, state.P, gain(m, exp(-self.bandwidth * h), h), settled, model)


def gain(m: int, pole: float, h: float) -> Array:
    """Of the measurement, so that F (I - K H) has its m eigenvalues at the pole (Ackermann)."""
    F, _ = kalman.discretised(m, 0.0, 0.0, 1.0)  # in units of h, h^2, ...
    observability = np.array([np.linalg.matrix_power(F, k)[0] for k in range(m)])
    wanted = np.linalg.matrix_power(F - pole * np.eye(m), m)
    predicted = wanted @ np.linalg.solve(observability, np.eye(m)[-1])
    filtered: Array = np.linalg.solve(F, predicted) / h ** np.arange(m)
    return filtered
