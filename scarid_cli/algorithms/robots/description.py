"""A robot as the commands see it: joints, parameters with their a priori values, regressor."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from scarid_cli.algorithms.robots.terms import PLANAR_JOINTS, PLANAR_TERMS, TERMS
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

FOLDER = Path(__file__).parent
DEFAULT = "scara2"
UNITS = {"revolute": ("rad", "N m"), "prismatic": ("m", "N")}


@dataclass(frozen=True)
class Joint:
    """One joint: limits in its own units (rad or m, N m or N); infinite where not given."""

    type: str
    position_limit: float = inf
    velocity_limit: float = inf
    acceleration_limit: float = inf
    torque_limit: float = inf
    encoder_resolution: float = 0.0
    torque_noise: float = 0.0

    @property
    def unit(self) -> str:
        """Of the position."""
        return UNITS[self.type][0]

    @property
    def torque_unit(self) -> str:
        return UNITS[self.type][1]


@dataclass(frozen=True)
class Parameter:
    """One base parameter: its term of the regressor, the joint (from 1) of a friction term."""

    name: str
    term: str
    unit: str
    apriori: float
    joint: int = 0


@dataclass(frozen=True)
class Control:
    """Gains per joint of eq. 29 [N m/rad, N m s/rad, N m/(rad s)]; smoothing of dq [Hz]."""

    kp: tuple[float, ...]
    kd: tuple[float, ...]
    ki: tuple[float, ...]
    velocity_cutoff: float


@dataclass(frozen=True)
class Robot:
    """A robot whose torques are linear in its parameters: tau = W(q, dq, ddq) theta (eq. 3)."""

    name: str
    title: str
    joints: tuple[Joint, ...]
    parameters: tuple[Parameter, ...]
    control: Control | None

    @property
    def names(self) -> list[str]:
        return [parameter.name for parameter in self.parameters]

    @property
    def apriori(self) -> Array:
        """A priori values, in the order of the parameters."""
        return np.array([parameter.apriori for parameter in self.parameters])

    def value(self, term: str, joint: int = 0) -> float:
        """The a priori value of a term; 0 if the robot has no such parameter."""
        found = (p.apriori for p in self.parameters if (p.term, p.joint) == (term, joint))
        return next(found, 0.0)

    def regressor(self, q: Array, dq: Array, ddq: Array) -> Array:
        """W (samples, joints, parameters) from motions (joints, samples); sources in terms.py."""
        joints, samples = q.shape
        W = np.zeros((samples, joints, len(self.parameters)))
        for index, parameter in enumerate(self.parameters):
            column = TERMS[parameter.term](q, dq, ddq, parameter.joint - 1)
            for joint, values in column.items():
                W[:, joint, index] = values
        return W

    def torques(self, W: Array, theta: Array) -> Array:
        """W theta as (joints, samples), summed in the order of the parameters.

        A matrix product would round differently with the number of rows in a batch.
        """
        total = W[:, :, 0] * theta[0]
        for index in range(1, len(theta)):
            total += W[:, :, index] * theta[index]
        return np.ascontiguousarray(total.T)


def built_in() -> list[str]:
    """The names of the robots that come with the package."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load(name: str) -> Robot:
    """A built-in robot by name, or one described in a TOML file."""
    path = Path(name) if name.endswith(".toml") else FOLDER / f"{name}.toml"
    if not path.is_file():
        raise UsageFault(f"unknown robot {name!r}; choose {', '.join(built_in())}, or a .toml file")
    try:
        return _robot(name, tomllib.loads(path.read_text("utf-8")))
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise UsageFault(f"{name}: not a robot description: {_reason(error)}") from None


def _robot(name: str, document: dict[str, Any]) -> Robot:
    joints = tuple(Joint(**_numbers(joint, "type")) for joint in document["joint"])
    parameters = tuple(
        Parameter(**_numbers(parameter, "name", "term", "unit"))
        for parameter in document["parameter"]
    )
    for joint in joints:
        if joint.type not in UNITS:
            raise UsageFault(f"{name}: joint type {joint.type!r}; choose {' or '.join(UNITS)}")
    for p in parameters:
        if p.term not in TERMS:
            raise UsageFault(f"{name}: {p.name} has term {p.term!r}; choose {', '.join(TERMS)}")
        if len(joints) < PLANAR_JOINTS and p.term in PLANAR_TERMS:
            raise UsageFault(
                f"{name}: {p.name} has term {p.term}, which needs {PLANAR_JOINTS} joints"
            )
        first = 0 if p.term in PLANAR_TERMS else 1
        if not first <= p.joint <= len(joints):
            raise UsageFault(f"{name}: {p.name} is on joint {p.joint} of {len(joints)}")
    control = document.get("control")
    return Robot(
        name=name,
        title=document["title"],
        joints=joints,
        parameters=parameters,
        control=_control(control, len(joints)) if control else None,
    )


def _numbers(entry: dict[str, Any], *texts: str) -> dict[str, Any]:
    """The entry, all of whose values but those of `texts` must be numbers."""
    for key, value in entry.items():
        if key not in texts and not isinstance(value, int | float):
            raise TypeError(f"{key} is {value!r}, not a number")
    return entry


def _control(gains: dict[str, Any], joints: int) -> Control:
    rows = {key: tuple(gains[key]) for key in ("kp", "kd", "ki")}
    for key, row in rows.items():
        if len(row) != joints:
            raise TypeError(f"{key} has {len(row)} values for {joints} joints")
    return Control(**rows, velocity_cutoff=gains["velocity_cutoff"])


def _reason(error: Exception) -> str:
    return f"missing {error}" if isinstance(error, KeyError) else str(error)
