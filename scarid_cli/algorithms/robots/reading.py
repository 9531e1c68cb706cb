"""Robots from TOML files and URDFs. Every value is checked when it is read."""

from __future__ import annotations

import re
import shlex
import tomllib
from collections.abc import Sequence
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

from scarid_cli.algorithms.imperfections.registry import imperfections_of
from scarid_cli.algorithms.keys import values
from scarid_cli.algorithms.keys.lines import UnknownKey, line_of
from scarid_cli.algorithms.robots.controls import control_of
from scarid_cli.algorithms.robots.description import Parameter, Robot
from scarid_cli.algorithms.robots.files import require_shallow, text_of
from scarid_cli.algorithms.robots.identified import with_estimates
from scarid_cli.algorithms.robots.joints import joint_of
from scarid_cli.algorithms.robots.logs import log_of
from scarid_cli.algorithms.robots.planar import PLANAR_TERMS, PlanarTerm
from scarid_cli.algorithms.robots.terms import AXIS_TERMS, Term
from scarid_cli.errors import UsageFault

ROBOTS = Path(__file__).parent
NAMED_TERMS: dict[str, type[Term]] = {**AXIS_TERMS, **PLANAR_TERMS}  # that [[parameter]] may name
DEFAULT_ROBOT = "scara2"
XML, ROOT = (".xml", ".mjcf", ".sdf", ".world"), re.compile(r"<(mujoco|sdf|robot)\b")
OTHER_MODELS = {
    "mujoco": "a model of MuJoCo; make it a URDF first, as mjcf-urdf-simple-converter of PyPI can",
    "sdf": "an SDF model; give the URDF that it was made from",
    "robot": "a URDF by another name; let its name end in .urdf",
}
KEYS = ("title", "joint", "parameter", "control", "coupling", "estimates", "log", "imperfections")


def built_in() -> list[str]:
    """The names of the robots that come with the package."""
    return sorted(path.stem for path in ROBOTS.glob("*.toml"))


def load(name: str) -> Robot:
    """A built-in robot by name, or one described in a TOML file or a URDF."""
    try:
        return _loaded(name)
    except UnknownKey as error:
        line = line_of(text_of(path_of(name)), error.table, error.key)
        where = f"{name}, line {line}" if line else name
        raise UsageFault(f"{where}: not a robot description: {_line(error)}") from None
    except (AttributeError, KeyError, RecursionError, TypeError, ValueError) as error:
        reason = f"missing {error}" if isinstance(error, KeyError) else _line(error)
        raise UsageFault(f"{name}: not a robot description: {reason}") from None


def _line(error: Exception) -> str:
    return " ".join(str(error).split())


def _loaded(name: str) -> Robot:
    if name.endswith(".urdf"):
        return _arm(name, {"title": name, "urdf": name}, Path())
    if name.endswith(".xacro"):
        urdf = shlex.quote(name.removesuffix(".xacro").removesuffix(".urdf") + ".urdf")
        raise UsageFault(f"{name}: make it a URDF first: `xacro {shlex.quote(name)} > {urdf}`")
    known = built_in()
    if not name.endswith(".toml") and name not in known:
        raise UsageFault(_unknown(name, known))
    path = path_of(name)
    text = text_of(path)
    require_shallow(text)
    document = tomllib.loads(text)
    if "urdf" in document:
        return _arm(name, document, path.parent)
    return _robot(name, document)


def path_of(name: str) -> Path:
    """The file of a robot: that of a built-in one, or the one of this name."""
    return ROBOTS / f"{name}.toml" if name in built_in() else Path(name)


def _unknown(name: str, known: Sequence[str]) -> str:
    """What to do with a name that is no robot's, or with a file of another kind."""
    root = ROOT.search(text_of(name)) if Path(name).suffix in XML and Path(name).exists() else None
    if root:
        return f"{name}: {OTHER_MODELS[root[1]]}"
    return f"unknown robot {name!r}; choose {', '.join(known)}, or a .toml or .urdf file"


def _arm(name: str, document: dict[str, Any], folder: Path) -> Robot:
    from scarid_cli.algorithms.robots.arms import arm  # needs an XML parser

    return arm(name, document, folder)


def _robot(name: str, document: dict[str, Any]) -> Robot:
    values.only("a robot", document, KEYS)
    joints = tuple(joint_of(entry) for entry in values.tables("joint", document["joint"]))
    values.moderate(len(joints))
    terms = values.tables("parameter", document["parameter"])
    parameters = tuple(_parameter(entry, len(joints)) for entry in terms)
    if not joints or not parameters:
        raise ValueError("it has no [[joint]] or no [[parameter]]; give at least one of each")
    values.distinct("name", [parameter.name for parameter in parameters])
    values.distinct("term of a joint", [(p.term.NAME, *p.term.joints) for p in parameters])
    robot = Robot(
        name=name,
        title=values.text("title", document.get("title", Path(name).stem)),
        joints=joints,
        parameters=parameters,
        control=control_of(document, len(joints)),
        log=log_of(document, len(joints)),
        imperfections=imperfections_of(document, len(joints)),
    )
    return with_estimates(robot, document)


def _parameter(entry: dict[str, Any], joints: int) -> Parameter:
    name = values.text("name", entry["name"])
    term = _term(name, entry)
    if isinstance(term, PlanarTerm) and joints < max(term.joints):
        raise ValueError(f"{name}: term {term.NAME} needs {max(term.joints)} joints")
    for joint in term.joints:
        if not 1 <= joint <= joints:
            raise ValueError(f"{name} is on joint {joint} of a robot with {joints}")
    return Parameter(
        name=name,
        unit=values.text("unit", entry["unit"]),
        apriori=values.number("apriori", entry["apriori"]),
        term=term,
    )


def _term(name: str, entry: dict[str, Any]) -> Term:
    """The term that [[parameter]] names, with its constants."""
    wanted = values.text("term", entry["term"])
    if wanted not in NAMED_TERMS:
        raise ValueError(f"{name}: there is no term {wanted!r}; choose {', '.join(NAMED_TERMS)}")
    term = NAMED_TERMS[wanted]
    constants = {field.name: field for field in fields(term)}
    known = ("name", "term", "unit", "apriori", *constants)
    values.only(f"a [[parameter]] with term {wanted}", entry, known)
    given = {
        key: (values.whole if field.type == "int" else values.number)(key, entry[key])
        for key, field in constants.items()
        if key in entry or field.default is MISSING
    }
    try:
        return term(**given)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
