"""Robots with a URDF: the standard parameters of its links, and the terms of its axes.

title = "Staubli TX40"
urdf = "tx40.urdf"              # beside this file
gravity = [0.0, 0.0, -9.81]     # m/s2, in the frame of the base

[[joint]]                       # one for each axis, or none at all
name = "joint_1"                # in the URDF; with names, joints without an entry are locked
terms = ["viscous", "coulomb"]  # from TERMS; or with a priori values: { viscous = 8.0 }

[[coupling]]
joints = [5, 6]                 # the motor of joint 6 also turns with joint 5

[[capsule]]                     # what must not touch another link, beside the URDF's own shapes
link = "forearm"                # in the URDF
from = [0.0, 0.0, 0.0]          # m, in the frame of the link
to = [0.3, 0.0, 0.0]            # left out for a sphere
radius = 0.06                   # m
"""

from __future__ import annotations

from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

from scarid_cli.algorithms.imperfections.registry import imperfections_of
from scarid_cli.algorithms.keys import values
from scarid_cli.algorithms.robots.base import with_base_parameters
from scarid_cli.algorithms.robots.capsules import capsule_of
from scarid_cli.algorithms.robots.controls import control_of
from scarid_cli.algorithms.robots.coupled import COUPLED_TERMS
from scarid_cli.algorithms.robots.description import Parameter, Robot
from scarid_cli.algorithms.robots.identified import with_estimates
from scarid_cli.algorithms.robots.joints import JOINT_UNITS, Joint, joint_of
from scarid_cli.algorithms.robots.logs import coupled, gear_ratio, log_of
from scarid_cli.algorithms.robots.rigid import GRAVITY, STANDARD_UNITS, SYMBOLS, Body, Posture
from scarid_cli.algorithms.robots.terms import AXIS_TERMS, AxisTerm, Mass, StandardTerm


def _complete(term: type[AxisTerm]) -> bool:
    """Whether a term needs no constants beside its joint."""
    return all(f.name == "joint" or f.default is not MISSING for f in fields(term))


# Terms of an axis; the inertia is that of its motor.
TERMS: dict[str, type[AxisTerm]] = {
    "inertia" if term is Mass else name: term
    for name, term in AXIS_TERMS.items()
    if _complete(term)
}
DEFAULT_TERMS = ("inertia", "viscous", "coulomb", "offset")
KEYS = (
    "title",
    "urdf",
    "gravity",
    "joint",
    "coupling",
    "capsule",
    "control",
    "estimates",
    "log",
    "imperfections",
    "masses",
    "posture",
)
STATED, PLACEHOLDER = "stated", "placeholder"  # what the masses and inertias of the URDF are


def arm(name: str, document: dict[str, Any], folder: Path) -> Robot:
    """The robot of a description, with its base parameters; the URDF is beside it in the folder."""
    values.only("a robot with a URDF", document, KEYS)
    entries = values.tables("joint", document.get("joint", []))
    body = Body(
        str(folder / values.text("urdf", document["urdf"])),
        gravity=values.row("gravity", document.get("gravity", list(GRAVITY)), 3),
        joints=_names(entries),
        added=tuple(map(capsule_of, values.tables("capsule", document.get("capsule", [])))),
        posture=_posture(document.get("posture", {})),
    )
    for name, _ in body.posture:
        values.choice("joint of posture, which is no axis", name, body.locked)
    for capsule in body.added:
        values.choice("link of a [[capsule]]", capsule.link, body.frames)
    found = body.joints_found
    entries = entries or [{} for _ in found]
    if len(entries) != len(found):
        raise ValueError(_wrong_number(len(entries), len(found), body))
    stated = values.choice("masses", document.get("masses", STATED), (STATED, PLACEHOLDER))
    standard = body.standard if stated == STATED else [0.0] * len(body.standard)
    joints, parameters = [], []
    chain = {number: place for place, number in enumerate(body.link_numbers)}
    for i, (joint, entry) in enumerate(zip(found, entries, strict=True), start=1):
        own = {key: value for key, value in entry.items() if key not in ("name", "terms")}
        joints.append(joint_of({"type": joint.type, **own}, joint))
        parameters += _standard(i, chain[i], standard)
        parameters += _terms(i, joint, entry.get("terms", list(DEFAULT_TERMS)))
    for i in range(len(found) + 1, len(chain) + 1):
        parameters += _standard(i, chain[i], standard)
    for entry in values.tables("coupling", document.get("coupling", [])):
        parameters += _coupled(entry, entries)
    values.distinct("parameter", [parameter.name for parameter in parameters])
    found_robot = with_base_parameters(
        Robot(
            name,
            values.text("title", document.get("title", Path(name).stem)),
            tuple(joints),
            tuple(parameters),
            control=control_of(document, len(found)),
            body=body,
            log=log_of(document, len(found)),
            imperfections=imperfections_of(document, len(found)),
        )
    )
    return with_estimates(found_robot, document)


def _wrong_number(entries: int, axes: int, body: Body) -> str:
    locked = f" (locked: {', '.join(body.locked)})" if body.locked else ""
    return (
        f"{entries} tables [[joint]] for the {axes} axes of {body.path}{locked}; give one for each "
        "axis, or none"
    )


def _posture(given: Any) -> Posture:
    """Where joints are locked that are no axes."""
    if not isinstance(given, dict):
        raise TypeError("posture is a table of joints and positions: { lift = 0.3 }")
    return tuple((name, values.number(name, at)) for name, at in given.items())


def _names(entries: list[dict[str, Any]]) -> tuple[str, ...]:
    named = [entry for entry in entries if "name" in entry]
    if named and len(named) != len(entries):
        raise ValueError("some joints have a name and others do not; name all axes, or none")
    return tuple(values.text("name", entry["name"]) for entry in named)


def _standard(i: int, at: int, apriori: list[float]) -> list[Parameter]:
    """The ten standard parameters of link i (from 1), at its place in the chain (from 0)."""
    return [
        Parameter(f"{symbol}{i}", unit, apriori[place], StandardTerm(place))
        for place, (symbol, unit) in enumerate(
            zip(SYMBOLS, STANDARD_UNITS, strict=True), start=10 * at
        )
    ]


def _terms(i: int, joint: Joint, wanted: Any) -> list[Parameter]:
    """The terms of axis i (from 1): a list of names, or a table with their a priori values."""
    aprioris = wanted if isinstance(wanted, dict) else dict.fromkeys(wanted, 0.0)
    parameters = []
    for name, apriori in aprioris.items():
        if name not in TERMS:
            raise ValueError(f"an axis has no term {name!r}; choose {', '.join(TERMS)}")
        term = TERMS[name](i)
        unit = term.UNITS[list(JOINT_UNITS).index(joint.type)]
        value = values.number(name, apriori)
        parameters.append(Parameter(term.SYMBOL.format(i=i), unit, value, term))
    return parameters


def _coupled(entry: dict[str, Any], axes: list[dict[str, Any]]) -> list[Parameter]:
    one, two, turns = coupled(entry, axes)
    ratio = turns / gear_ratio(axes[two])
    return [
        Parameter(term.SYMBOL.format(i=two + 1), term.UNIT, 0.0, term(one + 1, two + 1, ratio))
        for term in COUPLED_TERMS
    ]
