"""Identified dynamics as C99: inverse dynamics, gravity, mass matrix and friction in one header.

The tables are those of the simulator (algorithms/plants/model.py): base parameters stand in the
places of the standard parameters that they are named after, which gives the same torques.
"""

from __future__ import annotations

import re
from dataclasses import replace
from importlib import resources
from typing import Any

import numpy as np

from scarid_cli.algorithms.plants.model import Model, model
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.errors import UsageFault
from scarid_cli.stages.parameters import Identified

WORD = re.compile(r"\W")


def c_header(found: Identified, name: str, remark: str) -> str:
    """The header, whose functions begin with a name."""
    tables = model(_with_estimates(found))
    prefix = WORD.sub("_", name)
    if not prefix or prefix[0].isdigit():
        prefix = f"robot_{prefix}"
    text = resources.files("scarid_cli.stages").joinpath("dynamics.h").read_text("utf-8")
    told = remark.replace("*/", "* /")
    return (
        text.replace("ROBOT_TABLES", _tables(tables))
        .replace("ROBOT", prefix)
        .replace("REMARK", told)
    )


def _with_estimates(found: Identified) -> Robot:
    """The robot, with the estimates in place of a priori values."""
    robot = found.robot
    pairs = zip(robot.parameters, found.theta.tolist(), strict=True)
    return replace(robot, parameters=tuple(replace(p, apriori=value) for p, value in pairs))


def _tables(tables: Model) -> str:
    axes, links, couplings = len(tables.joints), len(tables.body), len(tables.couplings)
    if not axes:
        raise UsageFault("a robot without joints has no dynamics")
    parts = {
        "body[LINKS][26]": tables.body,
        "motors[AXES][AXES]": tables.motors[:axes, :axes],
        "joints[AXES][21]": tables.joints,
        "couplings[COUPLINGS + 1][6]": [*tables.couplings.tolist(), [0.0] * 6],
        "gravity[3]": tables.world[:3],
    }
    fields = "\n".join(f"    double {name};" for name in parts)
    lists = (np.asarray(x, dtype=np.float64).tolist() for x in parts.values())
    values = ",\n".join(f"    {_initialiser(x)}" for x in lists)
    sizes = f"enum {{ ROBOT_AXES = {axes}, ROBOT_LINKS = {links}, ROBOT_COUPLINGS = {couplings} }};"
    for word in ("AXES", "LINKS", "COUPLINGS"):
        fields = fields.replace(word, f"ROBOT_{word}")
    return f"{sizes}\n\nstatic const struct {{\n{fields}\n}} ROBOT_model = {{\n{values}\n}};"


def _initialiser(values: Any) -> str:
    """`{1.0, {2.0, 3.0}}` of nested lists, with every digit."""
    if isinstance(values, float):
        return repr(values)
    return f"{{{', '.join(map(_initialiser, values))}}}"
