"""Reversed torques and exchanged joints, without knowing the parameters of the robot.

Wirings that differ from the log by a few reversals or exchanges are fitted. One that leaves far
less of the torques unexplained is preferred; of those that explain them alike, one whose friction
brakes. A reversal of all torques changes nothing but the sign of all parameters, and so only the
friction tells it.
"""

from __future__ import annotations

from collections.abc import Callable

from scarid_cli.algorithms.changes.wiring import Wiring
from scarid_cli.algorithms.checks.finding import Finding, failed, joints_text, ok, warning
from scarid_cli.algorithms.checks.model import Fit, Samples, fitted
from scarid_cli.algorithms.checks.search import Explained, searched
from scarid_cli.algorithms.robots.description import Robot

EXPLAINED = 0.02  # of the mean square torque of each joint: exchanged joints leave far more


def wired(robot: Robot, samples: Samples) -> Explained[Wiring]:
    """The wiring that explains the log, which is the log's own unless another is far better."""

    def fit_of(wiring: Wiring) -> Fit:
        return fitted(robot, samples.wired(wiring))

    same = Wiring.same(len(robot.joints))
    return _braking(searched(Explained(same, fit_of(same)), fit_of, _neighbours), fit_of)


def _neighbours(found: Explained[Wiring]) -> list[Wiring]:
    """The wirings that are tried next: only reversals if the model explains the torques."""
    others = list(found.case.neighbours())
    if found.fit.residuals.max() >= EXPLAINED:
        return others
    return [other for other in others if other.places == found.case.places]


def _braking(found: Explained[Wiring], fit_of: Callable[[Wiring], Fit]) -> Explained[Wiring]:
    """The wiring with all torques reversed, if friction brakes more joints then.

    Single joints are not reversed for their friction alone: the friction of a joint that hardly has
    a torque may be negative for other reasons.
    """
    if not found.fit.driving:
        return found
    wiring = found.case
    for joint in range(len(found.fit.powers)):
        wiring = wiring.reversed(1, joint)
    other = Explained(wiring, fit_of(wiring))
    return other if len(other.fit.driving) < len(found.fit.driving) else found


def findings(found: Explained[Wiring]) -> list[Finding]:
    """Findings on the signs of torques and positions, and on the order of the joints."""
    return [_signs(found), _order(found.case)]


def _signs(found: Explained[Wiring]) -> Finding:
    positions, torques = ([j for j, s in enumerate(k) if s < 0] for k in found.case.signs)
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
