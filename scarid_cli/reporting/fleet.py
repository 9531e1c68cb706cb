"""What a batch left behind: robots, their logs, and which of the logs need a look."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from scarid_cli.algorithms.uncertainty.comparison import LEVEL
from scarid_cli.reporting.fleet_history import History

# What may be found in a log, from the most serious finding to none; the numbers are ranks.
FAILED, CHANGED, DOUBTFUL, CHECK, FINE = range(5)


AMOUNTS = re.compile(r"\s*\([^()]*(?:\([^()]*\)[^()]*)*\)")  # in brackets, which may hold others


@dataclass(frozen=True)
class Log:
    """One log: the columns of the fleet table, with the numbers of the joints in tuples.

    `values` are the other columns by name; a missing value is None.
    """

    values: Mapping[str, Any]
    r2: tuple[float | None, ...]
    r2_validated: tuple[float | None, ...]

    def __getitem__(self, column: str) -> Any:
        return self.values.get(column)

    @property
    def differing(self) -> tuple[str, ...]:
        """The parameters that differ from those of the reference, the most certain first."""
        return listed(self["differing"])

    @property
    def need(self) -> int:
        """The rank of the most serious finding."""
        return self.marks[0][0] if self.marks else FINE

    @property
    def place(self) -> int:
        """What to sort by: less for a log with a more serious finding, and with more of them."""
        found = {rank for rank, _ in self.marks}
        return sum(1 << (FINE - 1 - rank) for rank in range(FINE) if rank not in found)

    @cached_property
    def marks(self) -> tuple[tuple[int, str], ...]:
        """The rank of each finding with a word or two, the most serious first."""
        differs = self["compare"] == "differs"
        found = (
            (FAILED, self["status"] and f"failed: {self['step'] or 'no step'}"),
            (CHANGED, self["change"] if self._changed else differs and "differs"),
            (DOUBTFUL, self["verdict"] not in (None, "good") and self["verdict"]),
            (CHECK, self["check"] not in (None, "ok") and f"check: {self['check']}"),
        )
        return tuple((rank, str(label)) for rank, label in found if label)

    @property
    def _changed(self) -> bool:
        return self["change"] in ("changed", "unexplained")

    @property
    def cause(self) -> str:
        """What has changed, in a few words without amounts; empty if nothing has."""
        if not self._changed:
            return ""
        if self["change"] == "unexplained":
            return "an unexplained change"
        return AMOUNTS.sub("", str(self["change_reason"]).partition(";")[0]).strip()

    @property
    def notes(self) -> tuple[tuple[str, str], ...]:
        """What was found and by which command, the most serious first; empty if nothing was."""
        found = (
            (self["step"] or "error", self["status"] and self._error()),
            ("validate", self._changed and self["change_reason"]),
            ("compare", self["compare"] == "differs" and self._difference()),
            ("identify", self["verdict"] not in (None, "good") and self["reasons"]),
            ("check", self["check"] not in (None, "ok") and self["findings"]),
        )
        return tuple((command, str(text)) for command, text in found if text)

    def _error(self) -> str:
        """The error without the command and the file, which stand beside it."""
        said = str(self["error"] or f"exit status {self['status']}")
        said = said.removeprefix(f"scarid {self['step']}: ").removeprefix(str(self["file"]))
        return said.lstrip(",: ")

    def _difference(self) -> str:
        p = self["p_value"]
        text = f"the parameters differ from those of {self['reference']}"
        text += f": {', '.join(self.differing)}" if self.differing else ""
        return text if p is None or p > LEVEL else f"{text} (p = {p:.1g})"


@dataclass(frozen=True)
class FleetRobot:
    """One robot, its logs in order, and the histories of its parameters."""

    values: Mapping[str, Any]
    logs: tuple[Log, ...]
    histories: Mapping[str, History]

    @property
    def name(self) -> str:
        return str(self.values["robot"])

    @property
    def trending(self) -> tuple[str, ...]:
        """The parameters with a trend over the logs, the strongest first."""
        return listed(self.values.get("trending"))

    @property
    def counts(self) -> tuple[int, ...]:
        """How many logs have a finding of each rank; the last number is of logs without any."""
        found = Counter(rank for log in self.logs for rank, _ in log.marks)
        found[FINE] = sum(not log.marks for log in self.logs)
        return tuple(found[rank] for rank in range(FINE + 1))

    @property
    def needs_look(self) -> bool:
        return bool(self.trending) or any(self.counts[:FINE])

    @property
    def causes(self) -> Counter[str]:
        """In how many logs validate found each cause of a change."""
        return Counter(log.cause for log in self.logs if log.cause)

    @property
    def differing(self) -> Counter[str]:
        """In how many logs each parameter differs from the reference."""
        return Counter(name for log in self.logs for name in log.differing)

    @property
    def joints(self) -> Counter[int]:
        """In how many logs a parameter of each joint differs from the reference."""
        of_logs = (dict.fromkeys(map(joint_of, log.differing)) for log in self.logs)
        return Counter(joint for joints in of_logs for joint in joints if joint)

    @property
    def shown(self) -> tuple[History, ...]:
        """The parameters that are known well enough to show, or that have a trend."""
        found = self.histories.values()
        return tuple(h for h in found if h.essential or h.parameter in self.trending)


def joint_of(parameter: str) -> int | None:
    """The joint or link that a parameter belongs to: the last number of its name."""
    numbers = re.findall(r"\d+", parameter)
    return int(numbers[-1]) if numbers else None


def listed(text: str | None) -> tuple[str, ...]:
    """The names in a text that separates them by commas."""
    return tuple(name.strip() for name in text.split(",") if name.strip()) if text else ()


def fleet(
    robots: Sequence[Mapping[str, Any]],
    logs: Sequence[Mapping[str, Any]],
    histories: Mapping[str, Mapping[str, History]],
) -> tuple[FleetRobot, ...]:
    """The robots with their logs, from the rows of the tables and the histories by robot.

    A robot that only the table of logs has comes last, in the order of that table.
    """
    known = {str(row["robot"]): row for row in robots}
    of_robot: dict[str, list[Log]] = {name: [] for name in known}
    for row in logs:
        of_robot.setdefault(row["robot"], []).append(_log(row))
    return tuple(
        FleetRobot(known.get(name, {"robot": name}), tuple(found), histories.get(name, {}))
        for name, found in of_robot.items()
    )


def _log(row: Mapping[str, Any]) -> Log:
    return Log(row, _per_joint(row, "r2_"), _per_joint(row, "r2_validated_"))


def _per_joint(row: Mapping[str, Any], prefix: str) -> tuple[float | None, ...]:
    """The values of the joints from 1, up to the last one that has a value."""
    values: list[float | None] = []
    while (column := f"{prefix}{len(values) + 1}") in row:
        values.append(row[column])
    while values and values[-1] is None:
        values.pop()
    return tuple(values)
