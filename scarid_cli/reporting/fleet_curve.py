"""The history of a parameter as the paths of a small curve, and that of the findings as a strip."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from scarid_cli.arrays import Array, Numbers
from scarid_cli.reporting.fleet import FINE, FleetRobot
from scarid_cli.reporting.fleet_history import History

CELLS = 120  # of a strip at most; more logs share a cell, which shows the most serious finding
DOTS = 200  # logs up to which those that differ have a dot each
MARGIN = 4.0  # above and below the curve, for dots and triangles [px]

Point = tuple[float, float]


@dataclass(frozen=True)
class Axes:
    """Places of logs from 1 to `last` and values between the limits, in a drawing [px]."""

    last: int
    limits: tuple[float, float]
    width: int
    height: int

    def x(self, order: float) -> float:
        return (order - 0.5) * self.width / self.last

    def y(self, value: float) -> float:
        low, high = self.limits
        inside = min(max(value, low), high)
        size = (high - low) or 1.0
        return self.height - MARGIN - (self.height - 2.0 * MARGIN) * (inside - low) / size


@dataclass(frozen=True)
class Curve:
    """Points of a drawing of this width and height, in pixels from the upper left corner.

    `band` is a polygon between the ends of the intervals, and `line` joins the estimates. `dots`
    are logs in which the parameter differs; `beyond` are those outside the axis, which are drawn at
    the edge: the upper one if the last value is True.
    """

    history: History
    width: int
    height: int
    band: str
    line: str
    dots: tuple[Point, ...]
    beyond: tuple[tuple[float, bool], ...]


@dataclass(frozen=True)
class Cell:
    """A part of a strip: where it begins, its width, and the most serious finding."""

    x: float
    width: float
    need: int


def curve(robot: FleetRobot, history: History, width: int, height: int) -> Curve:
    """The history of a parameter in a drawing of this size [px]."""
    last = max([*(int(log["order"]) for log in robot.logs), int(history.order.max())])
    axes = Axes(last, history.limits, width, height)
    top, bottom, line = [], [], []
    for order, low, high, least, greatest in _groups(history, width // 2):
        x = axes.x(order)
        top.append((x, axes.y(high)))
        bottom.append((x, axes.y(low)))
        line += [(x, axes.y(value)) for value in dict.fromkeys((least, greatest))]
    return Curve(
        history=history,
        width=width,
        height=height,
        band=_points([*top, *reversed(bottom)]),
        line=_points(line),
        dots=tuple(_dots(robot, history, axes)),
        beyond=tuple(_beyond(history, axes)),
    )


def strip(robot: FleetRobot, width: int) -> tuple[Cell, ...]:
    """The findings of the logs in order, on a strip of this width [px]."""
    needs = [log.need for log in robot.logs]
    edges = _edges(len(needs), CELLS)
    size = width / max(len(edges) - 1, 1)
    worst = [min(needs[a:b], default=FINE) for a, b in pairwise(edges)]
    return tuple(Cell(round(i * size, 2), round(size, 2), need) for i, need in enumerate(worst))


def _groups(history: History, most: int) -> Iterator[tuple[float, ...]]:
    """The estimates one by one, or in as many groups as the drawing can show.

    A group has the mean of its places, its least and greatest end of an interval, and its least and
    greatest estimate.
    """
    for a, b in pairwise(_edges(len(history.order), most)):
        values, half = history.estimate[a:b], history.half[a:b]
        order: Numbers = history.order[a:b]
        ends: tuple[Array, ...] = (values - half, values + half)
        yield (
            float(order.mean()),
            float(ends[0].min()),
            float(ends[1].max()),
            float(values.min()),
            float(values.max()),
        )


def _edges(count: int, most: int) -> list[int]:
    """Where groups of about the same size begin, and the end of the last one."""
    return [int(x) for x in np.linspace(0, count, min(count, most) + 1).round()]


def _points(points: Sequence[Point]) -> str:
    """Coordinates to a tenth of a pixel, as SVG writes them."""
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _dots(robot: FleetRobot, history: History, axes: Axes) -> Iterator[Point]:
    if len(robot.logs) > DOTS:
        return
    found = {log["order"] for log in robot.logs if history.parameter in log.differing}
    low, high = axes.limits
    for order, value in zip(history.order.tolist(), history.estimate.tolist(), strict=True):
        if order in found and low <= value <= high:
            yield round(axes.x(order), 1), round(axes.y(value), 1)


def _beyond(history: History, axes: Axes) -> Iterator[tuple[float, bool]]:
    low, high = axes.limits
    for order, value in zip(history.order.tolist(), history.estimate.tolist(), strict=True):
        if not low <= value <= high:
            yield round(axes.x(order), 1), value > high
