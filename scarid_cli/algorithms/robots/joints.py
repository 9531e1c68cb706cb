"""The joints of a description."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import inf
from typing import Any

from scarid_cli.algorithms.robots import values
from scarid_cli.algorithms.robots.logs import AXIS

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


NUMBERS = tuple(field.name for field in fields(Joint) if field.name != "type")


def joint_of(entry: dict[str, Any], known: Joint | None = None) -> Joint:
    """From [[joint]], with the limits of a joint that is `known` where it has none itself."""
    values.only("[[joint]]", entry, ("type", *NUMBERS, *AXIS))
    kind = values.choice("joint type", entry["type"], UNITS)
    numbers = {key: values.number(key, entry[key]) for key in NUMBERS if key in entry}
    for key, value in numbers.items():
        if value < 0.0:
            raise ValueError(f"{key} is negative")
    otherwise = {key: getattr(known, key) for key in NUMBERS} if known else {}
    return Joint(type=kind, **{**otherwise, **numbers})
