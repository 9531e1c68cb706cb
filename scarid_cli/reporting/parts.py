"""What a section of a report is made of: a table and plots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import copysign, inf, isfinite
from typing import Any

from scarid_cli.arrays import Array

NONE = "-"
GAP = 2  # characters between the columns of a table
PANELS = 8  # of a figure at most, so that it fits a page
ENOUGH = 100.0  # percent: an interval that is wider than its value on a side contains zero


@dataclass(frozen=True)
class Bars:
    """One bar for each name; `colours` are the numbers of the labels, `pale` bars are published.

    `doubt` is the value above which the parameters of a bar are doubtful.
    """

    caption: str
    axis: str
    names: tuple[str, ...]
    values: tuple[float, ...]
    colours: tuple[int, ...]
    pale: tuple[bool, ...]
    doubt: float


@dataclass(frozen=True)
class Series:
    """A named curve (2, points) of a panel; `colour` is None for measurements and true signals."""

    name: str
    colour: int | None
    points: Array


@dataclass(frozen=True)
class Panel:
    """Curves over time; `level` is a horizontal line, `limits` those of the vertical axis."""

    axis: str
    series: tuple[Series, ...]
    level: float | None = None
    limits: tuple[float, float] | None = None


@dataclass(frozen=True)
class Panels:
    """Panels in columns with one legend above; `level` names their horizontal lines.

    `across` names the horizontal axis of all panels. Both axes may be `logarithmic`.
    """

    caption: str
    panels: tuple[Panel, ...]
    columns: int
    level: str = ""
    across: str = "t [s]"
    logarithmic: bool = False


@dataclass(frozen=True)
class Range:
    """A value with the ends of its 95 % interval, nan where unknown."""

    name: str
    unit: str
    value: float
    low: float
    high: float

    def shares(self) -> tuple[float, float]:
        """By how many percent of the value the ends differ from it; infinite at a value of zero."""
        low, high = (_percent(end - self.value, self.value) for end in (self.low, self.high))
        return low, high


@dataclass(frozen=True)
class Ranges:
    """Values with their intervals, as a forest: the ends in percent of each value."""

    caption: str
    rows: tuple[Range, ...]

    @property
    def widest(self) -> float:
        """The end of the axis [%]: the widest interval, but at most ENOUGH."""
        ends = [abs(end) for row in self.rows for end in row.shares() if isfinite(end)]
        return min(1.05 * max(ends, default=ENOUGH) or ENOUGH, ENOUGH)


def _percent(part: float, whole: float) -> float:
    return 100.0 * part / abs(whole) if whole else copysign(inf, part) if part else part


Plot = Bars | Panels | Ranges


@dataclass(frozen=True)
class Section:
    """A table under a title and a note; without rows only its plots are shown.

    The first `keys` columns identify a row, and the first `texts` columns are words rather than
    numbers. The columns after the keys belong together in groups of `group`. With `prose` the last
    column holds sentences.
    """

    title: str
    note: str
    headers: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    texts: int = 1
    keys: int = 1
    group: int = 1
    prose: bool = False
    plots: tuple[Plot, ...] = ()


def number(value: Any) -> str:
    """Four significant digits, integers in full, and a dash for what is not a number."""
    if isinstance(value, int) and not isinstance(value, bool):
        return str(value)
    if not isinstance(value, float) or not isfinite(value):
        return NONE
    # Adding zero turns -0.0 into 0.0; the alternative form keeps zeros but also a last point.
    return f"{value + 0.0:#.4g}".rstrip(".")


def pages(panels: Sequence[Panel]) -> list[tuple[Panel, ...]]:
    """The panels in figures that fit a page."""
    return [tuple(panels[i : i + PANELS]) for i in range(0, len(panels), PANELS)]


def split(section: Section, width: int, *, wrapped: bool = False) -> list[Section]:
    """The section in parts of at most `width` characters, each of which repeats the key columns.

    A group of columns is never divided. `wrapped` headers are broken into the lines of
    `header_lines`.
    """
    columns = list(zip(section.headers, *section.rows, strict=True))
    widths = [_width(column, wrapped=wrapped) + GAP for column in columns]
    left = width - sum(widths[: section.keys])
    parts: list[list[int]] = [[]]
    used = 0
    for start in range(section.keys, len(columns), section.group):
        group = list(range(start, start + section.group))
        size = sum(widths[i] for i in group)
        if parts[-1] and used + size > left:
            parts.append([])
            used = 0
        parts[-1] += group
        used += size
    return [_part(section, columns, [*range(section.keys), *part]) for part in parts]


def header_lines(header: str) -> list[str]:
    """Where a header may be broken: after the experiment, and before the unit."""
    return header.replace(": ", ":\n").replace(" [", "\n[").split("\n")


def _width(column: tuple[str, ...], *, wrapped: bool) -> int:
    header, *cells = column
    lines = header_lines(header) if wrapped else [header]
    return max(map(len, (*lines, *cells)))


def _part(section: Section, columns: list[tuple[str, ...]], chosen: list[int]) -> Section:
    headers, *rows = zip(*(columns[i] for i in chosen), strict=True)
    return replace(section, headers=headers, rows=tuple(rows))
