"""The signals of the simulated robot at the ticks of its controller, and in between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from scarid_cli.algorithms.sensors.instants import Instants
from scarid_cli.algorithms.sensors.motion import Encoder, Motion, between
from scarid_cli.algorithms.sensors.torque import TorqueSensor
from scarid_cli.arrays import Array


class Ticks(NamedTuple):
    """The signals at the ticks of the controller, each (joints, ticks), in SI units.

    `q` is the reading of the encoder, with `q_noise` in it; `tau_input` and `tau_output` are those
    of the low-pass of the torque sensor, without `tau_noise`.
    """

    q: Array
    q_noise: Array
    q_true: Array
    dq_true: Array
    ddq_true: Array
    tau_true: Array
    q_ref: Array
    dq_ref: Array
    ddq_ref: Array
    tau_input: Array
    tau_output: Array
    tau_noise: Array


@dataclass(frozen=True)
class Signals:
    """The ticks from number `first` on, a period h [s] apart, read at any instants.

    Instants are (joints, samples), or (1, samples) for all joints; so are the results, but always
    with all joints.
    """

    ticks: Ticks
    first: int
    h: float

    @property
    def last(self) -> int:
        """The number of the last tick."""
        return self.first + len(self.ticks.q[0]) - 1

    def motion(self, at: Instants) -> Motion:
        """The true position, velocity and acceleration."""
        start = (
            self._held(self.ticks.q_true, at),
            self._held(self.ticks.dq_true, at),
            self._held(self.ticks.ddq_true, at),
        )
        if not at.fraction.any():
            return start
        after = Instants(np.minimum(at.tick + 1, self.last), at.fraction)
        end = self._held(self.ticks.q_true, after), self._held(self.ticks.dq_true, after)
        inside = at.fraction > 0.0
        moved = between(start, end, at.fraction * self.h, self.h)
        q, dq, ddq = (np.where(inside, x, y) for x, y in zip(moved, start, strict=True))
        return q, dq, ddq

    def readings(self, at: Instants, encoder: Encoder) -> Array:
        """What the encoder reads; at a tick, exactly what the controller has read."""
        seen = self._held(self.ticks.q, at)
        if not at.fraction.any():
            return seen
        between_ticks = encoder.reading(self.motion(at)[0], self._held(self.ticks.q_noise, at))
        return np.where(at.fraction > 0.0, between_ticks, seen)

    def torques(self, at: Instants, sensor: TorqueSensor) -> Array:
        """What the torque sensor gives, with the noise of the tick."""
        u, y = self._held(self.ticks.tau_input, at), self._held(self.ticks.tau_output, at)
        return sensor.between(u, y, at.fraction) + self._held(self.ticks.tau_noise, at)

    def torques_true(self, at: Instants) -> Array:
        """The true torques, constant from tick to tick."""
        return self._held(self.ticks.tau_true, at)

    def references(self, at: Instants) -> tuple[Array, Array, Array]:
        """What the controller was told to follow, constant from tick to tick."""
        ticks = self.ticks
        q, dq, ddq = (self._held(x, at) for x in (ticks.q_ref, ticks.dq_ref, ticks.ddq_ref))
        return q, dq, ddq

    def _held(self, signal: Array, at: Instants) -> Array:
        """The signal (joints, ticks) at the last ticks before the instants."""
        index = np.broadcast_to(at.tick - self.first, (len(signal), at.tick.shape[1]))
        taken: Array = np.take_along_axis(signal, index, axis=1)
        return taken
