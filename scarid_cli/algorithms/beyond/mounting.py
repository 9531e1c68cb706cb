"""Entries for how the robot stands and is built: the direction of gravity, the distances."""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.beyond.distances import distance_columns
from scarid_cli.algorithms.beyond.model import tilted
from scarid_cli.algorithms.beyond.phenomenon import Fitted, Found, OfTorques
from scarid_cli.algorithms.beyond.signals import Signals
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.interval import plus_minus
from scarid_cli.words import listed


class Tilt(OfTorques):
    """A base that leans, so that gravity acts in another direction than described.

    It has columns of the whole robot: two directions, and two of the first moments of link 1.
    """

    NAME = "tilt"
    UNIT = "rad"
    LACKS = "gravity acts in another direction than described, as on a tilted base{gravity}"
    CHANGE = "tilt"
    FITTED = RELATIVE = COMPARED = True
    FIRST = 2  # a short log tells a tilt better than what else it makes of joint 1

    @classmethod
    def columns(cls, x: Signals) -> Array | None:
        return x.model.leaning(x.motion[0], x.theta, np.zeros(cls.FIRST)) if x.model else None

    @classmethod
    def facts(cls, found: Found) -> dict[str, str]:
        return {"gravity": _gravity(found.robot, found.amounts[: cls.FIRST])}

    @classmethod
    def added(cls, fitted: Fitted) -> str:
        """The gravity of a base whose tilt was fitted, and by how much it is tilted."""
        amounts, errors = np.zeros(cls.FIRST), np.zeros(cls.FIRST)
        for x in fitted.own:
            if x.joint < cls.FIRST:  # the directions; the rest is of the first moments of link 1
                amounts[x.joint], errors[x.joint] = x.size, x.error
        sine = float(np.linalg.norm(amounts))
        error = float(np.degrees(np.linalg.norm(amounts * errors))) / max(sine, 1e-300)
        degrees = f"{np.degrees(np.arcsin(min(sine, 1.0))):.2g} {plus_minus(error)} deg"
        gravity = _gravity(fitted.robot, amounts)
        return f"{cls.LACKS.format(gravity=gravity)}; a tilt by {degrees} was fitted as well"


class Geometry(OfTorques):
    """Distances between the axes that are not as described."""

    NAME = "geometry"
    UNIT = "of the distance"
    LACKS = (
        "the geometry is not as described: {distances} (correct the URDF, from which exported "
        "models have it)"
    )
    RANGE = (-1.0, 1.0)  # a distance of less than nothing, or twice what it is, has another cause

    @classmethod
    def columns(cls, x: Signals) -> Array | None:
        return distance_columns(x.model, x.theta, x.motion) if x.model else None

    @classmethod
    def facts(cls, found: Found) -> dict[str, str]:
        return {"distances": listed([_distance(found, j) for j in found.joints])}


def _distance(found: Found, joint: int) -> str:
    """`the distance from axis 1 to axis 2 is 1 +- 0.1 % larger`."""
    amount, error = 100.0 * found.amounts[joint], 100.0 * found.noise[joint]
    size = f"{abs(amount):.2g} {plus_minus(error)} % {'larger' if amount > 0.0 else 'smaller'}"
    return f"the distance from axis {joint} to axis {joint + 1} is {size}"


def _gravity(robot: Robot, sines: Array) -> str:
    """What to state of a base that leans by angles of these sines."""
    assert robot.body
    described = _vector(np.array(robot.body.gravity))
    gravity = _vector(tilted(np.array(robot.body.gravity), sines))
    if gravity == described:  # the log shows that it leans, and not where to
        return ""
    return f" (state gravity = {gravity} in the TOML file of the robot)"


def _vector(values: Array) -> str:
    """`[0.49, 0, -9.8]`, with what is less than a thousandth of the largest as 0."""
    least = 1e-3 * float(np.max(np.abs(values)))
    return f"[{', '.join(f'{x:.3g}' if abs(x) > least else '0' for x in values.tolist())}]"
