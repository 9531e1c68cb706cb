"""The regressor of any robot along a motion, and its reverse pass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.design.motors import Shafts, shafts
from scarid_cli.algorithms.robots import newton_euler
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.following import Following
from scarid_cli.algorithms.robots.mechanism import mechanism, places
from scarid_cli.arrays import Array, Numbers

SMOOTH = 0.05  # rad/s or m/s: jumps of friction at rest are spread over such velocities
Motion = tuple[Array, Array, Array]


@dataclass(frozen=True)
class Model:
    """A robot's columns: those of its chain of links, and those of its friction and motors.

    The parameters `rigid` are those of the chain, at `places` among its standard parameters.
    `theta` (parameters) are a priori values; `gravity`, `axes` and `following` are those of
    mechanism.Mechanism.
    """

    axes: Array
    gravity: Array
    following: Following
    rigid: Numbers
    places: Numbers
    motors: tuple[Shafts, ...]
    theta: Array

    @classmethod
    def of(cls, robot: Robot) -> Model:
        chain = mechanism(robot)
        at = {i: place for i, place in enumerate(places(robot)) if place is not None}
        terms = [parameter.term for parameter in robot.parameters]
        return cls(
            chain.axes,
            chain.gravity,
            chain.following,
            np.array(list(at), dtype=np.int64),
            np.array(list(at.values()), dtype=np.int64),
            shafts(terms, len(robot.joints)),
            robot.apriori,
        )

    def regressor(self, motion: Motion, smooth: float = SMOOTH) -> Array:
        """W (samples, joints, parameters) along q, dq and ddq, each (joints, samples).

        It is that of the robot, but for friction at velocities of the size of `smooth`.
        """
        joints, samples = motion[0].shape
        W = np.zeros((samples, joints, len(self.theta)))
        if len(self.rigid):
            standard = newton_euler.regressor(self.axes, self.gravity, *self._joints(motion))
            own = self.following.torques(standard.swapaxes(0, 1)).swapaxes(0, 1)
            W[:, :, self.rigid] = own[:, :, self.places]
        for group in self.motors:
            u = group.turns @ motion[group.signal]
            W[:, group.acts, group.columns] += group.torque(u, smooth).T
        return W

    def gradient(self, motion: Motion, G: Array) -> Motion:
        """The derivatives of sum(G * W) by q, dq and ddq, each (joints, samples)."""
        joints, samples = motion[0].shape
        slopes = np.zeros((3, joints, samples))
        if len(self.rigid):
            follows = self.following
            standard = np.zeros((samples, len(follows.axis), newton_euler.LINK * len(follows.axis)))
            wanted = G[:, :, self.rigid].swapaxes(0, 1)
            standard[:, :, self.places] = follows.rates(wanted).swapaxes(0, 1)
            moved = self._joints(motion)
            back = newton_euler.gradient(self.axes, self.gravity, *moved, standard)
            slopes[:] = [follows.torques(own) for own in back]
        for group in self.motors:
            u = group.turns @ motion[group.signal]
            pulled = group.slope(u, SMOOTH) * G[:, group.acts, group.columns].T
            slopes[group.signal] += group.turns.T @ pulled
        return slopes[0], slopes[1], slopes[2]

    def _joints(self, motion: Motion) -> Motion:
        """The motion of all joints of the chain, from that of the axes."""
        q, dq, ddq = motion
        follows = self.following
        return follows.positions(q), follows.rates(dq), follows.rates(ddq)
