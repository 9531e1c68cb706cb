"""One card a robot: how many logs, what changed, and the course of its parameters."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from math import inf, isfinite
from statistics import median

from markupsafe import Markup

from scarid_cli.algorithms.statistics.verdict import DOUBT
from scarid_cli.reporting.fleet.reading import (
    CHANGED,
    FAILED,
    STATES,
    Fleet,
    Row,
    differing,
    state,
)
from scarid_cli.reporting.fleet.sparkline import sparkline

SHOWN = 12  # parameters of a robot at most


@dataclass(frozen=True)
class Course:
    """A parameter over the logs: its last estimate as text, whether it trends, and the figure."""

    name: str
    last: str
    differing: int
    trends: bool
    figure: Markup


@dataclass(frozen=True)
class Card:
    """A robot; `counts` are pairs of a number and what it counts, `trend` a sentence."""

    robot: str
    reference: str
    counts: tuple[tuple[str, int, str], ...]
    trend: str
    alarming: bool
    courses: tuple[Course, ...]


def cards(fleet: Fleet) -> list[Card]:
    """The robots, those that need a look first: by failed and changed logs, then by trends."""
    by_robot: dict[str, list[Row]] = {}
    for row in fleet.logs:
        by_robot.setdefault(row["robot"], []).append(row)
    made = [_card(fleet, robot, by_robot.get(robot["robot"], [])) for robot in fleet.robots]
    return sorted(made, key=lambda card: not card.alarming)


def trending(robot: Row) -> list[str]:
    """The parameters of a robot that have a trend, the strongest first."""
    return list(filter(None, (robot.get("trending") or "").split(", ")))


def _card(fleet: Fleet, robot: Row, logs: list[Row]) -> Card:
    counts = Counter(map(state, logs))
    outliers: dict[str, set[str]] = {}
    for row in logs:
        for name in differing(row):
            outliers.setdefault(name, set()).add(row["log"])
    return Card(
        robot=robot["robot"],
        reference=robot.get("reference") or "",
        counts=tuple((key, counts[key], text) for key, text in STATES.items() if counts[key]),
        trend=robot.get("trend") or "",
        alarming=bool(counts[FAILED] + counts[CHANGED] + len(trending(robot))),
        courses=tuple(
            _course(fleet.estimates[robot["robot"], name], outliers.get(name, set()), robot)
            for name in shown(fleet, robot, outliers)
        ),
    )


def shown(fleet: Fleet, robot: Row, outliers: dict[str, set[str]]) -> list[str]:
    """The parameters with a trend, then those in which logs differ, then the well known ones."""
    names = fleet.parameters(robot["robot"])
    trends = [name for name in trending(robot) if name in names]
    apart = sorted((n for n in names if n in outliers), key=lambda n: -len(outliers[n]))
    known = [n for n in names if vagueness(fleet.estimates[robot["robot"], n]) <= DOUBT]
    return list(dict.fromkeys([*trends, *apart, *known]))[:SHOWN]


def vagueness(rows: tuple[Row, ...]) -> float:
    """The median relative standard error [%] of a parameter over the logs; inf if unknown."""
    shares = (100.0 * r["robust_error"] / abs(r["estimate"]) for r in rows if _stated(r))
    known = [share for share in shares if isfinite(share)]
    return median(known) if known else inf


def _stated(row: Row) -> bool:
    return row.get("robust_error") is not None and bool(row["estimate"])


def _course(rows: tuple[Row, ...], outliers: set[str], robot: Row) -> Course:
    last = rows[-1]
    return Course(
        name=last["parameter"],
        last=f"{last['estimate']:.4g} {last.get('unit') or ''}".strip(),
        differing=len(outliers),
        trends=last["parameter"] in trending(robot),
        figure=sparkline(rows, outliers),
    )
