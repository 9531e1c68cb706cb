"""Forest plots: the estimates of one parameter by every method, with their 95 % intervals."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from math import ceil, isfinite, nan

from scarid_cli.reporting import svg
from scarid_cli.reporting.kinds import Parameters
from scarid_cli.reporting.parts import number
from scarid_cli.reporting.wording import with_unit

WIDTH = 320.0
ROW = 17.0
TOP = 24.0  # the heading
BOTTOM = 20.0  # the axis
LETTER = 6.1  # the mean width of a letter
LABELS = 132.0  # for the names of methods at most
DECIDING = 0.5  # of the intervals, the narrowest, decide the axis; wider ones end in an arrow


@dataclass(frozen=True)
class Row:
    """One method: its estimate, the ends of its interval, a published value; nan where unknown."""

    name: str
    colour: int
    estimate: float
    low: float
    high: float
    published: float = nan

    def words(self) -> str:
        """What stands beside the pointer."""
        ends = [number(self.low), number(self.high)]
        interval = f" [{', '.join(ends)}]" if isfinite(self.high - self.low) else ""
        published = f"; published {self.published:g}" if isfinite(self.published) else ""
        return f"{self.name}: {number(self.estimate)}{interval}{published}"


@dataclass(frozen=True)
class Forest:
    """One parameter under its heading; `level` is its a priori value."""

    heading: str
    rows: tuple[Row, ...]
    level: float = nan

    def limits(self) -> tuple[float, float]:
        """Of the axis: those that the narrower intervals and the a priori value need."""
        by_width = sorted(self.rows, key=_width)
        kept = by_width[: ceil(DECIDING * len(by_width))]
        ends = [x for row in kept for x in (row.low, row.estimate, row.high)]
        return svg.padded([*ends, self.level])


def _width(row: Row) -> float:
    return row.high - row.low if isfinite(row.high - row.low) else float("inf")


def forests(group: Sequence[Parameters], colours: dict[str, int]) -> list[Forest]:
    """One plot for each parameter of tables with the same parameters."""
    own = [r for r in group if not r.name.published]
    first = own[0]
    return [
        Forest(
            with_unit(name, unit),
            tuple(_row(r, group, i, colours) for r in own),
            float(first.robot.apriori[i]) if first.robot else nan,
        )
        for i, (name, unit) in enumerate(zip(first.names, first.units, strict=True))
    ]


def _row(result: Parameters, group: Sequence[Parameters], i: int, colours: dict[str, int]) -> Row:
    label = result.name.label
    printed = (r.estimates[i] for r in group if r.name.published and r.name.label == label)
    low, high = (ends[i] if ends else nan for ends in (result.low, result.high))
    return Row(label, colours[label], result.estimates[i], low, high, next(printed, nan))


def draw(forest: Forest) -> str:
    """The plot as an `<svg>` element."""
    left = min(LABELS, LETTER * max(len(row.name) for row in forest.rows) + 8.0)
    height = TOP + ROW * len(forest.rows) + BOTTOM
    low, high = forest.limits()

    def at(value: float) -> float:
        return left + (WIDTH - 6.0 - left) * (value - low) / (high - low)

    words = "; ".join(row.words() for row in forest.rows)
    label = f"Estimates of {forest.heading} with 95 % intervals. {words}"
    body = [svg.text(left, 14.0, forest.heading, "b")]
    for value, shown in svg.ticks(low, high, 3):
        body.append(svg.line(at(value), TOP - 4.0, at(value), height - BOTTOM + 2.0, "g"))
        body.append(svg.text(at(value), height - 5.0, shown, "m c"))
    if isfinite(forest.level):
        body.append(svg.line(at(forest.level), TOP - 4.0, at(forest.level), height - BOTTOM, "d"))
    for place, row in enumerate(forest.rows):
        y = TOP + ROW * (place + 0.5)
        inner = "".join(_marks(row, y, low, high, left))
        body.append(f'<g class="{svg.colour(row.colour)}"{_data(row)}>{inner}</g>')
    return svg.element(WIDTH, height, label, body)


def _data(row: Row) -> str:
    """The exact numbers, for whoever reads the page with a program."""
    ends = (("low", row.low), ("high", row.high))
    known = "".join(f' data-{name}="{x!r}"' for name, x in ends if isfinite(x))
    return f' data-estimate="{row.estimate!r}"{known}'


def _marks(row: Row, y: float, low: float, high: float, left: float) -> Iterator[str]:
    """The name, the interval, the estimate, and the published value of a method."""
    right = WIDTH - 6.0

    def at(value: float) -> float:
        place = left + (right - left) * (value - low) / (high - low)
        return min(max(place, left), right)

    letters = int((LABELS - 8.0) / LETTER)
    name = row.name if len(row.name) <= letters else f"{row.name[: letters - 1]}…"
    yield f"<title>{escape(row.words())}</title>"
    yield svg.text(left - 8.0, y + 4.0, name, "e")
    if isfinite(row.high - row.low) and row.low <= high and row.high >= low:
        yield svg.line(at(row.low), y, at(row.high), y, "s")
        yield from (_arrow(left, y, -1) for _ in "<" if row.low < low)
        yield from (_arrow(right, y, 1) for _ in ">" if row.high > high)
    if low <= row.estimate <= high:
        yield f'<circle cx="{svg.short(at(row.estimate))}" cy="{svg.short(y)}" r="3.4" class="f"/>'
    else:
        yield _arrow(at(row.estimate), y, 1 if row.estimate > high else -1)
    if low <= row.published <= high:
        x = at(row.published)
        yield f'<circle cx="{svg.short(x)}" cy="{svg.short(y)}" r="3.4" class="h"/>'


def _arrow(x: float, y: float, way: int) -> str:
    """A tip at the end of the axis, of what goes on beyond it."""
    path = f"M{svg.short(x)} {svg.short(y)}l{-6 * way} -4v8z"
    return f'<path d="{path}" class="f"/>'
