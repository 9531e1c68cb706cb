"""Reversed and swapped joints: other signs or another order of positions or torques."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array

GROSS = 0.5  # of the mean square torque of a joint: a smaller residual is not one of wiring
SAMPLES = 300  # that are tried
FALL = 0.7  # each step must reduce the misfit to less than this share of it
EXPLAINED = 0.1  # of the misfit is left at most if the wiring explains it
STEPS = 3


@dataclass(frozen=True)
class Wiring:
    """Which signal each joint really has, and with which sign: the signals that were logged.

    `steps` describes what differs from the wiring at identification.
    """

    places: tuple[tuple[int, ...], tuple[int, ...]]  # of positions, and of torques
    signs: tuple[tuple[int, ...], tuple[int, ...]]
    steps: tuple[str, ...] = ()

    @classmethod
    def same(cls, joints: int) -> Wiring:
        order, signs = tuple(range(joints)), (1,) * joints
        return cls((order, order), (signs, signs))

    @property
    def exchanged(self) -> bool:
        """Whether any signal is that of another joint."""
        return self.places != self.same(len(self.places[0])).places

    def reversed(self, signal: int, joint: int) -> Wiring:
        signs = [list(s) for s in self.signs]
        signs[signal][joint] *= -1
        return replace(self, signs=(tuple(signs[0]), tuple(signs[1])))

    def swapped(self, signal: int, one: int, two: int) -> Wiring:
        both = []
        for k, values in enumerate((*self.places, *self.signs)):
            row = list(values)
            if k % 2 == signal:
                row[one], row[two] = row[two], row[one]
            both.append(tuple(row))
        return replace(self, places=(both[0], both[1]), signs=(both[2], both[3]))

    def signals(self, motion: Array) -> tuple[Array, Array]:
        """Position, velocity, acceleration (3, joints, samples), and torque as they should be."""
        kinematics = motion[:3, list(self.places[0])] * np.array(self.signs[0])[:, None]
        return kinematics, motion[3, list(self.places[1])] * np.array(self.signs[1])[:, None]

    def neighbours(self) -> Iterator[Wiring]:
        """The wirings that differ by one reversal or swap, of positions, torques or both."""
        joints = range(len(self.signs[0]))
        for names, signals in WHAT:
            for j in joints:
                other = self
                for signal in signals:
                    other = other.reversed(signal, j)
                yield replace(other, steps=(*self.steps, f"{names} of joint {j + 1} reversed"))
            for one, two in combinations(joints, 2):
                other = self
                for signal in signals:
                    other = other.swapped(signal, one, two)
                text = f"{names} of joints {one + 1} and {two + 1} swapped"
                yield replace(other, steps=(*self.steps, text))


WHAT = (("torque", (1,)), ("position", (0,)), ("position and torque", (0, 1)))


def rewired(robot: Robot, rows: Rows, theta: Array) -> tuple[str, ...]:
    """What was reversed or swapped, if that explains a gross misfit of the torques."""
    chosen = np.unique(np.linspace(0, rows.samples - 1, SAMPLES).astype(np.int64))
    motion = rows.motion[:, :, chosen]
    counted = (rows.scales[chosen] > 0.0).T.astype(np.float64)
    wiring = Wiring.same(len(robot.joints))
    misfits = _misfits(robot, motion, counted, theta, wiring)
    if not np.any(misfits > GROSS):
        return ()
    first = before = _measure(misfits)
    for _ in range(STEPS):
        tried = [
            (_measure(_misfits(robot, motion, counted, theta, other)), k, other)
            for k, other in enumerate(wiring.neighbours())
        ]
        least, _, best = min(tried)
        if least > FALL * before:
            break
        before, wiring = least, best
    return wiring.steps if before < EXPLAINED * first else ()


def _measure(misfits: Array) -> float:
    return float(np.sum(misfits / (1.0 + misfits)))


def _misfits(robot: Robot, motion: Array, counted: Array, theta: Array, wiring: Wiring) -> Array:
    """The mean square residual of each joint over its mean square torque (joints)."""
    kinematics, tau = wiring.signals(motion)
    residual = tau - robot.torques(robot.regressor(*kinematics), theta)
    squares = np.sum(counted * tau**2, axis=1)
    found: Array = np.sum(counted * residual**2, axis=1) / np.maximum(squares, 1e-300)
    return found
