"""The fleet in words: sections for the terminal and for Markdown, and sentences for the page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from scarid_cli.printable import printable
from scarid_cli.reporting.fleet import FINE, FleetRobot, Log
from scarid_cli.reporting.fleet_history import History
from scarid_cli.reporting.parts import NONE, Section

CAUSES = 3  # of a robot that are named at most
WORDS = ("failed", "changed", "verdict not good", "check not ok", "nothing found")
NOTE = (
    "Failed: a command ended with an error. Changed: validate found a change against other logs of "
    "the robot, or compare one against the reference log. A log may have several findings."
)


def sections(robots: Sequence[FleetRobot]) -> list[Section]:
    """The robots, and the logs that need a look, the most serious findings first."""
    found = [(robot.name, log) for robot in robots for log in robot.logs if log.need < FINE]
    found.sort(key=lambda pair: pair[1].place)
    return [
        Section(
            "Robots",
            NOTE,
            ("robot", "logs", *WORDS, "trend"),
            tuple(_summary(robot) for robot in robots),
            prose=True,
        ),
        Section(
            "What has changed",
            "The causes that validate found, those of most logs first.",
            ("robot", "causes"),
            tuple((printable(robot.name), causes(robot)) for robot in robots if robot.causes),
            texts=2,
            prose=True,
        ),
        Section(
            "Logs that need a look",
            "",
            ("robot", "log", "finding", "reason"),
            tuple(
                (printable(name), printable(log["log"]), _labels(log), _reason(log.notes))
                for name, log in found
            ),
            texts=4,
            keys=2,
            prose=True,
        ),
    ]


def _summary(robot: FleetRobot) -> tuple[str, ...]:
    counts = (len(robot.logs), *robot.counts)
    trending = ", ".join(robot.trending) or NONE
    return (printable(robot.name), *map(str, counts), printable(trending))


def causes(robot: FleetRobot) -> str:
    """What validate found to have changed, the most frequent first: `another payload in 2 logs`."""
    found = robot.causes.most_common()
    return printable("; ".join(f"{cause} in {counted(n, 'log')}" for cause, n in found[:CAUSES]))


def _labels(log: Log) -> str:
    return printable(", ".join(label for _, label in log.marks))


def _reason(notes: tuple[tuple[str, str], ...]) -> str:
    return printable(notes[0][1]) if notes else NONE


def counted(count: int, noun: str) -> str:
    """A number of things: 1 log, 2,000 logs."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def named(counts: Sequence[int]) -> tuple[str, ...]:
    """The counts of findings that are not zero, in words."""
    return tuple(f"{n:,} {word}" for n, word in zip(counts, WORDS, strict=True) if n)


def trend(robot: FleetRobot) -> str:
    """What compare said of the trend; empty if there is none."""
    said = str(robot.values.get("trend") or ", ".join(robot.trending))
    return said.removeprefix("trend ") if robot.trending else ""


def failures(robot: FleetRobot) -> tuple[tuple[str, Log], ...]:
    """For each command that failed: in how many logs, and the first of them."""
    first: dict[str, Log] = {}
    for log in robot.logs:
        if log["status"]:
            first.setdefault(log.marks[0][1], log)
    found = Counter(log.marks[0][1] for log in robot.logs if log["status"])
    return tuple((f"{label} in {counted(found[label], 'log')}", first[label]) for label in first)


def joints(robot: FleetRobot) -> str:
    """The joints whose parameters differ, those of most logs first."""
    found = robot.joints.most_common()
    return ", ".join(f"joint {joint} in {counted(count, 'log')}" for joint, count in found)


def level(robot: FleetRobot, history: History) -> str:
    """The first and the last value of a parameter with a trend; of another one, what is typical.

    Values outside the axis are no part of a trend.
    """
    low, high = history.limits
    inside = history.estimate[(history.estimate >= low) & (history.estimate <= high)]
    digits = max(0, history.decimals)
    if history.parameter in robot.trending:
        return f"{inside[0]:.{digits}f} → {inside[-1]:.{digits}f} {history.unit}"
    middle, half = float(np.median(history.estimate)), float(np.median(history.half))
    return f"{middle:.{digits}f} ± {half:.{digits}f} {history.unit}"
