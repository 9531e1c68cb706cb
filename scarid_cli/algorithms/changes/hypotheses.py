"""What may have changed between two logs of a robot: directions in the space of all columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.changes.columns import Columns
from scarid_cli.algorithms.robots.description import Parameter, Robot
from scarid_cli.algorithms.robots.rigid import STANDARD_UNITS, SYMBOLS
from scarid_cli.algorithms.robots.terms import Offset
from scarid_cli.arrays import Array

PAYLOAD, DELAY, MOTOR, DRIFT = "payload", "delay", "motor constant", "friction"
OFFSET, ZERO, SCALE = "offset", "zero", "scale"
TILT, LOW_PASS = "tilt", "low-pass"
SEARCHED = (ZERO, TILT, LOW_PASS)  # in searches of their own, as their columns are not the usual


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
    several = len(joints) > 1
    found = [_payload(robot), _delay(robot), *(_motor(robot, j) for j in joints)]
    found += [_scale(robot)] if several else []
    found += [_friction(robot, (j,)) for j in joints]
    found += [_friction(robot, tuple(joints))] if several else []
    found += [_offset(robot, j) for j in joints]
    found += [_zero(robot, j) for j in joints]
    found += [_tilt(robot)] if robot.body and any(robot.body.gravity) else []
    found += [_low_pass(robot)]
    return [h for h in found if h.directions.shape[1]]


def searches(columns: Columns) -> list[tuple[str, tuple[int, ...]]]:
    """What is searched for by itself, and the places of its columns."""
    return [
        (ZERO, tuple(columns.zeros)),
        (TILT, tuple(columns.tilts)),
        (LOW_PASS, (columns.bend,)),
    ]


def columns_of(robot: Robot) -> Columns:
    """The columns by which logs of this robot are compared."""
    return Columns(len(robot.parameters), len(robot.joints))


def _of_parameters(robot: Robot, chosen: list[int]) -> Array:
    directions = np.zeros((columns_of(robot).count, len(chosen)))
    directions[chosen, range(len(chosen))] = 1.0
    return directions


def _payload(robot: Robot) -> Hypothesis:
    """Another load on the last link; without a URDF, any change of the inertial parameters."""
    parameters = robot.parameters
    if not robot.body:
        inertial = [
            i
            for i, p in enumerate(parameters)
            if not (p.term.FRICTION or isinstance(p.term, Offset))
        ]
        return Hypothesis(PAYLOAD, _of_parameters(robot, inertial), *_labels(parameters, inertial))
    last = robot.body.link_numbers[-1]
    directions = np.zeros((columns_of(robot).count, len(SYMBOLS)))
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
    return Hypothesis(DELAY, _along(robot, columns_of(robot).delay), ("delay",), ("s",))


def _low_pass(robot: Robot) -> Hypothesis:
    """Another low-pass of all torques: to second order a delay, and their second derivative."""
    at = columns_of(robot)
    names, units = ("delay", "second derivative"), ("s", "s2")
    return Hypothesis(LOW_PASS, _along(robot, at.delay, at.bend), names, units)


def _tilt(robot: Robot) -> Hypothesis:
    """Gravity in another direction."""
    at = columns_of(robot).tilts
    return Hypothesis(TILT, _along(robot, *at), ("tilt 1", "tilt 2"), ("rad", "rad"))


def _motor(robot: Robot, joint: int) -> Hypothesis:
    """Another motor constant, so that all torques of a joint are measured too large or small."""
    at = columns_of(robot).motors[joint - 1]
    return Hypothesis(MOTOR, _along(robot, at), (f"motor constant {joint}",), ("",), (joint,))


def _scale(robot: Robot) -> Hypothesis:
    """All torques are measured too large or too small, by the same factor."""
    every = _along(robot, *columns_of(robot).motors).sum(axis=1, keepdims=True)
    return Hypothesis(SCALE, every, ("scale",), ("",))


def _friction(robot: Robot, joints: tuple[int, ...]) -> Hypothesis:
    """Another friction of some joints."""
    chosen = [
        i
        for i, p in enumerate(robot.parameters)
        if p.term.FRICTION and set(p.term.joints) & set(joints)
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
    unit = robot.joints[joint - 1].torque_unit
    at = own[0] if own else columns_of(robot).offsets[joint - 1]
    return Hypothesis(OFFSET, _along(robot, at), (f"offset {joint}",), (unit,), (joint,))


def _zero(robot: Robot, joint: int) -> Hypothesis:
    """Another zero of the positions of a joint."""
    at, unit = columns_of(robot).zeros[joint - 1], robot.joints[joint - 1].unit
    return Hypothesis(ZERO, _along(robot, at), (f"zero {joint}",), (unit,), (joint,))


def _along(robot: Robot, *places: int) -> Array:
    """A direction along each of the columns in these places."""
    return np.eye(columns_of(robot).count)[:, list(places)]
