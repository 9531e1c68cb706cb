"""Alternatives for the positions: how the torques change if a joint is not where its encoder says.

A position that is off by a small e(t) changes the torques of all joints by

    (dtau/dq) e + (dtau/d(dq)) de/dt + (dtau/d(ddq)) d2e/dt2

which is linear in the size of the error: a column for the regression. Errors of an encoder are an
offset of its zero and an eccentricity, with the sine and the cosine of the position of a revolute
joint. A transmission behind an encoder on the motor yields by the torque that it carries, divided
by its stiffness.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.statistics.alternatives import Model
from scarid_cli.arrays import Array

SMALL = 1e-4  # of the motion, or rad and m: by which it is moved for the derivatives


@dataclass(frozen=True)
class Sensitivities:
    """The derivatives of the torques of the links by the motion of each joint.

    `values` (joint, 3, samples, joints): by its position, velocity and acceleration.
    """

    values: Array

    @classmethod
    def of(cls, model: Model, theta: Array, motion: Array) -> Sensitivities:
        """At a motion (3, joints, samples): positions, velocities and accelerations."""
        before, found = model.link_torques(motion, theta), []
        for joint in range(motion.shape[1]):
            for order in range(3):
                size = SMALL * max(1.0, float(np.max(np.abs(motion[order, joint]), initial=0.0)))
                moved = motion.copy()
                moved[order, joint] += size
                found.append((model.link_torques(moved, theta) - before) / size)
        return cls(np.array(found).reshape(-1, 3, *before.shape))

    def column(self, joint: int, error: Array) -> Array:
        """The change of the torques (samples, joints) for an error (3, samples) of one joint."""
        return np.asarray(np.einsum("osj,os->sj", self.values[joint], error))


def encoder_columns(model: Model, sensitivities: Sensitivities, motion: Array) -> Array:
    """The columns (samples, joints, columns) of offsets and eccentricities of all encoders.

    motion: as that of the sensitivities.
    """
    columns = [
        sensitivities.column(k, error)
        for k, joint in enumerate(model.robot.joints)
        if joint.unit == "rad"
        for error in _errors(*motion[:, k])
    ]
    samples, joints = motion.shape[2], motion.shape[1]
    return np.stack(columns, axis=2) if columns else np.zeros((samples, joints, 0))


def _errors(q: Array, dq: Array, ddq: Array) -> Iterator[Array]:
    """An offset, the sine and the cosine of q, with their derivatives (3, samples)."""
    sine, cosine = np.sin(q), np.cos(q)
    yield np.stack((np.ones_like(q), np.zeros_like(q), np.zeros_like(q)))
    yield np.stack((sine, cosine * dq, cosine * ddq - sine * dq**2))
    yield np.stack((cosine, -sine * dq, -sine * ddq - cosine * dq**2))


def elastic_columns(sensitivities: Sensitivities, torque: Array) -> Array:
    """The columns (samples, joints, joints) of elastic transmissions.

    torque: what they carry, with its first two derivatives (3, joints, samples).
    """
    columns = [sensitivities.column(k, error) for k, error in enumerate(torque.swapaxes(0, 1))]
    return np.stack(columns, axis=2)
