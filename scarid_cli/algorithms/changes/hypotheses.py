"""What may have changed between two logs of a robot: directions in the space of all columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.robots.coupled import CoupledCoulomb, CoupledViscous
from scarid_cli.algorithms.robots.description import Parameter, Robot
from scarid_cli.algorithms.robots.rigid import STANDARD_UNITS, SYMBOLS
from scarid_cli.algorithms.robots.terms import (
    Coulomb,
    CoulombBackward,
    CoulombForward,
    Offset,
    Stribeck,
    Viscous,
    ViscousBackward,
    ViscousForward,
)
from scarid_cli.arrays import Array

FRICTION = (
    Viscous,
    Coulomb,
    Stribeck,
    ViscousForward,
    ViscousBackward,
    CoulombForward,
    CoulombBackward,
    CoupledViscous,
    CoupledCoulomb,
)
PAYLOAD, DELAY, MOTOR, DRIFT = "payload", "delay", "motor constant", "friction"
OFFSET, ZERO = "offset", "zero"


@dataclass(frozen=True)
class Hypothesis:
    """A possible change.

    `directions` (columns, k) span it in the space of the columns of `evidence.LogEvidence`; `names`
    and `units` are those of its k amounts. `joints` (from 1) are those concerned.
    """

    kind: str
    directions: Array
    names: tuple[str, ...]
    units: tuple[str, ...]
    joints: tuple[int, ...] = ()


def hypotheses(robot: Robot) -> list[Hypothesis]:
    """The changes that are tested for this robot."""
    joints = range(1, len(robot.joints) + 1)
    found = [_payload(robot), _delay(robot), *(_motor(robot, j) for j in joints)]
    found += [_friction(robot, (j,)) for j in joints]
    found += [_friction(robot, tuple(joints))] if len(joints) > 1 else []
    found += [_offset(robot, j) for j in joints]
    found += [_zero(robot, j) for j in joints]
    return [h for h in found if h.directions.shape[1]]


def width(robot: Robot) -> int:
    """The number of all columns."""
    return len(robot.parameters) + 1 + 3 * len(robot.joints)


def _of_parameters(robot: Robot, chosen: list[int]) -> Array:
    directions = np.zeros((width(robot), len(chosen)))
    directions[chosen, range(len(chosen))] = 1.0
    return directions


def _payload(robot: Robot) -> Hypothesis:
    """Another load on the last link; without a URDF, any change of the inertial parameters."""
    parameters = robot.parameters
    if not robot.body:
        inertial = [
            i for i, p in enumerate(parameters) if not isinstance(p.term, (*FRICTION, Offset))
        ]
        return Hypothesis(PAYLOAD, _of_parameters(robot, inertial), *_labels(parameters, inertial))
    last = len(robot.joints)
    directions = np.zeros((width(robot), len(SYMBOLS)))
    for row, parameter in enumerate(parameters):
        parts = dict(parameter.parts)
        for column, symbol in enumerate(SYMBOLS):
            directions[row, column] = parts.get(f"{symbol}{last}", 0.0)
    names = tuple(f"{symbol}{last}" for symbol in SYMBOLS)
    return Hypothesis(PAYLOAD, directions, names, STANDARD_UNITS)


def _labels(
    parameters: tuple[Parameter, ...], chosen: list[int]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    return tuple(parameters[i].name for i in chosen), tuple(parameters[i].unit for i in chosen)


def _delay(robot: Robot) -> Hypothesis:
    """Another delay of all torques."""
    return Hypothesis(DELAY, _single(robot, len(robot.parameters)), ("delay",), ("s",))


def _motor(robot: Robot, joint: int) -> Hypothesis:
    """Another motor constant, so that all torques of a joint are measured too large or small."""
    at = len(robot.parameters) + joint
    return Hypothesis(MOTOR, _single(robot, at), (f"motor constant {joint}",), ("",), (joint,))


def _friction(robot: Robot, joints: tuple[int, ...]) -> Hypothesis:
    """Another friction of some joints."""
    chosen = [
        i
        for i, p in enumerate(robot.parameters)
        if isinstance(p.term, FRICTION) and set(p.term.joints) & set(joints)
    ]
    labels = _labels(robot.parameters, chosen)
    return Hypothesis(DRIFT, _of_parameters(robot, chosen), *labels, joints)


def _offset(robot: Robot, joint: int) -> Hypothesis:
    """Another offset of the torque of a joint."""
    own = [
        i
        for i, p in enumerate(robot.parameters)
        if isinstance(p.term, Offset) and p.term.joints == (joint,)
    ]
    extra = len(robot.parameters) + len(robot.joints) + joint
    unit = robot.joints[joint - 1].torque_unit
    at = own[0] if own else extra
    return Hypothesis(OFFSET, _single(robot, at), (f"offset {joint}",), (unit,), (joint,))


def _zero(robot: Robot, joint: int) -> Hypothesis:
    """Another zero of the positions of a joint."""
    at = len(robot.parameters) + 2 * len(robot.joints) + joint
    unit = robot.joints[joint - 1].unit
    return Hypothesis(ZERO, _single(robot, at), (f"zero {joint}",), (unit,), (joint,))


def _single(robot: Robot, at: int) -> Array:
    direction = np.zeros((width(robot), 1))
    direction[at] = 1.0
    return direction
