"""A robot's description with its identified values, which every command reads again."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Iterator, Sequence

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.terms import Stribeck
from scarid_cli.errors import UsageFault
from scarid_cli.stages.models.intervals import Interval

BARE = re.compile(r"[A-Za-z0-9_-]+")
URDF = re.compile(r"""^(\s*urdf\s*=\s*)("[^"\n]*"|'[^'\n]*')""", re.MULTILINE)
HEADER = re.compile(r"^\s*\[")
ESTIMATES = re.compile(r"^\s*\[\s*estimates\s*\]")


def described(
    text: str | None, robot: Robot, rows: Sequence[Interval], remark: str, folder: str
) -> str:
    """The TOML `text` of a description, None for a URDF alone, with a table [estimates].

    All else stands as it was. The path of the URDF is made relative to the `folder` of the result.
    """
    if text is None:
        text = f"title = {_quoted(robot.title)}\nurdf = {_quoted(robot.name)}\n"
    text = "\n".join(_without_estimates(text.splitlines())).rstrip()
    if robot.body:
        path = os.path.relpath(robot.body.path, folder or ".")
        text = URDF.sub(lambda found: found[1] + _quoted(path), text, count=1)
        if tomllib.loads(text).get("urdf") != path:
            raise UsageFault(
                f"{robot.name}: its urdf is not on a line of its own; write it as `urdf = ...`"
            )
    known = {p.name: p for p in robot.parameters}
    lines = [f"# {remark}", text, "", "[estimates]"]
    lines += [
        f"{_key(row.name)} = {row.estimate!r}  # {_remark(row)}"
        for row in rows
        if row.name in known and not isinstance(known[row.name].term, Stribeck)
    ]
    return "\n".join([*lines, *_stribeck(robot, rows)]) + "\n"


def lost(robot: Robot) -> list[str]:
    """The parameters that such a description cannot hold."""
    stribeck = [p.name for p in robot.parameters if isinstance(p.term, Stribeck)]
    return stribeck if robot.body else []


def _without_estimates(lines: Sequence[str]) -> Iterator[str]:
    """The lines, without a table [estimates]."""
    within = False
    for line in lines:
        if HEADER.match(line):
            within = bool(ESTIMATES.match(line))
        if not within:
            yield line


def _stribeck(robot: Robot, rows: Sequence[Interval]) -> Iterator[str]:
    """Friction that the estimator added, as terms of a robot without a URDF."""
    values = {row.name: row for row in rows}
    for parameter in robot.parameters:
        term = parameter.term
        if isinstance(term, Stribeck) and not robot.body:
            row = values[parameter.name]
            yield f"\n[[parameter]]\nname = {_quoted(row.name)}\nterm = {_quoted(term.NAME)}"
            yield f"joint = {term.joint}\nvelocity = {term.velocity!r}\nunit = {_quoted(row.unit)}"
            yield f"apriori = {row.estimate!r}  # {row.text}"


def _remark(row: Interval) -> str:
    combination = "" if row.stands_for in ("", row.name) else f" = {row.stands_for}"
    return f"{row.unit}, {row.text}{combination}"


def _key(name: str) -> str:
    return name if BARE.fullmatch(name) else _quoted(name)


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
