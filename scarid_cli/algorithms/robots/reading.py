"""Robots from TOML files and URDFs, checked value by value: a mistake is told at once."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from scarid_cli.algorithms.robots import values
from scarid_cli.algorithms.robots.description import Control, Parameter, Robot
from scarid_cli.algorithms.robots.joints import joint_of
from scarid_cli.algorithms.robots.logs import log_of
from scarid_cli.algorithms.robots.terms import GRAVITY_TERMS, PLANAR_JOINTS, PLANAR_TERMS, TERMS
from scarid_cli.errors import UsageFault

FOLDER = Path(__file__).parent
DEFAULT = "scara2"


def built_in() -> list[str]:
    """The names of the robots that come with the package."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load(name: str) -> Robot:
    """A built-in robot by name, or one described in a TOML file or a URDF."""
    if name.endswith(".urdf"):
        from scarid_cli.algorithms.robots.arms import arm

        return arm(name, {"title": name, "urdf": name}, Path())
    path = Path(name) if name.endswith(".toml") else FOLDER / f"{name}.toml"
    if not path.exists():
        if name.endswith(".toml"):
            raise UsageFault(f"{name}: no such file")
        raise UsageFault(
            f"unknown robot {name!r}; choose {', '.join(built_in())}, or a .toml or .urdf file"
        )
    try:
        document = tomllib.loads(path.read_text("utf-8"))
        if "urdf" in document:
            from scarid_cli.algorithms.robots.arms import arm  # needs an XML parser

            return arm(name, document, path.parent)
        return _robot(name, document)
    except (AttributeError, KeyError, RecursionError, TypeError, ValueError) as error:
        reason = f"missing {error}" if isinstance(error, KeyError) else str(error)
        told = " ".join(reason.split())
        raise UsageFault(f"{name}: not a robot description: {told}") from None


def _robot(name: str, document: dict[str, Any]) -> Robot:
    values.only("a robot", document, ("title", "joint", "parameter", "control", "coupling", "log"))
    joints = tuple(joint_of(entry) for entry in values.tables("joint", document["joint"]))
    terms = values.tables("parameter", document["parameter"])
    parameters = tuple(_parameter(entry, len(joints)) for entry in terms)
    if not joints or not parameters:
        raise ValueError("it needs at least one joint and one parameter")
    values.distinct("name", [parameter.name for parameter in parameters])
    values.distinct("term of a joint", [(p.term, p.joint) for p in parameters])
    control = document.get("control")
    return Robot(
        name=name,
        title=values.text("title", document["title"]),
        joints=joints,
        parameters=parameters,
        control=_control(control, len(joints)) if control else None,
        log=log_of(document, len(joints)),
    )


def _parameter(entry: dict[str, Any], joints: int) -> Parameter:
    known = ("name", "term", "unit", "apriori", "joint", "velocity", "length", "gravity")
    values.only("[[parameter]]", entry, known)
    parameter = Parameter(
        name=values.text("name", entry["name"]),
        term=values.text("term", entry["term"]),
        unit=values.text("unit", entry["unit"]),
        apriori=values.number("apriori", entry["apriori"]),
        joint=values.whole("joint", entry.get("joint", 0)),
        velocity=values.number("velocity", entry.get("velocity", 0.0)),
        length=values.number("length", entry.get("length", 0.0)),
        gravity=values.number("gravity", entry.get("gravity", 0.0)),
    )
    if parameter.term not in TERMS:
        raise ValueError(f"{parameter.name} has term {parameter.term!r}; choose {', '.join(TERMS)}")
    if parameter.velocity < 0.0 or (parameter.term == "stribeck" and not parameter.velocity):
        raise ValueError(f"{parameter.name} needs a positive velocity")
    planar = parameter.term in (*PLANAR_TERMS, *GRAVITY_TERMS)
    if planar and joints < PLANAR_JOINTS:
        raise ValueError(
            f"{parameter.name} has term {parameter.term}, which needs {PLANAR_JOINTS} joints"
        )
    if not (0 if planar else 1) <= parameter.joint <= joints:
        raise ValueError(f"{parameter.name} is on joint {parameter.joint} of {joints}")
    return parameter


def _control(entry: dict[str, Any], joints: int) -> Control:
    rows = {key: tuple(values.number(key, x) for x in entry[key]) for key in ("kp", "kd", "ki")}
    for key, row in rows.items():
        if len(row) != joints:
            raise ValueError(f"{key} has {len(row)} values for {joints} joints")
    cutoff = values.number("velocity_cutoff", entry["velocity_cutoff"])
    return Control(**rows, velocity_cutoff=cutoff)
