"""Where the links of a chain are, and how points on them depend on the positions of the axes.

A quantity comes with its pullback: the function that takes the derivatives of a number with respect
to the quantity to those with respect to the positions of the axes (joints, samples).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from scarid_cli.arrays import Array, Numbers

Pullback = Callable[[Array], Array]


@dataclass(frozen=True)
class Points:
    """Points that move with the links of a chain.

    `link` (points): the axis (from 1) whose link carries each point, 0 for the base. `place`
    (points, 3): where the point is in the frame of that axis, or of the base [m].
    """

    link: Numbers
    place: Array


@dataclass(frozen=True)
class Pose:
    """The frames of the base (first) and of all links of a chain, in the frame of the base.

    `turns` (joints + 1, samples, 3, 3), `origins` (joints + 1, samples, 3) [m], `directions` of the
    axes (joints, samples, 3), and which axes are `prismatic` (joints).
    """

    turns: Array
    origins: Array
    directions: Array
    prismatic: Array

    @classmethod
    def of(cls, axes: Array, q: Array) -> Pose:
        """The pose of the axes of a mechanism.Mechanism at q (joints, samples) [rad or m]."""
        joints, samples = q.shape
        turns = np.empty((joints + 1, samples, 3, 3))
        origins = np.zeros((joints + 1, samples, 3))
        directions = np.empty((joints, samples, 3))
        turns[0] = np.eye(3)
        for i, (axis, position) in enumerate(zip(axes, q, strict=True)):
            origins[i + 1] = origins[i] + turns[i] @ axis[9:12]
            turn = (turns[i].reshape(-1, 3) @ axis[:9].reshape(3, 3)).reshape(samples, 3, 3)
            directions[i] = turn @ axis[12:15]
            if axis[15]:
                origins[i + 1] += directions[i] * position[:, None]
            else:
                turn = _turned(turn, axis[12:15], position)
            turns[i + 1] = turn
        return cls(turns, origins, directions, axes[:, 15] != 0.0)

    def positions(self, points: Points) -> tuple[Array, Pullback]:
        """Where the points are (points, samples, 3) [m]; the pullback."""
        pairs = zip(points.link, points.place, strict=True)
        X = np.array([self.origins[link] + self.turns[link] @ place for link, place in pairs])
        return X, lambda slopes: self._pulled(points, X, slopes)

    def _pulled(self, points: Points, X: Array, slopes: Array) -> Array:
        """By virtual work: the torques that hold forces `slopes` at the points X."""
        forces, moments = np.zeros_like(self.origins), np.zeros_like(self.origins)
        for link, force, moment in zip(points.link, slopes, np.cross(X, slopes), strict=True):
            forces[link] += force
            moments[link] += moment
        forces, moments = (x[:0:-1].cumsum(axis=0)[::-1] for x in (forces, moments))
        about = moments - np.cross(self.origins[1:], forces)
        effort = np.where(self.prismatic[:, None, None], forces, about)
        return np.asarray(np.sum(self.directions * effort, axis=2))


def _turned(turns: Array, axis: Array, angles: Array) -> Array:
    """The rotations after a further one about an axis (Rodrigues)."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    once = turns.reshape(-1, 3) @ K
    twice = once @ K
    sine, rest = np.sin(angles)[:, None, None], (1.0 - np.cos(angles))[:, None, None]
    turned: Array = turns + sine * once.reshape(turns.shape) + rest * twice.reshape(turns.shape)
    return turned
