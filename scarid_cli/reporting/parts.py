"""What a section of a report is made of: a table, and plots."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite
from typing import Any

from scarid_cli.arrays import Array

NONE = "-"


@dataclass(frozen=True)
class Bars:
    """One bar per name; `colours` are the numbers of the labels, pale ones are published."""

    caption: str
    axis: str
    names: tuple[str, ...]
    values: tuple[float, ...]
    colours: tuple[int, ...]
    pale: tuple[bool, ...]
    doubt: float


@dataclass(frozen=True)
class Line:
    """A curve (2, points) of a panel; `colour` is that of a label, None that of measurements."""

    name: str
    colour: int | None
    points: Array


@dataclass(frozen=True)
class Panel:
    """Curves over time; `level` is a horizontal line, `limits` those of the vertical axis."""

    axis: str
    lines: tuple[Line, ...]
    level: float | None = None
    limits: tuple[float, float] | None = None


@dataclass(frozen=True)
class Panels:
    """Panels under each other in columns, with one legend; `level` names the horizontal lines."""

    caption: str
    panels: tuple[Panel, ...]
    columns: int
    level: str = ""


Plot = Bars | Panels


@dataclass(frozen=True)
class Section:
    """A table under a title and a note; without rows only its plots are shown.

    The first `keys` columns tell what a row is, the first `texts` of them in words; the others
    belong together in groups of `group`. With `prose` the last column holds sentences.
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
    """Four significant digits, whole numbers in full; what does not exist is a dash."""
    if isinstance(value, int) and not isinstance(value, bool):
        return str(value)
    if not isinstance(value, float) or not isfinite(value):
        return NONE
    # Adding zero turns -0.0 into 0.0; the alternative form keeps zeros but also a last point.
    return f"{value + 0.0:#.4g}".rstrip(".")


def split(section: Section, width: int, gap: int, *, wrapped: bool = False) -> list[Section]:
    """The section, or, where its table is wider than this many characters, parts side by side.

    Columns are `gap` characters apart; `wrapped` headers have their unit on a line of its
    own. Each part repeats the key columns; no part is empty.
    """
    columns = list(zip(section.headers, *section.rows, strict=True))
    widths = [_width(column, wrapped=wrapped) + gap for column in columns]
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


def _width(column: tuple[str, ...], *, wrapped: bool) -> int:
    header, *cells = column
    lines = header.replace(" [", "\n[").split("\n") if wrapped else [header]
    return max(map(len, (*lines, *cells)))


def _part(section: Section, columns: list[tuple[str, ...]], chosen: list[int]) -> Section:
    headers, *rows = zip(*(columns[i] for i in chosen), strict=True)
    return replace(section, headers=headers, rows=tuple(rows))
