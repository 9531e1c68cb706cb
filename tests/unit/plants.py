"""Simulated robots without control, noise or encoder, for the tests of the plant."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from unit.support import adjusted

from scarid_cli.algorithms.plants.controllers import Law
from scarid_cli.algorithms.plants.loop import ClosedLoop, LoopState
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.sensors.signals import LoopLog
from scarid_cli.arrays import Array

RATE = 1000.0
LAW = ("kp", "kd", "ki", "velocity_cutoff", "kind")
GAINS = {"kp": np.array([800.0, 25.0]), "kd": np.array([100.0, 2.5])}


def closed_loop(robot: Robot, **settings: Any) -> ClosedLoop:
    """No control, no noise and a perfect encoder, unless settings say otherwise."""
    none = np.zeros(len(robot.joints))
    names = ("encoder_resolution", "position_noise", "torque_noise")
    control = {name: settings.pop(name) for name in LAW if name in settings}
    law = Law(**(dict.fromkeys(("kp", "kd", "ki"), none) | {"velocity_cutoff": 0.0} | control))
    fixed = {"law": law, "seed": 0, "control_rate": RATE}
    return ClosedLoop(robot, **(dict.fromkeys(names, none) | fixed | settings))


def moving(state: LoopState, *dq: float) -> LoopState:
    """The same state, with velocities."""
    motion = state.motion.copy()
    motion[1, : len(dq)] = dq
    return replace(state, motion=motion)


def free(loop: ClosedLoop, q: list[float], dq: list[float], ticks: int) -> LoopLog:
    """What happens without a reference."""
    nothing = np.zeros((len(q), ticks))
    return loop.step(moving(loop.init(np.array(q)), *dq), nothing, nothing, nothing)[1]


def pushed(robot: Robot, *torques: float) -> ClosedLoop:
    """A robot whose torques are constant: whatever its error, they are at their limits."""
    joints = [
        replace(joint, torque_limit=torque)
        for joint, torque in zip(robot.joints, torques, strict=True)
    ]
    return closed_loop(replace(robot, joints=tuple(joints)), kp=np.full(len(joints), 1e12))


def push(loop: ClosedLoop, ticks: int) -> LoopLog:
    """From rest at zero, all torques forwards."""
    joints = len(loop.robot.joints)
    far, still = np.full((joints, ticks), 1e3), np.zeros((joints, ticks))
    return loop.step(loop.init(np.zeros(joints)), far, still, still)[1]


def reference(joints: int, ticks: int) -> tuple[Array, Array, Array]:
    """Sines to follow: position, velocity and acceleration."""
    t, omega = np.arange(ticks) / RATE, np.linspace(2.0, 3.0, max(joints, 2))[:joints, None]
    q = 0.5 * np.sin(omega * t)
    return q, 0.5 * omega * np.cos(omega * t), -omega * omega * q


def inertia(robot: Robot, q: Array) -> Array:
    """The inertia matrix of the planar arm (paper eq. 26): (samples, 2, 2)."""
    zz1r, zz2, mx, my = (robot.value(term) for term in ("ZZ1R", "ZZ2", "L1MX2", "L1MY2"))
    coupling = mx * np.cos(q[1]) - my * np.sin(q[1])
    rows = [[zz1r + zz2 + 2.0 * coupling, zz2 + coupling], [zz2 + coupling, zz2 + 0.0 * coupling]]
    return np.moveaxis(np.array(rows), 2, 0)


SMOOTH = adjusted("scara2", Fv1=0.0, Fs1=0.0, Fv2=0.0, Fs2=0.0, L1MY2=0.03)

ARM = [3.42, 0.064, 0.131, 0.03]


def mass_matrix(q2: Any) -> Array:
    zz1r, zz2, mx, my = ARM
    coupling = mx * np.cos(q2) - my * np.sin(q2)
    return np.array([[zz1r + zz2 + 2.0 * coupling, zz2 + coupling], [zz2 + coupling, zz2]])
