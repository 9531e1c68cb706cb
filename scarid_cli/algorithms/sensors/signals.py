"""The signals of the simulated robot at the ticks of its controller, and in between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from scarid_cli.algorithms.sensors.instants import Instants
from scarid_cli.algorithms.sensors.motion import Encoder, Motion, between, steady
from scarid_cli.algorithms.sensors.torque import TorqueSensor
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class LoopLog:
    """The signals at each tick of the controller: arrays (joints, ticks), in SI units.

    `q` and `tau` are measured: the readings of the encoders, with `q_noise` in them, and the
    `command` plus `tau_noise`. `tau_true` is the torque that acts, and `friction_true` what of it
    friction takes. `q_motor_true` and `dq_motor_true` differ from
    `q_true` and `dq_true` for flexible joints.
    """

    q: Array
    tau: Array
    q_true: Array
    dq_true: Array
    ddq_true: Array
    tau_true: Array
    friction_true: Array
    q_motor_true: Array
    dq_motor_true: Array
    command: Array
    q_noise: Array
    tau_noise: Array


class Ticks(NamedTuple):
    """The signals at the ticks of the controller, each (joints, ticks), in SI units.

    `q` is the reading of the encoder, with `q_noise` in it; `tau_input` and `tau_output` are those
    of the low-pass of the torque sensor, without `tau_noise`. `q_motor` and `dq_motor` are of the
    motors behind flexible transmissions.
    """

    q: Array
    q_noise: Array
    q_true: Array
    dq_true: Array
    ddq_true: Array
    tau_true: Array
    friction_true: Array
    q_motor: Array
    dq_motor: Array
    q_ref: Array
    dq_ref: Array
    ddq_ref: Array
    tau_input: Array
    tau_output: Array
    tau_noise: Array


@dataclass(frozen=True)
class Signals:
    """The ticks from number `first` on, a period h [s] apart, read at any instants.

    The true torque is constant within a period if it is `held`. Encoders are on the motors if
    `on_motor`. Instants are (joints, samples), or (1, samples) for all joints; the results are
    (joints, samples).
    """

    ticks: Ticks
    first: int
    h: float
    held: bool
    on_motor: bool

    @property
    def last(self) -> int:
        """The number of the last tick."""
        return self.first + len(self.ticks.q[0]) - 1

    def truth(self, at: Instants) -> list[Array]:
        """True position, velocity, acceleration, torque, friction; the motor's first two."""
        ticks = self.ticks
        link = self._moved((ticks.q_true, ticks.dq_true), ticks.ddq_true, at)
        motor = self._moved((ticks.q_motor, ticks.dq_motor), None, at)
        tau = self._held(ticks.tau_true, at) if self.held else self._blend(ticks.tau_true, at)
        return [*link, tau, self._blend(ticks.friction_true, at), *motor[:2]]

    def readings(self, at: Instants, encoder: Encoder) -> Array:
        """What the encoder reads; at a tick, exactly what the controller has read."""
        seen = self._held(self.ticks.q, at)
        if not at.fraction.any():
            return seen
        ticks = self.ticks
        if self.on_motor:
            position = self._moved((ticks.q_motor, ticks.dq_motor), None, at)[0]
        else:
            position = self._moved((ticks.q_true, ticks.dq_true), ticks.ddq_true, at)[0]
        between_ticks = encoder.reading(position, self._held(ticks.q_noise, at))
        return np.where(at.fraction > 0.0, between_ticks, seen)

    def torques(self, at: Instants, sensor: TorqueSensor) -> Array:
        """What the torque sensor gives, with the noise of the tick."""
        u, y = self._held(self.ticks.tau_input, at), self._held(self.ticks.tau_output, at)
        return sensor.between(u, y, at.fraction) + self._held(self.ticks.tau_noise, at)

    def references(self, at: Instants) -> list[Array]:
        """What the controller was told to follow, constant from tick to tick."""
        ticks = self.ticks
        return [self._held(x, at) for x in (ticks.q_ref, ticks.dq_ref, ticks.ddq_ref)]

    def _moved(self, motion: tuple[Array, Array], ddq: Array | None, at: Instants) -> Motion:
        """Position, velocity and acceleration; without ddq, of a polynomial of third order."""
        q, v = (self._held(x, at) for x in motion)
        end, v_end = (self._held(x, self._next(at)) for x in motion)
        a = steady(q, v, end, v_end, self.h) if ddq is None else self._held(ddq, at)
        if not at.fraction.any():
            return q, v, a
        moved = between((q, v, a), (end, v_end), at.fraction * self.h, self.h)
        inside = at.fraction > 0.0
        q, v, a = (np.where(inside, x, y) for x, y in zip(moved, (q, v, a), strict=True))
        return q, v, a

    def _next(self, at: Instants) -> Instants:
        return Instants(np.minimum(at.tick + 1, self.last), at.fraction)

    def _blend(self, signal: Array, at: Instants) -> Array:
        """A signal that varies within a period, interpolated linearly."""
        start = self._held(signal, at)
        return start + at.fraction * (self._held(signal, self._next(at)) - start)

    def _held(self, signal: Array, at: Instants) -> Array:
        """The signal (joints, ticks) at the last ticks before the instants."""
        index = np.broadcast_to(at.tick - self.first, (len(signal), at.tick.shape[1]))
        taken: Array = np.take_along_axis(signal, index, axis=1)
        return taken
