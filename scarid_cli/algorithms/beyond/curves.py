"""What law a curve of friction over the speed follows: it falls, or is a power of the speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.terms import AxisTerm
from scarid_cli.arrays import Array

if TYPE_CHECKING:
    from scarid_cli.algorithms.beyond.additions import Addition

RANGE = (0.05, 2.0)  # of the usual speed, where a log shows friction
SPEEDS = 100
POWERS = np.arange(0.1, 4.05, 0.05)
FALLS = 0.02  # of the largest friction: a smaller fall is none
LIKE_VISCOUS = (0.9, 1.1)  # a power of which no law can be told
REMEDIES = {
    "falls": ("decreases with speed", "add Stribeck friction with --estimator separable"),
    "faster": ("grows faster than the speed, as its square does",
               "add the term quadratic to the robot"),
    "slower": ("grows more slowly than the speed, as a root of it does",
               "there is no term for it"),
    "": ("bends with the speed", "try Stribeck friction with --estimator separable"),
}  # fmt: skip


def laws(
    additions: Sequence[Addition],
    decayed: Mapping[str, float],
    estimates: Mapping[str, float],
    robot: Robot,
) -> str:
    """`it grows faster than the speed, as its square does, at joint 1 (...)`, by joints.

    The additions are those of friction's curve, of which each has `decayed` at a part of the usual
    speed.
    """
    found: dict[tuple[str, str], list[int]] = {}
    for joint in sorted({addition.joint for addition in additions}):
        own = [addition for addition in additions if addition.joint == joint]
        speeds = np.linspace(*RANGE, SPEEDS) * own[0].usual
        text, remedy = law(speeds, curve(own, decayed, estimates, robot, speeds))
        found.setdefault((text, remedy), []).append(joint + 1)
    return ", ".join(
        f"it {text} at joint{'s' if len(joints) > 1 else ''} "
        f"{' and '.join(map(str, joints))} ({remedy})"
        for (text, remedy), joints in found.items()
    )


def curve(
    additions: Sequence[Addition],
    decayed: Mapping[str, float],
    estimates: Mapping[str, float],
    robot: Robot,
    speeds: Array,
) -> Array:
    """The friction of a joint at these speeds: the terms of its model and the additions [N m, N].

    It is the mean of both directions, without an offset.
    """
    total = np.zeros_like(speeds)
    for parameter in robot.parameters:
        term = parameter.term
        if isinstance(term, AxisTerm) and term.joint == additions[0].joint + 1:
            both = term.torque(speeds) - term.torque(-speeds) if term.NAME != "mass" else 0.0
            total += 0.5 * estimates.get(parameter.name, 0.0) * both
    for addition in additions:
        scale = decayed[addition.name] * addition.usual
        total += addition.size * np.exp(-((speeds / scale) ** 2))
    return total


def law(speeds: Array, friction: Array) -> tuple[str, str]:
    """What the friction (speeds) does as the speed grows, and the remedy."""
    size = float(np.max(np.abs(friction)))
    if friction[0] - friction.min() > FALLS * size:
        return REMEDIES["falls"]
    power, (lower, upper) = _power(speeds, friction), LIKE_VISCOUS
    kind = "slower" if power < lower else "faster" if power > upper else ""
    return REMEDIES[kind]


def _power(speeds: Array, friction: Array) -> float:
    """The p with which a + c v^p is nearest to the friction; a is not negative."""
    rests = []
    for power in POWERS:
        grows = (speeds / speeds[-1]) ** power
        W = np.column_stack((np.ones_like(grows), grows))
        found = np.linalg.lstsq(W, friction, rcond=None)[0]
        if found[0] < 0.0:
            found = np.array([0.0, grows @ friction / (grows @ grows)])
        rests.append(float(np.linalg.norm(friction - W @ found)))
    return float(POWERS[int(np.argmin(rests))])
