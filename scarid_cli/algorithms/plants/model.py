"""A robot as the compiled arm takes it (kernels/mechanics.py)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.robots.coupled import CoupledCoulomb, CoupledInertia, CoupledTerm
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.mechanism import Mechanism, mechanism
from scarid_cli.algorithms.robots.terms import AxisTerm, Coulomb, Mass, Stribeck
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.kernels import rigid

# Columns of `joints`; those of friction are named after the terms that they add up.
FRICTION = {
    "viscous": (0, 1),
    "viscous-forward": (0,),
    "viscous-backward": (1,),
    "coulomb": (2, 3),
    "coulomb-forward": (2,),
    "coulomb-backward": (3,),
    "stribeck": (4,),
    "offset": (8,),
    "quadratic": (20,),
}
FORWARD, BACKWARD, STRIBECK, STRIBECK_VELOCITY = 2, 3, 4, 5
SMOOTH, SMOOTH_VELOCITY, LOAD, DRIFT, DRIFT_TIME, STICKS = 6, 7, 9, 10, 11, 12
DRIVE, STIFFNESS, DAMPING, GAIN, LAG, RIPPLE, RIPPLE_ANGLE = 13, 14, 15, 16, 17, 18, 19


@dataclass(frozen=True)
class Model:
    """The constants of an arm: tables for the kernel (kernels/rigid.py, kernels/mechanics.py)."""

    body: Array
    motors: Array
    joints: Array
    couplings: Array
    world: Array
    turn: Array  # (3, 3): axes of the last frame of the tables, in the frame of the last link

    @property
    def tables(self) -> tuple[Array, ...]:
        """The tables in the order of the kernel."""
        return self.body, self.motors, self.joints, self.couplings, self.world

    @property
    def positions(self) -> int:
        """The number of positions: those of the joints, then those of motors behind flexibility."""
        return len(self.motors)

    def with_sticking(self) -> Model:
        """The model with the mark of joints that Coulomb friction holds at rest.

        Where the sum of Coulomb and Stribeck friction is negative it would drive the joint, and
        does not hold it.
        """
        joints = self.joints.copy()
        rest = joints[:, [FORWARD, BACKWARD]] + joints[:, [STRIBECK]]
        some = np.any(rest > 0.0, axis=1) | (joints[:, LOAD] > 0.0)
        joints[:, STICKS] = some & np.all(rest >= 0.0, axis=1)
        return replace(self, joints=joints)


def model(robot: Robot) -> Model:
    """The arm of a robot description, with its a priori values."""
    chain = mechanism(robot)
    n = len(robot.joints)
    joints, motors = np.zeros((n, 21)), np.zeros((n, n))
    joints[:, [STRIBECK_VELOCITY, SMOOTH_VELOCITY, DRIFT_TIME, GAIN]] = 1.0
    joints[:, DRIVE] = np.arange(n)
    couplings: dict[tuple[int, int], Array] = {}
    for parameter in robot.parameters:
        term, value = parameter.term, parameter.apriori
        if isinstance(term, Mass):
            motors[term.joint - 1, term.joint - 1] += value
        elif isinstance(term, AxisTerm):
            _rub(joints[term.joint - 1], term, value)
        elif isinstance(term, CoupledTerm):
            _couple(couplings, motors, term, value)
    rows = sorted(couplings.values(), key=lambda row: -row[1])
    if len({row[1] for row in rows}) < len(rows):
        raise UsageFault(
            f"robot {robot.name}: two couplings of one joint cannot be simulated; leave one out"
        )
    world = np.array([*chain.gravity, 0.0, 0.0, 0.0, 0.0])
    table = np.array(rows).reshape(-1, 6)
    body, turn = turned(chain), towards(chain.axes[-1, 12:15])
    return Model(body, motors, joints, table, world, turn).with_sticking()


def _rub(row: Array, term: AxisTerm, value: float) -> None:
    """Add a term of friction to the row of its joint."""
    if isinstance(term, Coulomb) and term.velocity > 0.0:
        row[SMOOTH], row[SMOOTH_VELOCITY] = value, term.velocity
        return
    row[list(FRICTION[term.NAME])] += value
    if isinstance(term, Stribeck):
        row[STRIBECK_VELOCITY] = term.velocity


def _couple(
    rows: dict[tuple[int, int], Array], motors: Array, term: CoupledTerm, value: float
) -> None:
    """Add a term of a motor that turns with two joints; the first of them has the lower number."""
    one, two = sorted((term.joint - 1, term.other - 1))
    ratios = (term.ratio, 1.0) if one == term.joint - 1 else (1.0, term.ratio)
    row = rows.setdefault((one, two), np.array([one, two, *ratios, 0.0, 0.0]))
    if isinstance(term, CoupledInertia):
        motors[one, two] += term.ratio * value
        motors[two, one] += term.ratio * value
    elif isinstance(term, CoupledCoulomb):
        row[5] += value
    else:
        row[4] += term.ratio * value


def turned(chain: Mechanism) -> Array:
    """The joints of a chain (joints, 26), with their links in frames whose z is the axis."""
    body = np.zeros((len(chain.axes), 26))
    before = np.eye(3)
    for row, axis, link in zip(body, chain.axes, chain.links, strict=True):
        turn = towards(axis[12:15])
        row[:9] = (before.T @ axis[:9].reshape(3, 3) @ turn).ravel()
        row[9:12] = before.T @ axis[9:12]
        row[12] = axis[15]
        row[13:23] = rotated(link, turn)
        before = turn
    follows = chain.following
    body[:, 23:] = np.column_stack((follows.axis, follows.ratio, follows.offset))
    return body


def towards(z: Array) -> Array:
    """A rotation whose third column is the unit vector z."""
    if z[2] == 1.0:
        return np.eye(3)
    x = np.eye(3)[np.argmin(np.abs(z))]
    x = x - z * (x @ z)
    x /= np.linalg.norm(x)
    return np.column_stack((x, np.cross(z, x), z))


def rotated(link: Array, turn: Array) -> Array:
    """Standard parameters (10) in a frame whose axes are the columns of `turn`."""
    xx, xy, xz, yy, yz, zz = link[:6]
    inertia = turn.T @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn
    return np.concatenate((inertia[np.triu_indices(3)], turn.T @ link[6:9], link[9:]))


def dynamics(arm: Model, q: Array) -> tuple[Array, Array]:
    """The torques of gravity (joints) and the inertia matrix of the joints, at rest at q."""
    n = len(arm.joints)
    bias, matrix, motion = np.zeros(n), np.zeros((n, n)), np.zeros((2, n))
    motion[0] = q
    rigid.dynamics(arm.body, arm.world[:3], motion, bias, matrix)
    return bias, matrix + arm.motors[:n, :n]


def inertia(arm: Model, q: Array) -> Array:
    """The inertia matrix (joints, joints) at q (joints)."""
    return dynamics(arm, q)[1]
