"""What the axes of an arm have beside rigid bodies, in the terms of simulators and URDFs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.robots.coupled import CoupledTerm
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array

JUMPS = (("fs", "+"), ("fs", "-"), ("off", ""))  # what makes the constant torque of a drive
COUPLED = {"Iam": "inertia", "fvm": "viscous", "fsm": "coulomb"}  # symbols of coupled.py


@dataclass(frozen=True)
class Drive:
    """The motor and the friction of one axis.

    `joint` is its name in the URDF. `inertia` of the motor as the joint feels it [kg m2 or kg];
    `viscous` [N m s/rad or N s/m] and `coulomb` [N m or N] friction, the mean of both directions;
    `constant` is the torque that is there beside these: the offset, and half of what Coulomb
    friction has more forward than backward. `gear` is the ratio of motor to joint.
    """

    joint: str
    inertia: float = 0.0
    viscous: float = 0.0
    coulomb: float = 0.0
    constant: float = 0.0
    gear: float = 1.0


@dataclass(frozen=True)
class Coupling:
    """A motor that turns with two axes (from 0): `ratio` times with `one`, once with `two`.

    In place of the torques of coupled.py, which act between the axes alone, its numbers are those
    of the whole motor: what it does at each axis alone is less there.
    """

    one: int
    two: int
    ratio: float
    inertia: float = 0.0
    viscous: float = 0.0
    coulomb: float = 0.0


@dataclass(frozen=True)
class Drives:
    """The drives of all axes, the motors that couple two, and what neither can hold, by name."""

    axes: tuple[Drive, ...]
    couplings: tuple[Coupling, ...]
    rest: dict[str, float]
    ratios: Array  # (axes, axes): the matrix R of logs.py

    def not_in_urdf(self, axes: Mapping[str, float]) -> dict[str, float]:
        """The parameters that a URDF cannot hold as they are; those of 0 are not told."""
        constant = {i for i, x in enumerate(self.axes, start=1) if x.constant}
        torques = {f"{name}{i}{d}" for i in constant for name, d in JUMPS}
        coupled = {f"{s}{c.two + 1}" for c in self.couplings for s in COUPLED}
        lost = torques | coupled | set(self.rest)
        return {name: x for name, x in axes.items() if name in lost and x}

    @property
    def uncoupled(self) -> list[tuple[float, float]]:
        """Inertia and viscous friction of each axis beside those of the coupling motors."""
        own = np.array([[x.inertia, x.viscous] for x in self.axes])
        for c in self.couplings:
            own[c.one] -= c.ratio**2 * np.array([c.inertia, c.viscous])
            own[c.two] -= c.inertia, c.viscous
        return [(float(a), float(b)) for a, b in own]


def drives(robot: Robot, axes: Mapping[str, float]) -> Drives:
    """The drives of a robot with a URDF, from the parameters of its axes by name (`fv1`, ...)."""
    assert robot.body
    names = robot.body.joint_names
    ratios = np.array(robot.log.ratios) if robot.log else np.eye(len(names))
    gears = np.diag(ratios)
    found = [_drive(name, i, axes, float(gears[i - 1])) for i, name in enumerate(names, start=1)]
    couplings, coupled = _couplings(robot, axes)
    held = coupled | {
        f"{s}{i}" for i in range(1, len(names) + 1) for s in ("Ia", "fv", "fs", "off")
    }
    held |= {f"fs{i}{d}" for i in range(1, len(names) + 1) for d in "+-"}
    for i in range(1, len(names) + 1):
        both = {f"fv{i}+", f"fv{i}-"}
        if len({axes.get(name, 0.0) for name in both}) == 1:
            held |= both
    rest = {name: x for name, x in axes.items() if name not in held}
    return Drives(tuple(found), couplings, rest, ratios)


def _drive(name: str, i: int, axes: Mapping[str, float], gear: float) -> Drive:
    def value(symbol: str) -> float:
        return axes.get(symbol, 0.0)

    forward, backward = value(f"fs{i}+"), value(f"fs{i}-")
    return Drive(
        name,
        value(f"Ia{i}"),
        value(f"fv{i}") + 0.5 * (value(f"fv{i}+") + value(f"fv{i}-")),
        value(f"fs{i}") + 0.5 * (forward + backward),
        value(f"off{i}") + 0.5 * (forward - backward),
        gear,
    )


def _couplings(robot: Robot, axes: Mapping[str, float]) -> tuple[tuple[Coupling, ...], set[str]]:
    """The coupling motors, and the names of the parameters that they hold.

    Their inertia may be part of another base parameter; their friction never is.
    """
    terms = [p.term for p in robot.parameters if isinstance(p.term, CoupledTerm)]
    pairs = dict.fromkeys((term.joint, term.other, term.ratio) for term in terms)
    found = tuple(
        Coupling(
            one - 1,
            two - 1,
            ratio,
            **{key: axes.get(f"{symbol}{two}", 0.0) for symbol, key in COUPLED.items()},
        )
        for one, two, ratio in pairs
    )
    return found, {f"{symbol}{two}" for _, two, _ in pairs for symbol in COUPLED}
