"""The robot whose regressor the rows of a log have, and the torques of its links."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.robots.coupled import CoupledInertia
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.terms import Mass, Offset, Term
from scarid_cli.arrays import Array, Marks

MOTORS = (Mass, CoupledInertia)  # terms of their inertia


@dataclass(frozen=True)
class Model:
    """The robot whose regressor the rows have, and the indices of the columns that were kept."""

    robot: Robot
    kept: list[int]

    def regressor(self, q: Array, dq: Array, ddq: Array) -> Array:
        """W of the kept columns (samples, joints, parameters)."""
        return self.robot.regressor(q, dq, ddq)[:, :, self.kept]

    def inertias(self, q: Array) -> Array:
        """The rows (joints, samples, parameters) of the diagonal of the inertia matrix at q.

        q (joints, samples).
        """
        rest = np.zeros_like(q)
        still = self.regressor(q, rest, rest)
        units = np.broadcast_to(np.eye(len(q))[:, :, None], (len(q), *q.shape))
        moved = (self.regressor(q, rest, np.ascontiguousarray(ddq)) for ddq in units)
        return np.stack([(x - still)[:, j] for j, x in enumerate(moved)])

    @property
    def transmits(self) -> Marks:
        """Which of the kept parameters are of torques that a joint transmits: all but friction."""
        return self._marks(transmitted)

    @property
    def rubs(self) -> Marks:
        """Which of the kept parameters are of friction."""
        return self._marks(lambda term: term.FRICTION)

    def link_torques(self, motion: Array, theta: Array) -> Array:
        """The torques (samples, joints) of the links alone, without friction and motors.

        motion (3, joints, samples): positions, velocities and accelerations.
        """
        links = self.transmits & self._marks(lambda term: not isinstance(term, MOTORS))
        kept = [i for i, chosen in zip(self.kept, links, strict=True) if chosen]
        return self.robot.partial_torques(motion, kept, theta[links])

    def tilted(self, q: Array, theta: Array) -> Array | None:
        """The gravity torques (samples, joints, 2) of a base that is tilted about two axes, by 1.

        q (joints, samples). None without a URDF or without gravity.
        """
        body = self.robot.body
        if not body or not any(body.gravity):
            return None
        still = np.stack((q, np.zeros_like(q), np.zeros_like(q)))
        sideways = _sideways(np.array(body.gravity))
        robots = [replace(self.robot, body=replace(body, gravity=tuple(g))) for g in sideways]
        torques = [replace(self, robot=r).link_torques(still, theta) for r in robots]
        return np.stack(torques, axis=2)

    def leaning(self, q: Array, theta: Array, sines: Array) -> Array | None:
        """The columns (samples, joints, 4) of a base that leans: `tilted`, and two of joint 1.

        Times the `sines` (2) of the angles, the first two are what leaning adds to the torques,
        what it takes from the weight included. Where the axis of joint 1 is vertical, no parameter
        has the first moments of what it turns, which pull at it when it leans. Where it is not,
        parameters have the other two columns already.
        """
        torques = self.tilted(q, theta)
        if torques is None:
            return None
        if square := float(np.sum(sines**2)):
            still = np.stack((q, np.zeros_like(q), np.zeros_like(q)))
            part = (np.sqrt(max(1.0 - square, 0.0)) - 1.0) / square
            torques = torques + part * sines * self.link_torques(still, theta)[:, :, None]
        found = np.concatenate((torques, np.zeros_like(torques)), axis=2)
        if self.robot.joints[0].unit == "rad":
            found[:, 0, 2], found[:, 0, 3] = np.cos(q[0]), np.sin(q[0])
        return found

    def _marks(self, chosen: Callable[[Term], bool]) -> Marks:
        return np.array([chosen(self.robot.parameters[i].term) for i in self.kept], dtype=bool)


def tilted(gravity: Array, amounts: Array) -> Array:
    """The gravity [m/s2] of a base that leans by angles of these sines (2).

    An amount of nan, about an axis about which the log shows no tilt, is none.
    """
    sines = np.nan_to_num(amounts)
    left = np.sqrt(max(1.0 - float(sines @ sines), 0.0))
    return np.asarray(left * gravity + sines @ _sideways(gravity))


def _sideways(gravity: Array) -> Array:
    """Two vectors (2, 3) as long as that of gravity, at right angles to it and to each other."""
    return np.asarray(np.linalg.svd(gravity[None])[2][1:] * np.linalg.norm(gravity))


def transmitted(term: Term) -> bool:
    """Whether a joint transmits the torques of this term: it is no friction, nor goes with it."""
    return not (term.FRICTION or isinstance(term, Offset))
