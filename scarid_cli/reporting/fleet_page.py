"""The page of a fleet: a summary by robot, and a table of logs that a script sorts and filters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment

from scarid_cli import __version__
from scarid_cli.reporting.fleet import FINE, FleetRobot, Log
from scarid_cli.reporting.fleet_curve import Cell, Curve, curve, strip
from scarid_cli.reporting.fleet_data import embedded, href
from scarid_cli.reporting.fleet_sections import (
    NOTE,
    WORDS,
    causes,
    counted,
    failures,
    joints,
    level,
    named,
    trend,
)
from scarid_cli.reporting.templates import templates

CURVES = 3  # of a robot in the summary at most
WIDTH, HEIGHT = 190, 60  # of a curve [px]
STRIP = 260  # the width of a strip [px]
STATIC = 300  # logs in the table for print and for browsers without scripts
HEIGHTS = (0, 3, 6, 9, 12)  # where the cell of a strip begins, by its finding
CARDS = 10  # robots of the summary that are not folded


@dataclass(frozen=True)
class Card:
    """What the summary says of a robot that needs a look."""

    robot: FleetRobot
    index: int
    counts: tuple[str, ...]
    trend: str
    causes: str
    differing: str
    joints: str
    failures: tuple[tuple[str, Log], ...]
    cells: tuple[Cell, ...]
    curves: tuple[Curve, ...]

    @property
    def found(self) -> int:
        """The number of logs that need a look."""
        return len(self.robot.logs) - self.robot.counts[FINE]


def html(title: str, robots: Sequence[FleetRobot], base: str, *, tsv: bool) -> str:
    """The whole page; `base` is the path from it to the folder of the fleet.

    `tsv` says whether the table is there as fleet.tsv too.
    """
    template = _environment().get_template("fleet.html")
    return template.render(
        title=title,
        robots=robots,
        data=embedded(robots, base),
        tsv=href(base, "fleet.tsv") if tsv else None,
        href=lambda path: href(base, path),
        **_summary(robots),
    )


def _summary(robots: Sequence[FleetRobot]) -> dict[str, Any]:
    """What the page says without its script."""
    cards = [_card(i, robot) for i, robot in enumerate(robots) if robot.needs_look]
    cards.sort(key=lambda card: (not card.robot.trending, -card.found))
    worst = [(robot, log) for robot in robots for log in robot.logs if log.need < FINE]
    worst.sort(key=lambda pair: pair[1].place)
    return {
        "cards": cards[:CARDS],
        "folded": cards[CARDS:],
        "fine": [robot for robot in robots if not robot.needs_look],
        "trending": [robot.name for robot in robots if robot.trending],
        "totals": [sum(n) for n in zip(*(robot.counts for robot in robots), strict=True)],
        "logs": sum(len(robot.logs) for robot in robots),
        "worst": worst[:STATIC],
        "left_out": len(worst) - STATIC,
    }


def _card(index: int, robot: FleetRobot) -> Card:
    names = dict.fromkeys([*robot.trending, *(name for name, _ in robot.differing.most_common())])
    chosen = [robot.histories[name] for name in names if name in robot.histories]
    return Card(
        robot=robot,
        index=index,
        counts=named(robot.counts),
        trend=trend(robot),
        causes=causes(robot),
        differing=", ".join(f"{name} in {n}" for name, n in robot.differing.most_common(6)),
        joints=joints(robot),
        failures=failures(robot),
        cells=strip(robot, STRIP),
        curves=tuple(curve(robot, history, WIDTH, HEIGHT) for history in chosen[:CURVES]),
    )


def _environment() -> Environment:
    """The templates, with what does not depend on the fleet."""
    environment = templates(Path(__file__).parent)
    environment.globals.update(
        version=__version__,
        words=WORDS,
        note=NOTE,
        strip=STRIP,
        heights=HEIGHTS,
        counted=counted,
        level=level,
    )
    return environment
