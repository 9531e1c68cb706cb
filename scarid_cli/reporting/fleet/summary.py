"""What a fleet needs, in a sentence and as tables for the terminal and for Markdown."""

from __future__ import annotations

from collections import Counter

from scarid_cli.reporting.fleet.cards import trending
from scarid_cli.reporting.fleet.reading import (
    CHANGED,
    DOUBTED,
    FAILED,
    FINE,
    NOTICED,
    STATES,
    Fleet,
    remark,
    state,
)
from scarid_cli.reporting.parts import NONE, Section

LISTED = 50  # logs of the printed table at most


def counts(fleet: Fleet) -> Counter[str]:
    """How many logs are in each state."""
    return Counter(map(state, fleet.logs))


def headline(fleet: Fleet) -> str:
    """What needs a look, or that nothing does."""
    number = counts(fleet)
    drifting = [robot["robot"] for robot in fleet.robots if trending(robot)]
    parts = [
        f"{number[FAILED]} failed" if number[FAILED] else "",
        f"{number[CHANGED]} changed" if number[CHANGED] else "",
        f"{number[DOUBTED]} not good" if number[DOUBTED] else "",
    ]
    trend = _trend(drifting)
    found = ", ".join(filter(None, parts)) or "no log failed or changed"
    logs, robots = len(fleet.logs), len(fleet.robots)
    return f"{logs:,} logs of {robots} robot{'' if robots == 1 else 's'}: {found}{trend}"


def _trend(drifting: list[str]) -> str:
    if not drifting:
        return ""
    names = ", ".join(drifting[:4]) + (" and others" if len(drifting) > 4 else "")
    return f"; parameters of {names} have a trend"


def sections(fleet: Fleet) -> list[Section]:
    """The robots, and the logs that need a look, with the failures first."""
    found = [_robots(fleet)]
    logs = [row for row in fleet.logs if state(row) not in (FINE, NOTICED)]
    if logs:
        more = len(logs) - LISTED
        note = f"{more:,} others are in fleet.tsv." if more > 0 else ""
        rows = tuple(
            (r["robot"], r["log"], STATES[state(r)], remark(r) or NONE) for r in logs[:LISTED]
        )
        headers = ("robot", "log", "state", "remark")
        title = "Logs that need a look"
        found.append(Section(title, note, headers, rows, texts=4, keys=4, prose=True))
    return found


def _robots(fleet: Fleet) -> Section:
    numbers = Counter((row["robot"], state(row)) for row in fleet.logs)
    rows = tuple(
        (
            robot["robot"],
            *(str(numbers[robot["robot"], key]) for key in STATES),
            robot.get("trend") or NONE,
        )
        for robot in fleet.robots
    )
    headers = ("robot", *STATES.values(), "trend")
    return Section("Robots", headline(fleet), headers, rows, texts=7, keys=7, prose=True)
