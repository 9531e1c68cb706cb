"""Identified values in a description: the table [estimates], by the names of the parameters.

    [estimates]
    Iyy1 = 0.4157             # in place of what follows from the URDF or stands in [[parameter]]
    "fs1+" = 1.02

`scarid export --to toml` writes it.
"""

from __future__ import annotations

from typing import Any

from scarid_cli.algorithms.keys import values
from scarid_cli.algorithms.robots.description import Robot


def with_estimates(robot: Robot, document: dict[str, Any]) -> Robot:
    """The robot, with the values of [estimates] as a priori values."""
    given = values.table("estimates", document.get("estimates", {}))
    values.only("[estimates]", given, robot.names)
    return robot.with_values({name: values.number(name, x) for name, x in given.items()})
