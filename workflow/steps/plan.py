"""The configuration of a batch: robots, their logs in order, and the options of the commands."""

from __future__ import annotations

import glob
import os
import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

from scarid_cli.algorithms.robots.files import require_shallow, text_of
from scarid_cli.errors import ScaridError

# The commands, with the options that they get unless the configuration says otherwise.
PIPE = {
    "convert": "",
    "resample": "",  # no resampling
    "tune": "--method rts",
    "differentiate": "",  # the settings of tune; any option here takes their place
    "identify": "--estimator gls --align",
    "validate": "",
}
TRIED = 20  # logs of a robot, until one is found that tune can work with
PAGES = ("all", "needed", "none")
KEYS = {"out", "group", "pages", "pipe", "robots"}
OF_ROBOT = {"robot", "logs", "pipe"}
DATE = re.compile(
    r"(?<!\d)((?:19|20)\d\d)[-_]?(\d\d)[-_]?(\d\d)(?:[T_ -]?(\d\d)[-:h_]?(\d\d)(?:[-:m_]?(\d\d))?)?"
)
NAME = re.compile(r"\w[\w.-]*\Z")


class PlanError(Exception):
    """The configuration is wrong; the message is one line."""


@dataclass(frozen=True)
class Log:
    """A log: its name within the robot, its file, the date in its name, and its place from 1."""

    name: str
    file: str
    date: str | None
    order: int


@dataclass(frozen=True)
class Robot:
    """A robot: its name, what `--robot` gets, its logs in order, and options for each command."""

    name: str
    description: str
    logs: tuple[Log, ...]
    pipe: Mapping[str, str] = field(default_factory=dict)

    @property
    def tuned(self) -> bool:
        """Whether its settings are those of `tune`."""
        return not self.pipe["differentiate"]


@dataclass(frozen=True)
class Plan:
    """A batch: where its outcome goes, logs per job, which logs get a page, and the robots."""

    out: Path
    group: int
    pages: str
    robots: tuple[Robot, ...]

    def robot(self, name: str) -> Robot:
        return next(robot for robot in self.robots if robot.name == name)

    def groups(self, robot: Robot) -> list[str]:
        """The numbers of the groups of a robot's logs: 0001, ..."""
        count = -(-len(robot.logs) // self.group)
        return [f"{number:04d}" for number in range(1, count + 1)]

    def logs(self, robot: Robot, group: str) -> tuple[Log, ...]:
        """The logs of a group."""
        start = (int(group) - 1) * self.group
        return robot.logs[start : start + self.group]


def read(path: str) -> Plan:
    """Read a configuration. Globs and paths in it are relative to the present folder."""
    try:
        text = text_of(path)
        require_shallow(text)
        given = tomllib.loads(text)
    except ScaridError as fault:
        raise PlanError(str(fault)) from None
    except (RecursionError, ValueError) as error:
        raise PlanError(f"{path}: {error}") from None
    _known(given, KEYS, path)
    robots = given.get("robots")
    if not isinstance(robots, dict) or not robots:
        raise PlanError(f"{path}: no robots; describe each one in a table [robots.NAME]")
    group, pages = given.get("group", 50), given.get("pages", "all")
    if not isinstance(group, int) or group < 1:
        raise PlanError(f"{path}: group = {group!r}: give the number of logs of a job")
    if pages not in PAGES:
        raise PlanError(f"{path}: pages = {pages!r}: write one of {', '.join(PAGES)}")
    common = {**PIPE, **_pipe(given, path)}
    found = tuple(_robot(name, own, common, path) for name, own in robots.items())
    return Plan(Path(given.get("out", "outcome")), group, pages, found)


def _known(table: Any, keys: set[str], where: str) -> None:
    if not isinstance(table, dict):
        raise PlanError(f"{where}: a table is expected here")
    for key in table:
        if key not in keys:
            raise PlanError(f"{where}: unknown key {key!r}; there are {', '.join(sorted(keys))}")


def _pipe(table: dict[str, Any], where: str) -> dict[str, str]:
    pipe = table.get("pipe", {})
    _known(pipe, set(PIPE), f"{where}, pipe")
    for command, options in pipe.items():
        if not isinstance(options, str):
            raise PlanError(f"{where}: the options of {command} are one text, as typed in a shell")
    return dict(pipe)


def _robot(name: str, own: Any, common: dict[str, str], path: str) -> Robot:
    where = f"{path}, robots.{name}"
    _known(own, OF_ROBOT, where)
    if not NAME.match(name):
        raise PlanError(f"{where}: a name has letters, digits, and the signs _ . - only")
    description, globs = own.get("robot"), own.get("logs")
    if not isinstance(description, str):
        raise PlanError(f"{where}: robot = NAME or FILE is missing (see `scarid identify --help`)")
    if isinstance(globs, str):
        globs = [globs]
    if not isinstance(globs, list) or not globs:
        raise PlanError(f"{where}: logs = [PATTERN, ...] is missing")
    logs = tuple(_logs([str(pattern) for pattern in globs], where))
    return Robot(name, description, logs, {**common, **_pipe(own, where)})


def _logs(patterns: list[str], where: str) -> Iterator[Log]:
    """The files that the patterns match, by date, then by name."""
    files = sorted({file for p in patterns for file in glob.glob(p, recursive=True)})
    if not files:
        raise PlanError(f"{where}: no file matches {', '.join(patterns)}")
    folder = os.path.commonpath([os.path.dirname(file) for file in files])
    names: dict[str, str] = {}
    for file in files:
        name = _without_extension(os.path.relpath(file, folder or "."))
        if name in names:
            raise PlanError(f"{where}: {names[name]} and {file} would both be the log {name}")
        names[name] = file
    ordered = sorted(names, key=lambda name: (_date(name) or "", _natural(name)))
    for order, name in enumerate(ordered, start=1):
        yield Log(name, names[name], _date(name), order)


def _without_extension(path: str) -> str:
    path = path.removesuffix(".gz")
    return os.path.splitext(path)[0]


def _natural(name: str) -> list[tuple[int, str]]:
    """A key by which run2 comes before run10."""
    return [(int(x), "") if x.isdigit() else (-1, x) for x in re.split(r"(\d+)", name)]


def _date(name: str) -> str | None:
    """The first date in a name, with its time of day if there is one, as ISO 8601 has it."""
    for match in DATE.finditer(name):
        numbers = [int(part) for part in match.groups() if part]
        for count in (len(numbers), 3):
            try:
                found = datetime(*numbers[:count])  # type: ignore[arg-type]
            except ValueError:
                continue
            return found.isoformat() if count > 3 else found.date().isoformat()
    return None
