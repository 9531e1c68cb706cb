"""The true motion between the ticks of the controller, and what the encoders read there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.sensors.torque import rounded
from scarid_cli.arrays import Array

Motion = tuple[Array, Array, Array]


def between(start: Motion, end: tuple[Array, Array], x: Array, h: float) -> Motion:
    """Position, velocity and acceleration at a time x [s] after a tick, all (joints, samples).

    They are those of the polynomial of fourth order that has the position, velocity and
    acceleration `start` of the tick, and the position and velocity `end` of the next one, h [s]
    later. At x = 0 they are those of the tick, to the last bit.
    """
    q, v, a = start
    rest = end[0] - q - h * (v + 0.5 * h * a)
    turn = h * (end[1] - v - h * a)
    c3, c4 = (4.0 * rest - turn) / h**3, (turn - 3.0 * rest) / h**4
    return (
        q + x * (v + x * (0.5 * a + x * (c3 + x * c4))),
        v + x * (a + x * (3.0 * c3 + x * 4.0 * c4)),
        a + x * (6.0 * c3 + x * 12.0 * c4),
    )


def steady(q: Array, v: Array, q1: Array, v1: Array, h: float) -> Array:
    """The acceleration at the start with which `between` is a polynomial of third order."""
    acceleration: Array = (6.0 * (q1 - q) / h - 4.0 * v - 2.0 * v1) / h
    return acceleration


@dataclass(frozen=True)
class Encoder:
    """An encoder with an eccentricity: it reads q + A sin(n q + phase), quantised; per joint.

    Amplitude A and resolution [rad or m], n turns of the encoder per turn of the joint, phase
    [rad].
    """

    resolution: Array
    amplitude: Array
    turns: Array
    phase: Array

    def reading(self, q: Array, noise: Array) -> Array:
        """What it reads at the positions q (joints, samples) [rad or m], with added noise."""
        error = np.zeros_like(q)
        for j in np.flatnonzero(self.amplitude):
            error[j] = self.amplitude[j] * np.sin(self.turns[j] * q[j] + self.phase[j])
        return rounded(q + error + noise, self.resolution)
