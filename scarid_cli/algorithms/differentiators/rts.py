"""Kalman smoother over the whole record (Rauch, Tung, Striebel 1965), tuned by the data.

Whole record, in linear time. Noise and model by maximum likelihood of the innovations, intensity by
generalised cross-validation (held-out positions), unless given: nothing has to be known. D.12 of
the equations; backwards as in Durbin and Koopman, section 4.4. No delay. Matched (--match):
position and torque are smoothed alike; exact to second order in the period. Rule: none.
noise = 0: standard deviation of the position; 0: all settings but the gate from the data.
intensity = 0: spectral density of the white noise, [rad2/s7] for 4 states; 0: likewise.
states = 4: 3 to 5.
damping = frequency = 0: of the acceleration process [1/s], [rad/s].
gate = 20: standard deviations from which on an innovation is a glitch and left out (3 in a row
at most).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from scarid_cli.algorithms.choices.settings import require_not_negative
from scarid_cli.algorithms.filters import kalman
from scarid_cli.algorithms.processes.process import Whole
from scarid_cli.algorithms.tuning.likelihood import best_model, best_smoothing
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Smoother(kalman.Settings, Whole):
    """Position, velocity and acceleration."""

    noise: float = 0.0
    intensity: float = 0.0

    def require_noise(self) -> None:
        require_not_negative(self, "noise", "intensity")

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        state, records = kalman.recorded(self.model(h).at_rest(x[0]), x)
        return tuple(np.ascontiguousarray(kalman.smoothed(records, state).T))


@dataclass(frozen=True)
class Differentiator(Smoother):
    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        return Smoother.over(self.fitted(x, h), x, h)[1:]

    def fitted(self, x: Array, h: float) -> Differentiator:
        """With the noise and the model of these positions, and the intensity to smooth them."""
        if self.noise and self.intensity:
            return self
        return best_smoothing(best_model(self, x, h), x, h)

    def matched(self) -> Matched:
        return Matched(**vars(self))


@dataclass(frozen=True)
class Matched(Smoother):
    """All three as they are: the derivatives are those of the smoothed position."""

    @property
    def torque_filter(self) -> Position:
        return Position(**vars(replace(self, gate=inf)))


@dataclass(frozen=True)
class Position(Smoother):
    """The smoothed signal alone."""

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        return Smoother.over(self, x, h)[:1]
