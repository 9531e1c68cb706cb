"""Kalman filter of a random acceleration, with a gate against encoder glitches.

Causal. The chain of equations D.11: white jerk, snap or crackle for 3, 4 or 5 states; with damping
and frequency the acceleration is a stochastic oscillator (4 states) or, at frequency 0, a Matern
process. Exact in discrete time; starts with velocity and acceleration unknown. Bandwidth [rad/s]:
(intensity / (noise^2 period))^(1/8) for 4 states. Delay: none at constant jerk; of the acceleration
on quintic moves of 0.8 to 2 s 4 ms at the default (73 rad/s), 33 ms at 23 rad/s. Matched (--match,
exact but at glitches): constant gain; position and torque pass the low-pass between position and
highest derivative, which does not overshoot. Rule: `scarid tune` finds all settings but the last by
maximum likelihood.
noise = 5e-5: standard deviation of the position, at least resolution / 3.5.
intensity = 10000: spectral density of the white noise, [rad2/s7] for 4 states.
states = 4: 3 to 5.
damping = frequency = 0: of the acceleration process [1/s], [rad/s].
gate = 20: standard deviations from which on an innovation is a glitch and left out (3 in a row
at most).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from scarid_cli.algorithms.filters import kalman
from scarid_cli.algorithms.filters.observer import Lowpass
from scarid_cli.algorithms.processes.matching import Differences
from scarid_cli.algorithms.processes.process import Causal
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Differentiator(kalman.Settings, Causal):
    def init(self, x: float, h: float) -> kalman.State:
        return self.model(h).at_rest(x)

    def step(self, state: kalman.State, x: Array) -> tuple[kalman.State, tuple[Array, ...]]:
        state, rows = kalman.filtered(state, x)
        return state, (np.ascontiguousarray(rows[:, 1]), np.ascontiguousarray(rows[:, 2]))

    def matched(self) -> Differences:
        return Differences(Lowpass(self), Lowpass(replace(self, gate=inf)))
