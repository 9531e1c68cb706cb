"""Reversed torques and exchanged joints, without knowing the parameters of the robot.

Wirings that differ from the log by a few reversals or exchanges are fitted. One that leaves far
less of the torques unexplained is preferred; of those that explain them alike, one whose friction
brakes. All signs of the torques are tried at once, because motors are mounted either way. A
reversal of all torques changes nothing but the sign of all parameters, and so only the friction
tells it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from scarid_cli.algorithms.changes.wiring import Wiring
from scarid_cli.algorithms.checks.finding import Finding, failed, joints_text, ok, warning
from scarid_cli.algorithms.checks.model import DEVIATIONS, Fit, Samples, fitted, torque_signs
from scarid_cli.algorithms.checks.scale import disagreement
from scarid_cli.algorithms.checks.search import ALIKE, FALL, Explained, searched
from scarid_cli.algorithms.robots.description import Robot

SURE = 30.0  # standard errors of the friction, whose sign decides then
EXPLAINED = 0.002  # of the mean square torque of each joint: exchanged joints leave far more


def wired(robot: Robot, samples: Samples) -> Explained[Wiring]:
    """The wiring that explains the log, which is the log's own unless another is far better."""

    fit_of, logged = partial(_fit, robot, samples), as_logged(robot, samples)
    found = _signed(logged, torque_signs(robot, samples), fit_of)
    braking = _braking(searched(found, fit_of, _neighbours), fit_of)
    return _by_masses(robot, samples, logged, braking)


def signed(robot: Robot, samples: Samples) -> Explained[Wiring]:
    """The same, but only signs of the torques are tried."""
    fit_of = partial(_fit, robot, samples)
    logged = as_logged(robot, samples)
    found = _signed(logged, torque_signs(robot, samples), fit_of)
    return _by_masses(robot, samples, logged, _braking(found, fit_of))


def as_logged(robot: Robot, samples: Samples) -> Explained[Wiring]:
    """The wiring of the log itself."""
    same = Wiring.same(len(robot.joints))
    return Explained(same, _fit(robot, samples, same))


def _fit(robot: Robot, samples: Samples, wiring: Wiring) -> Fit:
    return fitted(robot, samples.wired(wiring))


def _neighbours(found: Explained[Wiring]) -> list[Wiring]:
    """The wirings that are tried next: only reversals if the model explains the torques."""
    others = list(found.case.neighbours())
    if found.fit.residuals.max() >= EXPLAINED:
        return others
    return [other for other in others if other.places == found.case.places]


def _signed(
    found: Explained[Wiring], signs: tuple[int, ...], fit_of: Callable[[Wiring], Fit]
) -> Explained[Wiring]:
    """The wiring with these signs of the torques, if the model explains them better then.

    All of them may be reversed as well: the signs are taken whose friction brakes, or else those
    that reverse fewer.
    """
    if len(set(signs)) == 1:
        return found
    few = sum(sign < 0 for sign in signs) <= len(signs) / 2
    both = [_reversed(found, signs, fit_of), _reversed(found, [-s for s in signs], fit_of)]
    other = min(both if few else both[::-1], key=lambda one: len(one.fit.driving))
    most = found.fit.misfit + np.log(FALL) / len(signs)  # half the residual of one joint
    return other if other.fit.misfit < most else found


def _reversed(
    found: Explained[Wiring], signs: Sequence[int], fit_of: Callable[[Wiring], Fit]
) -> Explained[Wiring]:
    wiring = found.case
    for joint in (j for j, sign in enumerate(signs) if sign < 0):
        wiring = wiring.reversed(1, joint)
    return Explained(wiring, fit_of(wiring))


