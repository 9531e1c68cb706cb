"""The motion of a robot from a measured state on, driven by measured torques: an open loop.

The kernel of the closed loop integrates it. Its controller of computed torque has a model of unit
inertia without gravity and friction, and no gains: the acceleration wanted is then the torque.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.plants.controllers import KINDS
from scarid_cli.algorithms.plants.loop import LARGE, IndefiniteError
from scarid_cli.algorithms.plants.model import FORWARD, SMOOTH, STRIBECK, Model, model
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.kernels import arm

STEP = 1e-3  # s: the longest step of the integration
FRICTION = [0, 1, FORWARD, FORWARD + 1, STRIBECK, SMOOTH, 8, 9, 20]
LINK = slice(13, 23)  # of a row of the body: the standard parameters


class OpenLoop:
    """A robot with parameters theta, whose torques are given."""

    def __init__(self, robot: Robot, theta: Array) -> None:
        values = dict(zip(robot.names, theta.tolist(), strict=True))
        self._plant = model(robot.with_values(values))
        self._nothing = _unit(self._plant)

    def positions(self, q: Array, dq: Array, torques: Array, h: float) -> Array:
        """The positions (joints, samples) of samples h [s] apart.

        q and dq (joints) are those of the first sample, and torques (joints, samples) [N m or N]
        are linear between samples. After the arm has left all bounds, positions are nan. Raises
        IndefiniteError where the inertia matrix is not positive definite.
        """
        joints, samples = torques.shape
        wanted = np.zeros((samples, 3 * joints))
        wanted[:-1, 2 * joints :] = (0.5 * (torques[:, 1:] + torques[:, :-1])).T
        gains = np.zeros((joints, 8))
        gains[:, 3] = LARGE
        gains[:, 6] = 1.0
        log = np.full((samples, 9 * joints), np.nan)
        setup = np.array([h, 0.0, KINDS["computed-torque"], 0.0, 0.0, 0.0])
        done = arm.run(
            wanted,
            np.zeros((samples, joints)),
            log,
            np.array([q, dq]),
            np.zeros(joints),
            np.array([q, np.zeros(joints), np.zeros(joints)]),
            self._plant.tables,
            self._nothing.tables,
            gains,
            setup,
            max(1, int(np.ceil(h / STEP - 1e-9))),
        )
        if setup[5] != 0.0:
            raise IndefiniteError
        log[done + 1 :] = np.nan
        return np.ascontiguousarray(log[:, 2 * joints : 3 * joints].T)


def _unit(plant: Model) -> Model:
    """A model of the same joints with an inertia of 1 each, and nothing else."""
    body, joints = plant.body.copy(), plant.joints.copy()
    body[:, LINK] = 0.0
    joints[:, FRICTION] = 0.0
    motors, world = np.eye(len(joints)), np.zeros_like(plant.world)
    none = np.zeros((0, 6))
    return replace(
        plant, body=body, joints=joints, motors=motors, couplings=none, world=world
    ).with_sticking()
