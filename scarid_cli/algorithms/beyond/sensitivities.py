"""Alternatives for the positions: how the torques change if a joint is not where its encoder says.

A position that is off by a small e(t) changes the torques of all joints by

    (dtau/dq) e + (dtau/d(dq)) de/dt + (dtau/d(ddq)) d2e/dt2

which is linear in the size of the error: a column for the regression. Errors of an encoder are
another zero and, of a revolute joint, an eccentricity, with the sine and the cosine of the
position. A transmission behind an encoder on the motor yields by the torque that it carries,
divided by its stiffness.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.arrays import Array

SMALL = 1e-4  # of the motion, or rad and m: by which it is moved for the derivatives
ROUNDING = 1e-12  # of the largest torque: a smaller change is none


@dataclass(frozen=True)
class Sensitivities:
    """The derivatives of the torques of the links by the motion of each joint.

    `values` (joint, orders, samples, joints): by its position, velocity and acceleration.
    """

    values: Array

    @classmethod
    def of(cls, model: Model, theta: Array, motion: Array, orders: int = 3) -> Sensitivities:
        """At a motion (3, joints, samples): positions, velocities and accelerations.

        Only the derivatives by the first so many of these are computed.
        """
        before, found = model.link_torques(motion, theta), []
        least = ROUNDING * np.max(np.abs(before), initial=0.0)
        for joint in range(motion.shape[1]):
            for order in range(orders):
                size = SMALL * max(1.0, float(np.max(np.abs(motion[order, joint]), initial=0.0)))
                moved = motion.copy()
                moved[order, joint] += size
                change = model.link_torques(moved, theta) - before
                found.append(change / size if np.max(np.abs(change)) > least else 0.0 * change)
        return cls(np.array(found).reshape(-1, orders, *before.shape))

    def column(self, joint: int, error: Array) -> Array:
        """The change of the torques (samples, joints) for an error (3, samples) of one joint."""
        return np.asarray(np.einsum("osj,os->sj", self.values[joint], error))


def zero_columns(sensitivities: Sensitivities) -> Array:
    """The columns (samples, joints, joints) of another zero of each joint."""
    return np.moveaxis(sensitivities.values[:, 0], 0, 2)


def eccentric_columns(model: Model, sensitivities: Sensitivities, motion: Array) -> Array:
    """The columns (samples, joints, 2 joints) of the sine, then the cosine, of each position.

    They are 0 for prismatic joints. motion: as that of the sensitivities.
    """
    turns = [joint.unit == "rad" for joint in model.robot.joints]
    q, dq, ddq = motion
    sine, cosine = np.sin(q), np.cos(q)
    columns = [
        sensitivities.column(k, turning * error[:, k])
        for error in (
            np.stack((sine, cosine * dq, cosine * ddq - sine * dq**2)),
            np.stack((cosine, -sine * dq, -sine * ddq - cosine * dq**2)),
        )
        for k, turning in enumerate(turns)
    ]
    return np.stack(columns, axis=2)


def elastic_columns(sensitivities: Sensitivities, torque: Array) -> Array:
    """The columns (samples, joints, joints) of elastic transmissions.

    torque: what they carry, with its first two derivatives (3, joints, samples).
    """
    columns = [sensitivities.column(k, error) for k, error in enumerate(torque.swapaxes(0, 1))]
    return np.stack(columns, axis=2)
