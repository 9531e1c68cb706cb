"""Identified dynamics as code in C99 or MATLAB: torques, gravity, mass matrix and friction.

The tables are those of the simulator (algorithms/plants/model.py): base parameters stand in the
places of the standard parameters that they are named after, which gives the same torques.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from importlib import resources
from typing import Any

import numpy as np

from scarid_cli.algorithms.plants.model import model
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.stages.results.parameters import Identified

WORD = re.compile(r"\W")


def c_header(found: Identified, name: str, remark: str, notes: Sequence[str] = ()) -> str:
    """The header, whose functions begin with a name; `notes` follow the remark at its top."""
    sizes, parts = _parts(found)
    told = "\n *".join([remark, *_spaced(notes)]).replace("*/", "* /")
    return _filled("dynamics.h", _c_tables(sizes, parts), identifier(name), told)


def matlab_class(found: Identified, name: str, remark: str, notes: Sequence[str] = ()) -> str:
    """A class of that name with static functions, which is to be in a file of that name."""
    parts = _parts(found)[1]
    properties = {
        "body": parts["body"],
        "motors": parts["motors"],
        "joints": parts["joints"],
        "couplings": parts["couplings"][:-1],  # C has no empty arrays, and one row more
        "weight": parts["gravity"],
    }
    tables = "\n".join(f"        {key} = {_matrix(x)};" for key, x in properties.items())
    return _filled("dynamics.m", tables, identifier(name), "\n%".join([remark, *_spaced(notes)]))


def _spaced(lines: Sequence[str]) -> list[str]:
    """The lines after the mark of a comment."""
    return [f" {line}".rstrip() for line in lines]


def identifier(name: str) -> str:
    """The name as C and MATLAB take it."""
    word = WORD.sub("_", name)
    return word if word[:1].isalpha() else f"robot_{word.lstrip('_')}"


def _filled(template: str, tables: str, prefix: str, told: str) -> str:
    text = resources.files("scarid_cli.stages").joinpath(template).read_text("utf-8")
    text = text.replace("ROBOT_TABLES", tables).replace("ROBOT", prefix)
    return text.replace("REMARK", told)


def _parts(found: Identified) -> tuple[dict[str, int], dict[str, Array]]:
    """The numbers of axes, links and couplings, and the tables."""
    values = dict(zip(found.robot.names, found.theta.tolist(), strict=True))
    tables = model(found.robot.with_values(values))
    axes = len(tables.joints)
    if not axes:
        raise UsageFault("a robot without joints has no dynamics")
    sizes = {"AXES": axes, "LINKS": len(tables.body), "COUPLINGS": len(tables.couplings)}
    return sizes, {
        "body": tables.body,
        "motors": tables.motors[:axes, :axes],
        "joints": tables.joints,
        "couplings": np.vstack((tables.couplings, np.zeros(6))),
        "gravity": tables.world[:3],
    }


SHAPES = {
    "body": "[ROBOT_LINKS][26]",
    "motors": "[ROBOT_AXES][ROBOT_AXES]",
    "joints": "[ROBOT_AXES][21]",
    "couplings": "[ROBOT_COUPLINGS + 1][6]",
    "gravity": "[3]",
}


def _c_tables(sizes: dict[str, int], parts: dict[str, Array]) -> str:
    counts = ", ".join(f"ROBOT_{key} = {count}" for key, count in sizes.items())
    fields = "\n".join(f"    double {key}{SHAPES[key]};" for key in parts)
    values = ",\n".join(f"    {_initialiser(x.tolist())}" for x in parts.values())
    return (
        f"enum {{ {counts} }};\n\n"
        f"static const struct {{\n{fields}\n}} ROBOT_model = {{\n{values}\n}};"
    )


def _initialiser(values: Any) -> str:
    """`{1.0, {2.0, 3.0}}` of nested lists, with every digit."""
    if isinstance(values, float):
        return repr(values)
    return f"{{{', '.join(map(_initialiser, values))}}}"


def _matrix(values: Array) -> str:
    """`[1.0, 2.0; 3.0, 4.0]` of a table, with every digit."""
    if not values.size:
        return f"zeros(0, {values.shape[-1]})"
    rows = np.atleast_2d(np.asarray(values, dtype=np.float64)).tolist()
    return f"[{'; '.join(', '.join(map(repr, row)) for row in rows)}]"
