"""The figure of the first screen: what each method is worth, on a logarithmic axis in percent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, isfinite, log10

from markupsafe import Markup

from scarid_cli.reporting.study import svg
from scarid_cli.words import of_joints

WIDTH, NAMES, NUMBERS = 640, 160, 130
TOP, ROW, BOTTOM = 20, 22, 34
LETTERS = 26
SHOWN = 3  # values in numbers; of more, the least and the largest
SPREAD = 7.0  # of the marks of a row that have bars of their own
LEAST, MOST = 1e-3, 1e5  # percent: the axis ends there at the latest
APART = 60  # between the labels of decades


@dataclass(frozen=True)
class Place:
    """One row: its name, the class of its colour, its verdict, and a value [%] for each mark.

    `ranges` are the ends of a bar through each mark; without them one bar joins all marks.
    """

    name: str
    style: str
    grade: str
    values: tuple[float, ...]
    ranges: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class League:
    """Rows with the same marks; values above `limit` are doubtful, those above `most` all alike."""

    caption: str
    axis: str
    marks: tuple[str, ...]
    places: tuple[Place, ...]
    limit: float | None = None
    most: float = MOST

    def text(self, values: Sequence[float]) -> str:
        """The values with their percent sign."""
        if any(v > self.most for v in values):
            return f"over {self.most:g} %"
        if len(values) > SHOWN:
            return f"{percents([min(values)])} to {percents([max(values)])} %"
        return f"{percents(values)} %"


def drawn(league: League) -> Markup:
    """The figure as an SVG element."""
    low, high = decades(league)
    bottom = TOP + ROW * len(league.places)
    marks = league.marks if len(league.marks) > 1 else ()
    return svg.element(
        "svg",
        *_axis(league, low, high, bottom),
        *(
            part
            for i, p in enumerate(league.places)
            for part in _row(league, p, TOP + ROW * i, low, high)
        ),
        *_legend(marks),
        viewBox=f"0 0 {WIDTH} {bottom + BOTTOM}",
        role="img",
        aria_label=_spoken(league),
        class_="league",
    )


def decades(league: League) -> tuple[int, int]:
    """The powers of ten between which all values lie."""
    values = [
        v for p in league.places for v in (*p.values, *(x for ends in p.ranges for x in ends))
    ]
    known = [v for v in values if isfinite(v) and v > 0.0]
    known = [min(max(v, LEAST), league.most) for v in known] or [1.0]
    low, high = floor(log10(min(known))), ceil(log10(max(known)))
    return low, max(high, low + 1)


def percents(values: Sequence[float]) -> str:
    """The values with two significant digits, as a sentence would have them."""
    return ", ".join(f"{v:,.0f}" if v >= 100.0 else f"{v:.2g}" for v in values if isfinite(v))


def joint_percents(values: Sequence[float]) -> str:
    """A value [%] for each joint: `joint 1 1.4 %, joint 2 6.2 %`."""
    return of_joints([percents([value]) for value in values], " %")


def _spoken(league: League) -> str:
    rows = (f"{p.name} {league.text(p.values)}" for p in league.places)
    return f"{league.caption} {'; '.join(rows)}"


def _x(value: float, low: int, high: int) -> float:
    share = (min(max(log10(value), low), high) - low) / (high - low)
    return NAMES + (WIDTH - NAMES - NUMBERS) * share


def _axis(league: League, low: int, high: int, bottom: float) -> list[Markup]:
    parts, decade = [], (WIDTH - NAMES - NUMBERS) / (high - low)
    for power in range(low, high + 1):
        x = _x(10.0**power, low, high)
        parts.append(svg.element("path", d=f"M{x:.1f} {TOP}V{bottom}", class_="grid"))
        if (high - power) % ceil(APART / decade):
            continue
        parts.append(svg.element("text", f"{10.0**power:g} %", x=x, y=bottom + 13, class_="x"))
    if league.limit:
        x = _x(league.limit, low, high)
        parts.append(svg.element("path", d=f"M{x:.1f} {TOP}V{bottom}", class_="level"))
    middle = NAMES + (WIDTH - NAMES - NUMBERS) / 2
    return [*parts, svg.element("text", league.axis, x=middle, y=bottom + 28, class_="x")]


def _row(league: League, place: Place, top: float, low: int, high: int) -> list[Markup]:
    y = top + ROW / 2
    name = place.name if len(place.name) <= LETTERS else place.name[: LETTERS - 1] + "…"
    parts = _marks(place, y, low, high)
    text = league.text(place.values) if parts else "unknown"
    return [
        svg.element("text", name, x=NAMES - 10, y=y + 3.5, class_="name"),
        svg.element("g", *parts, class_=place.style),
        svg.element("text", text, x=WIDTH - NUMBERS + 10, y=y + 3.5, class_="value"),
    ]


def _marks(place: Place, y: float, low: int, high: int) -> list[Markup]:
    """The marks of a row, and the bar that joins them, or one through each of them."""
    known = [(k, v) for k, v in enumerate(place.values) if isfinite(v) and v > 0.0]
    marks = {k: _x(v, low, high) for k, v in known}
    heights = dict.fromkeys(marks, y)
    bars = [(y, [*marks.values()])] if marks else []
    if place.ranges:
        between = SPREAD / max(len(place.values) - 1, 1)
        heights = {k: y + between * k - SPREAD / 2 for k in marks}
        bars = [(heights[k], [_x(end, low, high) for end in place.ranges[k]]) for k in marks]
    lines = [
        svg.element("path", d=f"M{min(xs):.1f} {at:.1f}H{max(xs):.1f}", class_="bar")
        for at, xs in bars
    ]
    return [*lines, *(mark(k, x, heights[k]) for k, x in marks.items())]


def mark(number: int, x: float, y: float) -> Markup:
    """The mark of a joint: filled and hollow circles and squares, then their numbers."""
    if number >= 4:
        return svg.element("text", str(number + 1), x=x, y=y + 3.5, class_="digit")
    hollow = " hollow" if number % 2 else ""
    if number < 2:
        return svg.element("circle", cx=x, cy=y, r=4.2, class_=f"mark{hollow}")
    return svg.element("rect", x=x - 3.8, y=y - 3.8, width=7.6, height=7.6, class_=f"mark{hollow}")


def _legend(marks: Sequence[str]) -> list[Markup]:
    parts, x = [], float(NAMES)
    for k, name in enumerate(marks):
        parts.append(svg.element("g", mark(k, x + 5, 9), class_="plain"))
        parts.append(svg.element("text", name, x=x + 14, y=12.5, class_="legend"))
        x += 26 + 6.2 * len(name)
    return parts
