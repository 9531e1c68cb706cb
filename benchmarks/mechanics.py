"""Conditions of mechanics that the model of a rigid robot does not have, for `gauntlet --unseen`.

Torques are changed along the motion of the simulated robot: the motion is the one that takes them,
so that the log is that of a robot with this friction, cable or gear. Link lengths, tilts and
payloads change the simulated robot itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from altered import Change, Recorded, coulomb

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.planar import MX2
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

ARM, HALF = 0.2, 10.0  # m; s
JOINT = 1  # the second one: whose torque, encoder or gear is not as described


def velocity(log: Recorded) -> Array:
    """The velocities (joints, samples), smoothed over five samples."""
    t, q, _ = log
    kernel = np.ones(5) / 5.0
    return np.array([np.convolve(np.gradient(row, t), kernel, "same") for row in q])


def gained(factor: float, _: Robot, log: Recorded) -> Recorded:
    """The torque of a joint in another unit, or with another motor constant."""
    t, q, tau = log
    tau = tau.copy()
    tau[JOINT] *= factor
    return t, q, tau


def loose(degrees: float, robot: Robot, log: Recorded) -> Recorded:
    """Backlash: the encoder is ahead of the link in the direction of the torque in the gear.

    That is the torque of the motor without the friction, which is on its side.
    """
    t, q, tau = log
    speed = velocity(log)
    viscous = np.array([[robot.value("viscous", i)] for i in range(1, len(q) + 1)])
    carried = tau - viscous * speed - coulomb(robot) * np.sign(speed)
    return t, q + 0.5 * np.radians(degrees) * np.sign(carried), tau


def play(x: Array, half: Array) -> Array:
    """The play operator (joints, samples): follows x at a distance of at most `half` (joints)."""
    found = np.empty_like(x)
    now = x[:, 0].copy()
    for k in range(x.shape[1]):
        now = np.clip(now, x[:, k] - half, x[:, k] + half)
        found[:, k] = now
    return found


def hysteresis(share: float, _: Robot, log: Recorded) -> Recorded:
    """The torque sensor follows with a hysteresis that is a share of the largest torque."""
    t, q, tau = log
    return t, q, play(tau, share * np.abs(tau).max(axis=1))


def slipping(radians: float, robot: Robot, log: Recorded) -> Recorded:
    """Coulomb friction builds up over a distance (one Maxwell slip element)."""
    t, q, tau = log
    stretched = (q - play(q, np.full(len(q), 0.5 * radians))) / (0.5 * radians)
    return t, q, tau + coulomb(robot) * (stretched - np.sign(velocity(log)))


def uneven(share: float, robot: Robot, log: Recorded) -> Recorded:
    """Coulomb friction varies over a turn."""
    t, q, tau = log
    varies = share * np.sin(q + np.arange(len(q))[:, None])
    return t, q, tau + coulomb(robot) * varies * np.sign(velocity(log))


def cubic(share: float, robot: Robot, log: Recorded) -> Recorded:
    """A cable pulls with the cube of the position, at 1 rad with this part of the friction."""
    t, q, tau = log
    return t, q, tau + share * coulomb(robot) * q**3


def late(seconds: float, _: Robot, log: Recorded) -> Recorded:
    """The position of a joint is that of a time ago."""
    t, q, tau = log
    q = q.copy()
    q[JOINT] = np.interp(t - seconds, t, q[JOINT])
    return t, q, tau


def late_torque(seconds: float, _: Robot, log: Recorded) -> Recorded:
    """The torque of a joint is that of a time ago."""
    t, q, tau = log
    tau = tau.copy()
    tau[JOINT] = np.interp(t - seconds, t, tau[JOINT])
    return t, q, tau


def one_flexible(frequency: float, robot: Robot) -> dict[str, tuple[float, ...]]:
    """A gear of a joint is elastic: its frequency [Hz], with the motor locked."""
    return {"flexibility": tuple(frequency * (j == JOINT) for j in range(len(robot.joints)))}


def geared(robot: Robot, inertia: float) -> Robot:
    """The robot whose second motor has an inertia [kg m2] of its own."""
    (mass,) = (p for p in load("emps").parameters if p.term.NAME == "mass")
    own = replace(mass, name="Ia2", unit="kg m2", apriori=inertia)
    own = replace(own, term=replace(mass.term, joint=JOINT + 1))
    return replace(robot, name=f"{robot.name}-geared", parameters=(*robot.parameters, own))


def longer(factor: float, robot: Robot) -> Robot:
    """The robot whose first link is longer, with the same masses on it."""
    parameters = [
        replace(p, term=replace(p.term, length=factor * p.term.length))
        if isinstance(p.term, MX2)
        else p
        for p in robot.parameters
    ]
    return replace(robot, parameters=tuple(parameters))


def picked_up(share: float, robot: Robot) -> dict[str, tuple[float, ...]]:
    """A payload from half of the log on, with this share of the inertia of link 2."""
    mass = share * next(p.apriori for p in robot.parameters if p.name == "ZZ2") / ARM**2
    return {"payload": (mass, ARM, *[0.0] * 8, HALF)}


CHANGES: dict[str, Change] = {
    **{f"gain of joint 2 {x:g}": partial(gained, x) for x in (0.74, 1.02, 1.05, 1.1, 1.36)},
    **{f"backlash {x:g} deg": partial(loose, x) for x in (0.05, 0.2)},
    **{f"torque hysteresis {100 * x:g} %": partial(hysteresis, x) for x in (0.005, 0.02)},
    **{f"Maxwell slip {1e3 * x:g} mrad": partial(slipping, x) for x in (0.02, 0.06)},
    "Coulomb friction over the position 30 %": partial(uneven, 0.3),
    **{f"position of joint 2 late {1e3 * x:g} ms": partial(late, x) for x in (0.004, 0.01)},
    **{f"torque of joint 2 late {1e3 * x:g} ms": partial(late_torque, x) for x in (0.004, 0.01)},
}
BUILT: dict[str, Callable[[Robot], Robot]] = {"link length +1 %": partial(longer, 1.01)}
FREQUENCIES = (5.0, 8.0, 12.0, 20.0)  # Hz, of a gear
LOADED = {f"payload of {100 * x:g} % in mid-log": partial(picked_up, x) for x in (0.05, 0.2)}
