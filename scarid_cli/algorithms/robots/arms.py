"""Robots whose rigid bodies a URDF describes: all standard parameters, and the terms of its axes.

title = "Staubli TX40"
urdf = "tx40.urdf"              # beside this file
gravity = [0.0, 0.0, -9.81]     # m/s2, in the frame of the base

[[joint]]                       # one for each joint that moves, or none at all
name = "joint_1"                # of the URDF; with names, joints that have no entry are locked
terms = ["viscous", "coulomb"]  # of TERMS; or with a priori values: { viscous = 8.0 }

[[coupling]]
joints = [5, 6]                 # the motor of joint 6 turns with joint 5 as well
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from scarid_cli.algorithms.robots import values
from scarid_cli.algorithms.robots.base import with_base_parameters
from scarid_cli.algorithms.robots.description import Parameter, Robot
from scarid_cli.algorithms.robots.joints import Joint, joint_of
from scarid_cli.algorithms.robots.logs import coupled, gear_ratio, log_of
from scarid_cli.algorithms.robots.rigid import GRAVITY, SYMBOLS, Body
from scarid_cli.algorithms.robots.rigid import UNITS as STANDARD_UNITS

# Of an axis: symbol, unit of a revolute and of a prismatic one.
TERMS = {
    "inertia": ("Ia{i}", "kg m2", "kg"),
    "viscous": ("fv{i}", "N m s/rad", "N s/m"),
    "coulomb": ("fs{i}", "N m", "N"),
    "offset": ("off{i}", "N m", "N"),
    "viscous-forward": ("fv{i}+", "N m s/rad", "N s/m"),
    "viscous-backward": ("fv{i}-", "N m s/rad", "N s/m"),
    "coulomb-forward": ("fs{i}+", "N m", "N"),
    "coulomb-backward": ("fs{i}-", "N m", "N"),
}
DEFAULT = ("inertia", "viscous", "coulomb", "offset")
OF_REGRESSOR = {"inertia": "mass"}  # what a term is called there, if it is another name
# Of a coupling: symbol and unit.
COUPLED = {
    "coupled-inertia": ("Iam{i}", "kg m2"),
    "coupled-viscous": ("fvm{i}", "N m s/rad"),
    "coupled-coulomb": ("fsm{i}", "N m"),
}
KEYS = ("title", "urdf", "gravity", "joint", "coupling", "log")


def arm(name: str, document: dict[str, Any], folder: Path) -> Robot:
    """The robot with its base parameters."""
    values.only("a robot with a URDF", document, KEYS)
    entries = values.tables("joint", document.get("joint", []))
    body = Body(
        str(folder / values.text("urdf", document["urdf"])),
        gravity=values.row("gravity", document.get("gravity", list(GRAVITY)), 3),
        joints=_names(entries),
    )
    found = body.joints_found
    entries = entries or [{} for _ in found]
    if len(entries) != len(found):
        raise ValueError(_wrong_number(len(entries), len(found), body))
    standard = body.standard
    joints, parameters = [], []
    for i, (joint, entry) in enumerate(zip(found, entries, strict=True), start=1):
        own = {key: value for key, value in entry.items() if key not in ("name", "terms")}
        joints.append(joint_of({"type": joint.type, **own}, joint))
        parameters += _standard(i, standard)
        parameters += _terms(i, joint, entry.get("terms", list(DEFAULT)))
    for entry in values.tables("coupling", document.get("coupling", [])):
        parameters += _coupled(entry, entries)
    values.distinct("parameter", [parameter.name for parameter in parameters])
    return with_base_parameters(
        Robot(
            name,
            values.text("title", document["title"]),
            tuple(joints),
            tuple(parameters),
            control=None,
            body=body,
            log=log_of(document, len(found)),
        )
    )


def _wrong_number(entries: int, axes: int, body: Body) -> str:
    locked = f" (locked: {', '.join(body.locked)})" if body.locked else ""
    return f"{entries} joints for the {axes} of {body.path}{locked}"


def _names(entries: list[dict[str, Any]]) -> tuple[str, ...]:
    named = [entry for entry in entries if "name" in entry]
    if named and len(named) != len(entries):
        raise ValueError("some joints have a name, others none")
    return tuple(values.text("name", entry["name"]) for entry in named)


def _standard(i: int, apriori: list[float]) -> list[Parameter]:
    """The ten parameters of link i."""
    return [
        Parameter(
            f"{symbol}{i}", "standard", unit, apriori[10 * (i - 1) + k], column=10 * (i - 1) + k
        )
        for k, (symbol, unit) in enumerate(zip(SYMBOLS, STANDARD_UNITS, strict=True))
    ]


def _terms(i: int, joint: Joint, wanted: Any) -> list[Parameter]:
    """Of axis i: a list of terms, or a table with their a priori values."""
    aprioris = wanted if isinstance(wanted, dict) else dict.fromkeys(wanted, 0.0)
    parameters = []
    for term, apriori in aprioris.items():
        if term not in TERMS:
            raise ValueError(f"term {term!r} of an axis; choose {', '.join(TERMS)}")
        symbol, revolute, prismatic = TERMS[term]
        unit = revolute if joint.type == "revolute" else prismatic
        value = values.number(term, apriori)
        column = OF_REGRESSOR.get(term, term)
        parameters.append(Parameter(symbol.format(i=i), column, unit, value, joint=i))
    return parameters


def _coupled(entry: dict[str, Any], axes: list[dict[str, Any]]) -> list[Parameter]:
    one, two, turns = coupled(entry, axes)
    ratio = turns / gear_ratio(axes[two])
    return [
        Parameter(
            symbol.format(i=two + 1), term, unit, 0.0, joint=one + 1, other=two + 1, ratio=ratio
        )
        for term, (symbol, unit) in COUPLED.items()
    ]
