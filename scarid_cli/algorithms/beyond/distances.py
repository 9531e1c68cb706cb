"""The alternative of another geometry: distances between the axes that are not as described.

A distance that is off by a small part changes the torques of all joints, which is linear in the
part: a column for the regression. What the parameters of the links express is no contradiction, as
a longer last link of a horizontal arm.
"""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.robots import newton_euler
from scarid_cli.algorithms.robots.mechanism import Mechanism, mechanism
from scarid_cli.arrays import Array

STEP = 1e-4  # of a distance: its torques are a polynomial of degree two
ORIGIN = slice(9, 12)  # of the row of an axis


def distance_columns(model: Model, theta: Array, motion: Array) -> Array | None:
    """The columns (samples, joints, joints) of the distance of each axis from the one before it.

    motion (3, joints, samples): positions, velocities and accelerations. They are 0 where there is
    no distance, and at the first axis. None if no links are known, or if joints follow others.
    """
    robot = model.robot
    values = zip((robot.names[i] for i in model.kept), theta.tolist(), strict=False)
    chain = mechanism(robot.with_values(dict(values)))
    if chain.following.followers or not chain.links.any():
        return None
    links = chain.links
    if robot.body:  # what base parameters do not tell is as described
        described = np.array(robot.body.standard).reshape(links.shape)
        links = described + links - mechanism(robot).links
    columns = np.zeros((motion.shape[2], motion.shape[1], motion.shape[1]))
    for joint in range(1, motion.shape[1]):
        if chain.axes[joint, ORIGIN].any():
            longer, shorter = (_torques(chain, links, joint, s * STEP, motion) for s in (1.0, -1.0))
            columns[:, :, joint] = (longer - shorter) / (2.0 * STEP)
    return columns


def _torques(chain: Mechanism, links: Array, joint: int, part: float, motion: Array) -> Array:
    """The torques (samples, joints) of the links with another distance before a joint."""
    axes = chain.axes.copy()
    axes[joint, ORIGIN] *= 1.0 + part
    W = newton_euler.regressor(axes, chain.gravity, *motion)
    return np.asarray(W @ links.ravel())
