"""The forest plot: each estimate with its 95 % interval beside the a priori or true value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from markupsafe import Markup

from scarid_cli.reporting.study import svg
from scarid_cli.reporting.study.intervals import Interval, written

WIDTH, NAMES, NUMBERS = 470, 128, 128  # pixels: the whole, the names, the numbers on the right
TOP, ROW, BOTTOM = 4, 19, 18
LETTERS = 21  # of a name at most
LEADERS = 3  # rows whose intervals the axis shows in full


@dataclass(frozen=True)
class Row:
    """One method: its name, the class of its colour, and its interval."""

    name: str
    style: str
    interval: Interval
    pale: bool = False


def forest(title: str, unit: str, rows: Sequence[Row], known: float | None) -> Markup:
    """The rows of one parameter; the axis shows the intervals of the first few in full.

    What lies beyond the axis ends in an arrow. `known` is the a priori value.
    """
    low, high = limits(rows, known)
    bottom = TOP + ROW * len(rows)
    image = svg.element(
        "svg",
        *_axis(low, high, bottom),
        *_level(known, (low, high), bottom),
        *(part for i, row in enumerate(rows) for part in _row(row, TOP + ROW * i, low, high)),
        viewBox=f"0 0 {WIDTH} {bottom + BOTTOM}",
        role="img",
        aria_label=_spoken(title, unit, rows, known),
        class_="forest",
    )
    apriori = "" if known is None else svg.element("small", f"a priori {known:.4g} {unit}".strip())
    heading = svg.element("h4", f"{title} [{unit}] " if unit else f"{title} ", apriori)
    return svg.element("div", heading, image, class_="panel")


def limits(rows: Sequence[Row], known: float | None) -> tuple[float, float]:
    """The range of the axis: the a priori value and the intervals of the first few methods."""
    first = [row.interval for row in rows if not row.pale][:LEADERS] or [r.interval for r in rows]
    values = [v for i in first for v in (i.low, i.estimate, i.high)]
    return svg.span([*values, *([] if known is None else [known])], 0.12)


def _written(interval: Interval) -> str:
    """The estimate and half its interval as text."""
    estimate, half, _ = written(interval)
    return f"{estimate} ± {half}" if half else estimate


def _spoken(title: str, unit: str, rows: Sequence[Row], known: float | None) -> str:
    values = "; ".join(f"{row.name} {_written(row.interval)}" for row in rows)
    apriori = "" if known is None else f", a priori {known:.4g}"
    return f"{title} {unit} with 95 % intervals{apriori}: {values}"


def _x(value: float, low: float, high: float) -> float:
    wide = WIDTH - NAMES - NUMBERS
    share = (value - low) / (high - low) if isfinite(value) else 0.5
    return NAMES + wide * min(max(share, 0.0), 1.0)


def _axis(low: float, high: float, bottom: float) -> list[Markup]:
    values = svg.ticks(low, high, 5)
    lines = [
        svg.element("path", d=f"M{_x(v, low, high):.1f} {TOP}V{bottom}", class_="grid")
        for v in values
    ]
    texts = [
        svg.element("text", text, x=_x(v, low, high), y=bottom + 13, class_="x")
        for v, text in zip(values, svg.labels(values), strict=True)
    ]
    return [*lines, *texts]


def _level(known: float | None, axis: tuple[float, float], bottom: float) -> list[Markup]:
    if known is None:
        return []
    return [svg.element("path", d=f"M{_x(known, *axis):.1f} {TOP}V{bottom}", class_="level")]


def _row(row: Row, top: float, low: float, high: float) -> list[Markup]:
    middle, i = top + ROW / 2, row.interval
    name = row.name if len(row.name) <= LETTERS else row.name[: LETTERS - 1] + "…"
    parts = [
        svg.element("text", name, x=NAMES - 8, y=middle + 3.5, class_="name"),
        svg.element("text", _written(i), x=WIDTH - NUMBERS + 8, y=middle + 3.5, class_="value"),
    ]
    style = f"{row.style}{' pale' if row.pale else ''}"
    return [*parts, svg.element("g", *_marks(i, middle, low, high), class_=style)]


def _marks(i: Interval, y: float, low: float, high: float) -> list[Markup]:
    """The interval, the estimate if it is on the axis, and arrows at the ends that are not."""
    marks = []
    if isfinite(i.half):
        ends = _x(i.low, low, high), _x(i.high, low, high)
        marks.append(svg.element("path", d=f"M{ends[0]:.1f} {y}H{ends[1]:.1f}", class_="bar"))
    if low <= i.estimate <= high:
        marks.append(svg.element("circle", cx=_x(i.estimate, low, high), cy=y, r=3.6))
    if min(i.estimate, i.low if isfinite(i.low) else i.estimate) < low:
        marks.append(svg.element("path", d=f"M{NAMES} {y}l7 -4v8z"))
    if max(i.estimate, i.high if isfinite(i.high) else i.estimate) > high:
        marks.append(svg.element("path", d=f"M{WIDTH - NUMBERS} {y}l-7 -4v8z"))
    return marks
