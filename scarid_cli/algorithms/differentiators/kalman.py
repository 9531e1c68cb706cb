"""Kalman filter of a motion with random acceleration, with a gate against encoder glitches.

Causal. Kalman, J. Basic Eng. 82 (1960) 35, for white jerk, snap or crackle with 3, 4 or 5 states.
With damping and frequency the acceleration is a stochastic oscillator (4 states), with damping
alone a Matern process. The model is exact in discrete time, and velocity and acceleration are
unknown at the start. The bandwidth is (intensity / (noise^2 period))^(1/8) rad/s for 4 states. See
docs/theory.md, section "Kalman filters and smoothers".
Delay: none at constant jerk. On quintic moves of 0.8 to 2 s the acceleration lags by 4 ms at the
default (73 rad/s), and by 33 ms at 23 rad/s.
Matched (exact, except at glitches): with the gain held constant, position and torque pass the
low-pass between position and highest derivative, which does not overshoot.
Rule: `scarid tune` finds all settings except the gate by maximum likelihood.
noise = 5e-5: standard deviation of the position, at least resolution / 3.5.
intensity = 10000: spectral density of the white noise, [rad2/s7] for 4 states.
states = 4: number of states, 3 to 5.
damping = frequency = 0: damping [1/s] and frequency [rad/s] of the acceleration process.
gate = 20: number of standard deviations beyond which an innovation is taken for a glitch and left
out (at most 3 in a row).
"""

from __future__ import annotations

from dataclasses import dataclass

from scarid_cli.algorithms.filters.kalman import KalmanState
from scarid_cli.algorithms.filters.kalman_method import KalmanMethod
from scarid_cli.algorithms.filters.observer import ObserverMethod


@dataclass(frozen=True)
class Differentiator(KalmanMethod, ObserverMethod):
    def init(self, x: float, h: float) -> KalmanState:
        return self.model(h).at_rest(x)
