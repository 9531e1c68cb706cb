"""Reversed torques and exchanged joints, without knowing the parameters of the robot.

Wirings that differ from the log by a few reversals or exchanges are fitted. One that leaves far
less of the torques unexplained is preferred; of those that explain them alike, one whose friction
brakes. A reversal of all torques changes nothing but the sign of all parameters, and so only the
friction tells it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.changes.wiring import Wiring
from scarid_cli.algorithms.checks.finding import Finding, failed, joints_text, ok, warning
from scarid_cli.algorithms.checks.model import Fit, Samples, fitted
from scarid_cli.algorithms.robots.description import Robot

FALL = 0.5  # of the mean square residual: what a wiring must leave at most to be preferred
EXPLAINED = 0.02  # of the mean square torque of each joint: exchanged joints leave far more
UNEXPLAINED = 0.2  # of the mean square torque of a joint that a model leaves which does not fit
EXACT = 1e-6  # of the mean square torque of each joint: 0.1 % of it, which no sensor shows
STEPS = 3  # reversals or exchanges that are looked for, one after the other


@dataclass(frozen=True)
class Wired:
    """A wiring, and the fit of the log with it."""

    wiring: Wiring
    fit: Fit


def wired(robot: Robot, samples: Samples) -> Wired:
    """The wiring that explains the log, which is the log's own unless another is far better."""
    found = _searched(robot, samples, _neighbours, FALL)
    return _braking(found, lambda wiring: _tried(robot, samples, wiring))


def reversed_axes(robot: Robot, samples: Samples) -> list[int]:
    """The joints (from 1) whose axes point the other way than in the description.

    The position and the torque of each are reversed; all else is taken to be as described. The
    product of the residuals of all joints has to fall to a half, as the last joints of an arm
    matter for few of them. There are none if the model then leaves a joint unexplained, nor if
    nothing is left as described: of a log without noise, rounding could differ by as much.
    """
    if _tried(robot, samples, Wiring.same(len(robot.joints))).fit.residuals.max() < EXACT:
        return []
    found = _searched(robot, samples, _with_reversed_axes, FALL ** (1.0 / len(robot.joints)))
    if found.fit.residuals.max() > UNEXPLAINED:
        return []
    return [j for j, sign in enumerate(found.wiring.signs[0], start=1) if sign < 0]


def _tried(robot: Robot, samples: Samples, wiring: Wiring) -> Wired:
    return Wired(wiring, fitted(robot, samples.wired(wiring)))


def _searched(
    robot: Robot, samples: Samples, neighbours: Callable[[Wired], list[Wiring]], fall: float
) -> Wired:
    """The wiring that leaves far less of the torques than all that come before it, if there is one.

    `neighbours` are the wirings that are tried from one to the next, and `fall` is what one must
    leave at most of the mean square residual.
    """
    found = _tried(robot, samples, Wiring.same(len(robot.joints)))
    for _ in range(STEPS):
        others = [_tried(robot, samples, wiring) for wiring in neighbours(found)]
        least = min(other.fit.misfit for other in others)
        if least > found.fit.misfit + np.log(fall):
            break
        alike = [other for other in others if other.fit.misfit < least - np.log(fall)]
        found = min(alike, key=lambda other: (len(other.fit.driving), other.fit.misfit))
    return found


def _with_reversed_axes(found: Wired) -> list[Wiring]:
    joints = range(len(found.fit.powers))
    return [found.wiring.reversed(0, j).reversed(1, j) for j in joints]


def _neighbours(found: Wired) -> list[Wiring]:
    """The wirings that are tried next: only reversals if the model explains the torques."""
    others = list(found.wiring.neighbours())
    if found.fit.residuals.max() >= EXPLAINED:
        return others
    return [other for other in others if other.places == found.wiring.places]


def _braking(found: Wired, tried: Callable[[Wiring], Wired]) -> Wired:
    """The wiring with all torques reversed, if friction brakes more joints then.

    Single joints are not reversed for their friction alone: the friction of a joint that hardly has
    a torque may be negative for other reasons.
    """
    if not found.fit.driving:
        return found
    wiring = found.wiring
    for joint in range(len(found.fit.powers)):
        wiring = wiring.reversed(1, joint)
    other = tried(wiring)
    return other if len(other.fit.driving) < len(found.fit.driving) else found


def findings(found: Wired) -> list[Finding]:
    """Findings on the signs of torques and positions, and on the order of the joints."""
    return [_signs(found), _order(found.wiring)]


def _signs(found: Wired) -> Finding:
    positions, torques = ([j for j, s in enumerate(k) if s < 0] for k in found.wiring.signs)
    if len(torques) == len(found.fit.powers) and not positions:
        figure = "the friction of every joint would drive it"
        return failed("signs", figure, "the torques' sign seems reversed: multiply all by -1")
    if torques or positions:
        both = [j for j in torques if j in positions]
        only = [j for j in torques if j not in both], [j for j in positions if j not in both]
        texts = [
            f"the {name} of {joints_text(j + 1 for j in joints)}"
            for name, joints in (
                ("torque", only[0]),
                ("position", only[1]),
                ("position and torque", both),
            )
            if joints
        ]
        figure = f"the model fits far better with {' and '.join(texts)} reversed"
        return failed("signs", figure, f"the sign of {' and '.join(texts)} seems reversed")
    if found.fit.driving:
        figure = f"the friction of {joints_text(j + 1 for j in found.fit.driving)} is negative"
        return warning("signs", figure, "look at the sign of its torque, and at delays")
    return ok("signs", "friction brakes every joint")


def _order(wiring: Wiring) -> Finding:
    texts = []
    for name, places in zip(("positions", "torques"), wiring.places, strict=True):
        moved = [j + 1 for j, place in enumerate(places) if place != j]
        if moved:
            texts.append(f"the {name} of {joints_text(moved)}")
    if not texts:
        return ok("order of joints", "as in the description")
    figure = f"the model fits far better with {' and '.join(texts)} exchanged"
    advice = "the columns seem permuted: name them in the robot's order (`scarid convert --map`)"
    return failed("order of joints", figure, advice)
