"""The joints of a robot description, with their limits."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import inf
from typing import Any

from scarid_cli.algorithms.keys import values
from scarid_cli.algorithms.robots.logs import AXIS

JOINT_UNITS = {"revolute": ("rad", "N m"), "prismatic": ("m", "N")}


@dataclass(frozen=True)
class Joint:
    """One joint; quantities are in its own units (rad or m, N m or N).

    The position may lie anywhere from `lower` to `upper`; velocity, acceleration and torque are
    limited in magnitude. A limit that the description does not give is infinite.
    """

    type: str
    lower: float = -inf
    upper: float = inf
    velocity_limit: float = inf
    acceleration_limit: float = inf
    torque_limit: float = inf
    encoder_resolution: float = 0.0
    torque_noise: float = 0.0

    @property
    def unit(self) -> str:
        """The unit of the position."""
        return JOINT_UNITS[self.type][0]

    @property
    def torque_unit(self) -> str:
        """The unit of the torque or force."""
        return JOINT_UNITS[self.type][1]


# The keys of [[joint]] whose values are numbers.
NUMERIC_KEYS = [f.name for f in fields(Joint) if f.name not in ("type", "lower", "upper")]


def joint_of(entry: dict[str, Any], known: Joint | None = None) -> Joint:
    """The joint of a [[joint]] table; what the table does not give is taken from `known`."""
    values.only("[[joint]]", entry, ("type", "position_limit", *NUMERIC_KEYS, *AXIS))
    kind = values.choice("joint type", entry["type"], JOINT_UNITS)
    numbers = {key: values.number(key, entry[key]) for key in NUMERIC_KEYS if key in entry}
    for key, value in numbers.items():
        if value < 0.0:
            raise ValueError(f"{key} is negative")
    if "position_limit" in entry:
        numbers["lower"], numbers["upper"] = _interval(entry["position_limit"])
    otherwise = {**vars(known)} if known else {}
    return Joint(**{**otherwise, "type": kind, **numbers})


def _interval(value: Any) -> tuple[float, float]:
    """`1.2` stands for -1.2 to 1.2; `[-3.07, -0.07]` gives both ends."""
    if not isinstance(value, list):
        reach = values.number("position_limit", value)
        if reach < 0.0:
            raise ValueError("position_limit is negative")
        return -reach, reach
    lower, upper = values.row("position_limit", value, 2)
    if lower > upper:
        raise ValueError(f"position_limit {value}: the lower end is above the upper one")
    return lower, upper
