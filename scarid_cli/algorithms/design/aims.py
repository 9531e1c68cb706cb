"""What a motion is to tell other than parameters: the gains of the torques, or a payload.

Either is a model with columns of its own, of which the first are wanted and all others are
nuisance. The gain of a joint is a factor on its logged torque; its column is that torque by the a
priori values, in the rows of that joint alone. All gains together are a factor of all parameters,
so one joint has none: which one does not change the determinant of the others' covariance. The ten
parameters of a payload move those of the arm, and friction may have changed as well
(changes/payload.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from scarid_cli.algorithms.changes.payload import directions
from scarid_cli.algorithms.design.model import Model, Motion
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

RANK = 1e-9  # of the largest singular value


class Columns(Protocol):
    """The regressor (samples, joints, columns) along a motion, and its reverse pass."""

    def regressor(self, motion: Motion) -> Array:
        """The columns along q, dq and ddq, each (joints, samples)."""

    def gradient(self, motion: Motion, G: Array) -> Motion:
        """The derivatives of sum(G * columns) by q, dq and ddq."""


@dataclass(frozen=True)
class Changed:
    """Columns that are combinations (columns of `by`: parameters, columns) of a model's."""

    model: Model
    by: Array

    def regressor(self, motion: Motion) -> Array:
        """As Columns."""
        return self.model.regressor(motion) @ self.by

    def gradient(self, motion: Motion, G: Array) -> Motion:
        """As Columns."""
        return self.model.gradient(motion, G @ self.by.T)


@dataclass(frozen=True)
class Gained:
    """The gains of all joints but the first, before the columns of a model."""

    model: Model

    def regressor(self, motion: Motion) -> Array:
        """As Columns."""
        W = self.model.regressor(motion)
        torques = W @ self.model.theta
        gains = np.einsum("sj,jk->sjk", torques, np.eye(W.shape[1]))
        return np.concatenate([gains[:, :, 1:], W], axis=2)

    def gradient(self, motion: Motion, G: Array) -> Motion:
        """As Columns."""
        count = G.shape[1] - 1
        own = G[:, :, count:].copy()
        for j in range(count):
            own[:, j + 1] += G[:, j + 1, j, None] * self.model.theta
        return self.model.gradient(motion, own)


@dataclass(frozen=True)
class Aim:
    """So many `columns` of a model; the first `wanted` of them are what is asked for."""

    model: Columns
    columns: int
    wanted: int


def gains(robot: Robot) -> Aim:
    """What tells the gains of the joints beside one another."""
    count = len(robot.joints) - 1
    if not count:
        raise UsageFault(f"--for gains: no log of {robot.name} tells the gain of its only joint")
    if not robot.apriori.any():
        raise UsageFault(
            f"--for gains: {robot.name} states no values of its parameters, so no torques"
        )
    return Aim(Gained(Model.of(robot)), count + len(robot.parameters), count)


def payload(robot: Robot) -> Aim:
    """What tells the payload on the last link, as far as torques depend on it."""
    if not robot.body:
        raise UsageFault(f"--for payload: {robot.name} has no URDF, so its flange is not known")
    B = directions(robot)
    U, s, _ = np.linalg.svd(B, full_matrices=False)
    told = U[:, s > RANK * s[0]]
    by = np.column_stack([told, np.eye(len(B))[:, ~B.any(axis=1)]])
    return Aim(Changed(Model.of(robot), by), by.shape[1], told.shape[1])


AIMS = {"gains": gains, "payload": payload}
