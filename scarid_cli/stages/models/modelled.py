"""An identified robot as a document for machines (schemas/documents/export.schema.json)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from typing import Any

from scarid_cli import __version__
from scarid_cli.algorithms.robots.description import Parameter, Robot
from scarid_cli.algorithms.robots.drives import drives
from scarid_cli.algorithms.robots.physical import Physical, inertia_of
from scarid_cli.algorithms.robots.rigid import SYMBOLS
from scarid_cli.algorithms.robots.terms import StandardTerm
from scarid_cli.io.table import Table
from scarid_cli.io.urdf import Inertial
from scarid_cli.stages.models.intervals import Interval

Row = dict[str, Any]


def modelled(table: Table, robot: Robot, found: Physical | None, rows: Sequence[Interval]) -> Row:
    """The document: what was identified for each link and each axis, with its intervals.

    With the bodies that were `found` it has these as well, of a robot with a URDF.
    """
    told = [
        _parameter(row, None if found is None or i >= len(found.base) else float(found.base[i]))
        for i, row in enumerate(rows)
    ]
    added = rows[len(robot.parameters) :]  # constants of terms, such as vs1
    places = [*map(_place, robot.parameters), *(("axis", int(row.name[2:])) for row in added)]

    def of(kind: str, number: int) -> list[Row]:
        return [x for x, place in zip(told, places, strict=True) if place == (kind, number)]

    names = robot.body.joint_names if robot.body else [None] * len(robot.joints)
    links = robot.body.links if robot.body else []
    moved = drives(robot, found.axes).axes if found else ()
    return {
        "command": "export",
        "version": __version__,
        "robot": robot.name,
        "title": robot.title,
        "verdict": table.meta.extra.get("verdict"),
        "gravity": list(robot.body.gravity) if robot.body else None,
        "links": [
            {
                "link": name,
                "number": robot.body.link_numbers[k],  # type: ignore[union-attr]
                "fixed_to_it": fixed,
                "body": _body(found, k),
                "parameters": of("link", k),
            }
            for k, (name, fixed) in enumerate(links)
        ],
        "axes": [
            {
                "axis": i,
                "joint": name,
                "type": joint.type,
                **{key: _finite(getattr(joint, key)) for key in LIMITS},
                "drive": _drive(moved[i - 1]) if moved else None,
                "parameters": of("axis", i),
            }
            for i, (name, joint) in enumerate(zip(names, robot.joints, strict=True), start=1)
        ],
    }


LIMITS = ("lower", "upper", "velocity_limit", "acceleration_limit", "torque_limit")


def _place(parameter: Parameter) -> tuple[str, int]:
    """The link in the chain (from 0), or the axis (from 1), that a parameter belongs to.

    One of several axes belongs to the last of them.
    """
    if isinstance(parameter.term, StandardTerm):
        return "link", parameter.term.place // len(SYMBOLS)
    return "axis", max(parameter.term.joints)


def _parameter(row: Interval, consistent: float | None) -> Row:
    return {
        "parameter": row.name,
        "unit": row.unit,
        "estimate": row.estimate,
        "low": _finite(row.low),
        "high": _finite(row.high),
        "consistent": consistent,
        "stands_for": row.stands_for or row.name,
    }


def _body(found: Physical | None, k: int) -> Row | None:
    if found is None:
        return None
    own = found.bodies[k]
    body = Inertial.of(own[9], own[6:9], inertia_of(own))
    return {
        "mass": float(body.mass),
        "centre": body.centre.tolist(),
        "inertia": body.inertia.tolist(),
    }


def _drive(drive: Any) -> Row:
    return {key: value for key, value in asdict(drive).items() if key != "joint"}


def _finite(value: float) -> float | None:
    """JSON has no nan and no infinity."""
    return value if isfinite(value) else None
