"""The arm of a description with imperfections (docs/simulator.md has their equations)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.plants import model as columns
from scarid_cli.algorithms.plants.imperfections import Payload, PlantImperfections
from scarid_cli.algorithms.plants.model import Model, dynamics, rotated
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

STABLE = 2.5  # natural frequency times step that the Runge-Kutta method takes (2.8 at its limit)


def imperfect(arm: Model, robot: Robot, given: PlantImperfections, step: float) -> Model:
    """The arm with imperfections, for steps of `step` seconds; without its payload."""
    n = len(arm.joints)
    joints = arm.joints.copy()
    joints[:, columns.GAIN] = 1.0 + given.of("motor_gain", n)
    joints[:, columns.LAG] = 2.0 * np.pi * given.of("drive_bandwidth", n)
    joints[:, columns.RIPPLE] = given.of("ripple", n)
    joints[:, columns.RIPPLE_ANGLE] = 2.0 * np.pi * given.of("ripple_cycles", n)
    _rub(joints, robot, given)
    direction = np.array(given.vibration_direction)
    if given.vibration != 0.0:
        size = float(np.linalg.norm(direction))
        if not size > 0.0:
            raise UsageFault("vibration direction must not be zero")
        direction = direction / size
    world = arm.world.copy()
    world[3:6] = given.vibration * direction
    world[6] = 2.0 * np.pi * given.vibration_frequency
    found = replace(arm, joints=joints, world=world).with_sticking()
    return _flexible(found, robot, given, step)


def _rub(joints: Array, robot: Robot, given: PlantImperfections) -> None:
    """Change the friction in the table of the joints."""
    n = len(joints)
    more = given.of("stribeck", n)
    if np.any((more != 0.0) & (joints[:, columns.STRIBECK] != 0.0)):
        raise UsageFault(
            f"robot {robot.name}: a joint already has Stribeck friction; change it in the "
            "description"
        )
    velocity = given.of("stribeck_velocity", n)
    joints[:, columns.STRIBECK] += more
    joints[more != 0.0, columns.STRIBECK_VELOCITY] = velocity[more != 0.0]
    asymmetry = given.of("friction_asymmetry", n)
    joints[:, columns.FORWARD] *= 1.0 + asymmetry
    joints[:, columns.BACKWARD] *= 1.0 - asymmetry
    joints[:, columns.LOAD] = given.of("load_friction", n)
    joints[:, columns.DRIFT] = given.of("friction_drift", n)
    joints[:, columns.DRIFT_TIME] = given.of("friction_drift_time", n)
    if np.any(joints[:, columns.LOAD] >= 1.0):
        raise UsageFault("load friction must be below 1, or a joint locks itself")


def _flexible(arm: Model, robot: Robot, given: PlantImperfections, step: float) -> Model:
    """The arm with a motor of its own behind each flexible transmission."""
    n = len(arm.joints)
    omega = 2.0 * np.pi * given.of("flexibility", n)
    flexible = np.flatnonzero(omega > 0.0)
    if not len(flexible):
        return arm
    if len(arm.couplings):
        raise UsageFault(f"robot {robot.name}: flexible joints with couplings cannot be simulated")
    own = np.diag(arm.motors)
    _, matrix = dynamics(arm, Limits.of(robot.joints).home)
    link = np.diag(matrix) - own
    if np.any(link[flexible] <= 0.0):
        raise UsageFault(f"robot {robot.name}: a flexible joint needs a link with inertia")
    motor = np.where(own > 0.0, own, given.of("motor_share", n) * link)
    joints = arm.joints.copy()
    joints[flexible, columns.DRIVE] = n + np.arange(len(flexible))
    joints[:, columns.STIFFNESS] = omega * omega * link
    joints[:, columns.DAMPING] = 2.0 * given.of("flexibility_damping", n) * omega * link
    motors = np.diag(np.concatenate((own, motor[flexible])))
    motors[flexible, flexible] = 0.0
    fastest = float(np.max(omega[flexible] * np.sqrt(1.0 + (link / motor)[flexible])))
    if fastest * step > STABLE:
        least = int(np.ceil(fastest * step / STABLE))
        raise UsageFault(
            f"flexible joints oscillate at up to {fastest / (2.0 * np.pi):.0f} Hz, too fast for "
            f"the steps of the simulation; give {least} times as many --substeps"
        )
    return replace(arm, joints=joints, motors=motors)


def at_rest(arm: Model, q: Array, *, on_motor: bool) -> tuple[Array, Array]:
    """The positions (positions) at rest, and the torques (joints) of gravity there.

    q (joints) is the position that the encoders see: of the motors, or of the links. The spring of
    a flexible joint holds gravity.
    """
    n = len(arm.joints)
    drive = arm.joints[:, columns.DRIVE].astype(int)
    flexible = np.flatnonzero(drive >= n)
    link = q.copy()
    for _ in range(100 if on_motor and len(flexible) else 0):
        twist = dynamics(arm, link)[0][flexible] / arm.joints[flexible, columns.STIFFNESS]
        link[flexible] = q[flexible] - twist
    gravity = dynamics(arm, link)[0]
    twist = gravity[flexible] / arm.joints[flexible, columns.STIFFNESS]
    motors = q[flexible] if on_motor else link[flexible] + twist
    return np.concatenate((link, motors)), gravity + arm.joints[:, 8]


def carrying(arm: Model, payload: Payload) -> Model:
    """The arm with a payload on its last link."""
    c, m = np.array(payload.centre), payload.mass
    xx, xy, xz, yy, yz, zz = payload.inertia
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    inertia = inertia + m * ((c @ c) * np.eye(3) - np.outer(c, c))
    link = np.concatenate((inertia[np.triu_indices(3)], m * c, [m]))
    body = arm.body.copy()
    body[-1, 13:23] += rotated(link, arm.turn)
    return replace(arm, body=body)
