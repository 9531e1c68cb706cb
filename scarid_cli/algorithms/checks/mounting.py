"""Axes, zeros and gravity that differ from the description, without knowing the parameters.

The zeros of a controller are often a quarter or half turn away from those of a URDF, an axis may
point the other way, and a robot may hang from the ceiling. Each of these is fitted to the log, and
one that leaves far less of the torques unexplained is preferred.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import degrees, pi

import numpy as np

from scarid_cli.algorithms.checks.finding import Finding, failed, joints_text
from scarid_cli.algorithms.checks.model import Fit, Samples, fitted
from scarid_cli.algorithms.checks.scale import disagreement
from scarid_cli.algorithms.checks.search import ALIKE, FALL, Explained, searched
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array

UNEXPLAINED = 0.2  # of the mean square torque of a joint that a model leaves which does not fit
EXACT = 1e-6  # of the mean square of each torque with its mean: 0.1 %, which no sensor shows
TURNED = 0.003  # of the mean square torque of a joint: what a wrong zero or gravity leaves of one
TINY = 1e-300  # (N m)^2
TURNS = (0.5 * pi, -0.5 * pi, pi)  # rad


@dataclass(frozen=True)
class Mounting:
    """How a robot differs from its description.

    `signs` (joints) are -1 for an axis that points the other way. `turns` (joints) [rad] are the
    positions of the joints where the log has 0. `gravity` [m/s2] is None if it is as described.
    """

    signs: tuple[float, ...]
    turns: tuple[float, ...]
    gravity: tuple[float, ...] | None = None

    @classmethod
    def described(cls, joints: int) -> Mounting:
        return cls((1.0,) * joints, (0.0,) * joints)

    def of(self, robot: Robot) -> Robot:
        """The robot in this gravity."""
        if not (self.gravity and robot.body):
            return robot
        return replace(robot, body=replace(robot.body, gravity=self.gravity))

    def seen(self, samples: Samples) -> Samples:
        """The samples as a robot that is mounted as described would have logged them."""
        motion = samples.motion * np.array(self.signs)[:, None]
        motion[0] += np.array(self.turns)[:, None]
        return replace(samples, motion=motion)

    def fitted(self, robot: Robot, samples: Samples, *, cables: bool = False) -> Fit:
        """The fit of a log of a robot that is mounted so."""
        return fitted(self.of(robot), self.seen(samples), cables=cables)

    def disagreement(self, robot: Robot, samples: Samples) -> float:
        """How little of the torques the described masses explain if it is mounted so."""
        return disagreement(self.of(robot), self.seen(samples))

    def reversed(self) -> Iterator[Mounting]:
        """One axis more, or less, points the other way."""
        for joint, sign in enumerate(self.signs):
            yield replace(self, signs=_with(self.signs, joint, -sign))

    def turned(self, robot: Robot) -> Iterator[Mounting]:
        """A joint has another zero, or gravity acts along another axis of the base, or not."""
        for joint, one in enumerate(robot.joints):
            if one.unit == "rad":
                for turn in TURNS:
                    yield replace(self, turns=_with(self.turns, joint, turn))
        if robot.body and any(robot.body.gravity):
            size = float(np.linalg.norm(robot.body.gravity))
            yield replace(self, gravity=(0.0, 0.0, 0.0))
            for axis in range(3):
                for along in (size, -size):
                    yield replace(self, gravity=_with((0.0, 0.0, 0.0), axis, along))

    def folded(self, robot: Robot) -> Iterator[Mounting]:
        """Two neighbouring joints are a quarter turn off, in opposite directions.

        As where an upper arm is upright at 0, and level in the description, and the forearm is
        level in both.
        """
        for joint, pair in enumerate(pairwise(robot.joints)):
            if all(one.unit == "rad" for one in pair):
                for turn in (0.5 * pi, -0.5 * pi):
                    turns = _with(_with(self.turns, joint, turn), joint + 1, -turn)
                    yield replace(self, turns=turns)


def _with(values: tuple[float, ...], place: int, value: float) -> tuple[float, ...]:
    return (*values[:place], value, *values[place + 1 :])


def mounted(robot: Robot, samples: Samples) -> Explained[Mounting]:
    """How the robot is mounted: as described, unless the model fits far better otherwise.

    For an axis, the product of the residuals of all joints has to fall to a half, as the last
    joints of an arm matter for few of them. Another zero or gravity changes the torques of many
    joints, and must halve each residual on average. It is tried where the model leaves what a wrong
    one would leave. The robot is as described if all else leaves a joint unexplained, too, and if
    nothing is left as described: of a log without noise, rounding could differ by as much.
    """
    joints = len(robot.joints)

    def fit_of(case: Mounting) -> Fit:
        return case.fitted(robot, samples)

    def reversed_axes(found: Explained[Mounting]) -> list[Mounting]:
        return list(found.case.reversed())

    def turned(found: Explained[Mounting]) -> list[Mounting]:
        return [*found.case.reversed(), *found.case.turned(robot)]

    def folded(found: Explained[Mounting]) -> list[Mounting]:
        return [*turned(found), *found.case.folded(robot)]

    described = Mounting.described(joints)
    as_described = Explained(described, fit_of(described))
    left = as_described.fit.residuals.max()
    if np.max(as_described.fit.residuals * _varying(samples)) < EXACT:
        return as_described
    one_joint = FALL ** (1.0 / joints)  # half the residual of one joint
    found = searched(as_described, fit_of, reversed_axes, one_joint)
    if found.case != described and not _beside_cables(found.case, robot, samples, one_joint):
        found = as_described
    if left > TURNED:
        other = searched(as_described, fit_of, turned)
        found = min(found, other, key=lambda one: one.fit.misfit)
    if found.fit.residuals.max() > TURNED:
        other = searched(as_described, fit_of, folded)
        found = other if other.fit.misfit < found.fit.misfit + np.log(FALL) else found
    if found.case.gravity:
        none = replace(found.case, gravity=(0.0, 0.0, 0.0))
        without = Explained(none, fit_of(none))
        found = without if without.fit.misfit < found.fit.misfit + alike(robot) else found
    return as_described if found.fit.residuals.max() > UNEXPLAINED else found


def _beside_cables(case: Mounting, robot: Robot, samples: Samples, fall: float) -> bool:
    """Whether the model fits as much better with these axes where cables are fitted, too.

    What a cable does that the model lacks may look like the torques of another axis.
    """
    plain = Mounting.described(len(robot.joints)).fitted(robot, samples, cables=True)
    other = case.fitted(robot, samples, cables=True)
    return bool(other.misfit < plain.misfit + np.log(fall))


def _varying(samples: Samples) -> Array:
    """The share of the mean square of each torque (joints) that is its variance."""
    rows = [tau[counts] for tau, counts in zip(samples.motion[3], samples.counts, strict=True)]
    return np.array([x.var() / max(np.mean(x**2), TINY) if len(x) else 0.0 for x in rows])


def by_masses(
    robot: Robot, samples: Samples, found: Explained[Mounting], left: float
) -> Explained[Mounting]:
    """Of the mountings that explain the torques alike, the one that the described masses explain.

    A zero of the last joint, or a half turn of a wrist, often changes no more than the masses that
    are estimated. What was `found` stays unless the masses leave far less of the torques otherwise,
    and far less than they do in another explanation (`left`, a disagreement).
    """
    if np.isnan(left) or found.fit.residuals.max() > UNEXPLAINED:
        return found
    most = found.fit.misfit + alike(robot)
    cases = Mounting.described(len(robot.joints)).turned(robot)
    ties = [one for one in (Explained(c, c.fitted(robot, samples)) for c in cases)
            if one.fit.misfit < most]  # fmt: skip
    if not ties:
        return found
    left = min(left, found.case.disagreement(robot, samples))
    sizes = [one.case.disagreement(robot, samples) for one in ties]
    best = int(np.argmin(sizes))
    return ties[best] if sizes[best] < left + np.log(FALL) else found


def alike(robot: Robot) -> float:
    """By how much the misfits of fits differ at most that explain the torques alike."""
    return float(np.log(ALIKE)) / len(robot.joints)


def _gravity(gravity: tuple[float, ...], what: str) -> Finding:
    if any(gravity):
        vector = ", ".join(f"{x:.3g}" for x in gravity)
        figure = f"{what} far better with gravity = [{vector}] in the frame of the base"
        advice = "is the base on a wall or a ceiling?"
    else:
        figure = f"{what} far better without gravity"
        advice = (
            "are these commands, to which the controller adds the torque of gravity? log what was "
            "measured. Or are all axes vertical?"
        )
    return failed("gravity", figure, f"{advice} State gravity in the TOML file of the robot")


def findings(mounting: Mounting, what: str = "the model fits") -> list[Finding]:
    """What differs from the description; none if nothing does."""
    better, found = f"{what} far better with", []
    if axes := [j for j, sign in enumerate(mounting.signs, start=1) if sign < 0]:
        figure = f"{better} the position and the torque of {joints_text(axes)} reversed"
        advice = "does the axis point the other way than in the description?"
        found.append(failed("axes", figure, advice))
    turned = [(j, degrees(turn)) for j, turn in enumerate(mounting.turns, start=1) if turn]
    if turned:
        zeros = " and ".join(f"joint {j} at {turn:.0f} degrees" for j, turn in turned)
        figure = f"{better} {zeros} where the log has a position of 0"
        advice = (
            "is this its zero? state it as `zero` [rad] in the TOML file of the robot, with which "
            "`scarid convert --robot FILE.toml` mends the log"
        )
        found.append(failed("zeros", figure, advice))
    if mounting.gravity:
        found.append(_gravity(mounting.gravity, what))
    return found
