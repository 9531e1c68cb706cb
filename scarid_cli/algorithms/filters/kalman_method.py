"""What the Kalman differentiators have in common: their settings, model and constant gain."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import inf
from typing import Self

import numpy as np

from scarid_cli.algorithms.choices.settings import (
    require_between,
    require_not_negative,
    require_positive,
    require_positive_or_infinite,
)
from scarid_cli.algorithms.filters.acceleration import discretised
from scarid_cli.algorithms.filters.kalman import KalmanState, Model, filtered
from scarid_cli.algorithms.processes.method import Method

# Before the first sample: the variance of each derivative [SI units], and the standard deviations
# of differences of the noise that it is at most. Beyond, a smoother would lose all digits.
START, WIDE = 1e3, 1e4
STATES = (3, 4, 5)


@dataclass(frozen=True)
class KalmanMethod(Method):
    """A Kalman filter or smoother of a motion whose acceleration is a random process.

    noise: standard deviation of the position [rad or m]. intensity: spectral density of the white
    noise. states: 3 to 5. damping [1/s] and frequency [rad/s] of the acceleration process. gate:
    standard deviations beyond which an innovation is a glitch.
    """

    noise: float = 5e-5
    intensity: float = 10000.0
    states: int = 4
    damping: float = 0.0
    frequency: float = 0.0
    gate: float = 20.0

    HAS_LIKELIHOOD = True

    def check(self) -> None:
        self.check_noise()
        require_between(self, STATES[0], STATES[-1], "states")
        require_not_negative(self, "damping", "frequency")
        require_positive_or_infinite(self, "gate")

    def check_noise(self) -> None:
        """Noise and intensity must be positive; a method that finds them itself also takes 0."""
        require_positive(self, "noise", "intensity")

    def ungated(self) -> Self:
        """The same method without a gate against encoder glitches, for torques."""
        return replace(self, gate=inf)

    def observer(self, x: float, h: float) -> KalmanState:
        """The filter at rest at the position x, which keeps its settled gain; h [s]."""
        steady = settled(self, h)
        return replace(steady.with_constant_gain(steady.gain), x=np.eye(self.states)[0] * x)

    def model(self, h: float) -> Model:
        """The model of positions sampled every h [s]."""
        F, Q = discretised(self.states, self.damping, self.frequency, h)
        variance = self.noise**2
        orders = np.arange(1, self.states)
        start = np.minimum(START, variance * (WIDE / h**orders) ** 2)
        noise = np.array([variance, self.gate**2])
        return Model(F, self.intensity * Q, noise, np.concatenate(([variance], start)))


@lru_cache(maxsize=64)  # for every joint and its torque, and again for each check of the settings
def settled(method: KalmanMethod, h: float) -> KalmanState:
    """The filter once its gain is constant."""
    state = method.model(h).at_rest(0.0)
    still = np.zeros(4096)
    for _ in range(1000):
        state, _ = filtered(state, still)
        if state.settled:
            break
    return state
