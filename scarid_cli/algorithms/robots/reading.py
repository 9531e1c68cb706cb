"""Robots from TOML files, checked value by value: a mistake is told before anything runs."""

from __future__ import annotations

import tomllib
from math import isfinite
from pathlib import Path
from typing import Any

from scarid_cli.algorithms.robots.base import with_base_parameters
from scarid_cli.algorithms.robots.description import UNITS, Control, Joint, Parameter, Robot
from scarid_cli.algorithms.robots.rigid import SYMBOLS, Body
from scarid_cli.algorithms.robots.rigid import UNITS as STANDARD_UNITS
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
        return with_base_parameters(_arm(name, {"title": name, "urdf": name}, Path()))
    path = Path(name) if name.endswith(".toml") else FOLDER / f"{name}.toml"
    if not path.is_file():
        raise UsageFault(
            f"unknown robot {name!r}; choose {', '.join(built_in())}, or a .toml or .urdf file"
        )
    try:
        document = tomllib.loads(path.read_text("utf-8"))
        if "urdf" in document:
            return with_base_parameters(_arm(name, document, path.parent))
        return _robot(name, document)
    except (AttributeError, KeyError, RecursionError, TypeError, ValueError) as error:
        reason = f"missing {error}" if isinstance(error, KeyError) else str(error)
        told = " ".join(reason.split())
        raise UsageFault(f"{name}: not a robot description: {told}") from None


def _robot(name: str, document: dict[str, Any]) -> Robot:
    joints = tuple(_joint(entry) for entry in document["joint"])
    parameters = tuple(_parameter(entry, len(joints)) for entry in document["parameter"])
    if not joints or not parameters:
        raise ValueError("it needs at least one joint and one parameter")
    _distinct("name", [parameter.name for parameter in parameters])
    _distinct("term of a joint", [(p.term, p.joint) for p in parameters])
    control = document.get("control")
    return Robot(
        name=name,
        title=_text("title", document["title"]),
        joints=joints,
        parameters=parameters,
        control=_control(control, len(joints)) if control else None,
    )


TERMS_OF_AXIS = {
    "inertia": ("Ia", "mass", "kg m2"),
    "viscous": ("fv", "viscous", "N m s/rad"),
    "coulomb": ("fs", "coulomb", "N m"),
    "offset": ("off", "offset", "N m"),
}
TERMS_OF_COUPLING = (
    ("Iam", "coupled-inertia", "kg m2"),
    ("fvm", "coupled-viscous", "N m s/rad"),
    ("fsm", "coupled-coulomb", "N m"),
)


def _arm(name: str, document: dict[str, Any], folder: Path) -> Robot:
    """A robot whose rigid bodies a URDF describes; all standard parameters, and its axes' terms.

    [[joint]] may have limits, noise, and `terms`, by default all of TERMS_OF_AXIS; [[coupling]] has
    the two joints that share a motor.
    """
    body = Body(str(folder / _text("urdf", document["urdf"])))
    types = body.types
    entries = document.get("joint") or [{} for _ in types]
    if len(entries) != len(types):
        raise ValueError(f"{len(entries)} joints for the {len(types)} of {body.path}")
    joints, parameters = [], []
    for i, (kind, entry) in enumerate(zip(types, entries, strict=True), start=1):
        axis = {k: v for k, v in entry.items() if k != "terms"}
        joints.append(_joint({"type": kind, **axis}))
        parameters += [
            Parameter(f"{symbol}{i}", "standard", unit, 0.0, column=10 * (i - 1) + k)
            for k, (symbol, unit) in enumerate(zip(SYMBOLS, STANDARD_UNITS, strict=True))
        ]
        for term in entry.get("terms", TERMS_OF_AXIS):
            if term not in TERMS_OF_AXIS:
                raise ValueError(f"term {term!r} of an axis; choose {', '.join(TERMS_OF_AXIS)}")
            symbol, column, unit = TERMS_OF_AXIS[term]
            parameters.append(Parameter(f"{symbol}{i}", column, unit, 0.0, joint=i))
    for entry in document.get("coupling", []):
        one, two = (_whole("coupling", x) for x in entry["joints"])
        if not {one, two} <= set(range(1, len(types) + 1)) or one == two:
            raise ValueError(f"joints {one} and {two} cannot be coupled")
        parameters += [
            Parameter(f"{symbol}{two}", term, unit, 0.0, joint=one, other=two)
            for symbol, term, unit in TERMS_OF_COUPLING
        ]
    title = _text("title", document["title"])
    return Robot(name, title, tuple(joints), tuple(parameters), control=None, body=body)


def _joint(entry: dict[str, Any]) -> Joint:
    kind = _text("type", entry["type"])
    if kind not in UNITS:
        raise ValueError(f"joint type {kind!r}; choose {' or '.join(UNITS)}")
    numbers = {k: _number(k, value) for k, value in entry.items() if k != "type"}
    for key, value in numbers.items():
        if value < 0.0:
            raise ValueError(f"{key} is negative")
    return Joint(type=kind, **numbers)


def _parameter(entry: dict[str, Any], joints: int) -> Parameter:
    known = ("name", "term", "unit", "apriori", "joint", "velocity", "length", "gravity")
    for key in entry:
        if key not in known:
            raise ValueError(f"{key} is not of a parameter; it has {', '.join(known)}")
    parameter = Parameter(
        name=_text("name", entry["name"]),
        term=_text("term", entry["term"]),
        unit=_text("unit", entry["unit"]),
        apriori=_number("apriori", entry["apriori"]),
        joint=_whole("joint", entry.get("joint", 0)),
        velocity=_number("velocity", entry.get("velocity", 0.0)),
        length=_number("length", entry.get("length", 0.0)),
        gravity=_number("gravity", entry.get("gravity", 0.0)),
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
    rows = {key: tuple(_number(key, x) for x in entry[key]) for key in ("kp", "kd", "ki")}
    for key, row in rows.items():
        if len(row) != joints:
            raise ValueError(f"{key} has {len(row)} values for {joints} joints")
    cutoff = _number("velocity_cutoff", entry["velocity_cutoff"])
    return Control(**rows, velocity_cutoff=cutoff)


def _text(key: str, value: Any) -> str:
    if not isinstance(value, str) or not value:
        raise TypeError(f"{key} is {value!r}, not a text")
    return value


def _number(key: str, value: Any) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise TypeError(f"{key} is {value!r}, not a number")
    if abs(value) > 1e300 or not isfinite(value):
        raise ValueError(f"{key} is not a finite number")
    return float(value)


def _whole(key: str, value: Any) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise TypeError(f"{key} is {value!r}, not a whole number")
    return value


def _distinct(what: str, values: list[Any]) -> None:
    twice = next((value for value in values if values.count(value) > 1), None)
    if twice is not None:
        raise ValueError(f"the {what} {twice!r} stands twice")