def _braking(found: Explained[Wiring], fit_of: Callable[[Wiring], Fit]) -> Explained[Wiring]:
    """The wiring with the torques of those joints reversed that friction drives.

    Friction must brake them then, and the model explain the torques alike, as it does if these
    joints hardly move others: the friction of a joint that hardly has a torque may be negative for
    other reasons. Or else all torques are reversed, if friction drives at most half as many then.
    """
    driving = found.fit.driving
    if not driving:
        return found
    joints = range(len(found.fit.powers))
    some = _reversed(found, [-1 if j in driving else 1 for j in joints], fit_of)
    alike = some.fit.misfit < found.fit.misfit + np.log(ALIKE) / len(joints)
    before, after = found.fit.powers[driving], some.fit.powers[driving]
    if np.all(after > DEVIATIONS) and (alike or np.all(np.minimum(-before, after) > SURE)):
        return some
    every = _reversed(found, [-1] * len(joints), fit_of)
    return every if 2 * len(every.fit.driving) <= len(driving) else found


def _by_masses(
    robot: Robot, samples: Samples, logged: Explained[Wiring], found: Explained[Wiring]
) -> Explained[Wiring]:
    """The wiring that was found, unless the described masses speak for another one.

    They tell whether all torques are reversed where friction does not for sure, and they keep the
    log's own wiring if they explain that far better: torques of one joint in another unit look like
    much, too.
    """

    def left(one: Explained[Wiring]) -> float:
        return disagreement(robot, samples.wired(one.case))

    size, powers = left(found), found.fit.powers
    if not np.all(powers > SURE):
        every = _reversed(found, [-1] * len(powers), partial(_fit, robot, samples))
        if (other := left(every)) < size + np.log(FALL):
            found, size = every, other
    return logged if left(logged) < size + np.log(FALL) else found


def findings(found: Explained[Wiring], robot: Robot) -> list[Finding]:
    """Findings on the signs of torques and positions, and on the order of the joints."""
    return [signs(found, robot), _order(found.case)]


def signs(found: Explained[Wiring], robot: Robot) -> Finding:
    """What is found on the signs of torques and positions."""
    positions, torques = ([j for j, s in enumerate(k) if s < 0] for k in found.case.signs)
    command = f"`scarid convert {_turned(found.case, robot)}`"
    if len(torques) == len(found.fit.powers) and not positions:
        figure = (
            "the friction of every joint would drive it"
            if found.fit.brakes
            else "the described masses need the opposite of every torque"
        )
        advice = "the torques' sign seems reversed: multiply all by -1"
        return failed("signs", figure, f"{advice}: {command}")
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
        return failed("signs", figure, f"multiply {' and '.join(texts)} by -1: {command}")
    if found.fit.driving:
        figure = f"the friction of {joints_text(j + 1 for j in found.fit.driving)} is negative"
        return warning("signs", figure, "look at the sign of its torque, and at delays")
    every = "friction brakes every joint" if found.fit.brakes else "no friction drives a joint"
    return ok("signs", every)


def _turned(wiring: Wiring, robot: Robot) -> str:
    """The options of `convert` that multiply by -1 what is reversed."""
    texts = []
    for name, signs in zip(("q", "tau"), wiring.signs, strict=True):
        for j, (sign, joint) in enumerate(zip(signs, robot.joints, strict=True), start=1):
            unit = joint.unit if name == "q" else joint.torque_unit
            texts += [f"--unit '{name}{j}=-1 {unit}'"] if sign < 0 else []
    return " ".join(texts)


def _order(wiring: Wiring) -> Finding:
    texts = []
    for name, places in zip(("positions", "torques"), wiring.places, strict=True):
        moved = [j + 1 for j, place in enumerate(places) if place != j]
        if moved:
            texts.append(f"the {name} of {joints_text(moved)}")
    if not texts:
        return ok("order of joints", "as in the description")
    figure = f"the model fits far better with {' and '.join(texts)} exchanged"
    options = [
        f"--map {name}{j}={name}{place + 1}"
        for name, places in zip(("q", "tau"), wiring.places, strict=True)
        for j, place in enumerate(places, start=1)
        if place + 1 != j
    ]
    advice = f"the columns seem permuted: `scarid convert {' '.join(options)}`"
    return failed("order of joints", figure, advice)
