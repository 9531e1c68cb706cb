"""A plot in characters, for a terminal of any width, with and without colours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from math import isfinite

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.reporting.curves import broken
from scarid_cli.reporting.parts import Panel, Panels, Range, Ranges, Series
from scarid_cli.reporting.plotting.canvas import Canvas, Limits

LABEL = 9  # characters of a number beside the axis
NARROWEST = 38  # characters of a panel, below which panels stand below each other
LEAST, MOST = 24, 1000  # characters of a plot
GAP = 2  # characters between panels
LINES = 36  # of all panels, if that leaves enough for each
LOWEST, HIGHEST = 4, 10  # lines of a panel
COLOURS = ("", "33", "36", "35", "32", "31")  # the first curve is in the colour of the text
MARKS = " ×+o#%"  # where only another curve than the first is, and there are no colours


@dataclass(frozen=True)
class Screen:
    """The width in characters that the window has, and whether there are colours."""

    window: int
    coloured: bool

    @property
    def width(self) -> int:
        """The width that is drawn; $COLUMNS may say anything."""
        return min(max(self.window, LEAST), MOST)

    def paint(self, text: str, curve: int | None) -> str:
        """The text in the colour of a curve."""
        code = COLOURS[curve % len(COLOURS)] if curve and self.coloured else ""
        return f"\033[{code}m{text}\033[0m" if code else text

    def bold(self, text: str) -> str:
        """The text in bold, where there are colours."""
        return f"\033[1m{text}\033[0m" if self.coloured else text


def lines(plot: Panels | Ranges, screen: Screen) -> Iterator[str]:
    """The lines of a plot."""
    yield screen.bold(plot.caption)
    yield from _forest(plot, screen) if isinstance(plot, Ranges) else _panels(plot, screen)


def _panels(plot: Panels, screen: Screen) -> Iterator[str]:
    """The panels in rows; those of a joint stay in one row where it is wide enough."""
    room = max(1, (screen.width + GAP) // (NARROWEST + GAP))
    columns = max(n for n in range(1, plot.columns + 1) if plot.columns % n == 0 and n <= room)
    width = (screen.width - GAP * (columns - 1)) // columns
    rows = [plot.panels[i : i + columns] for i in range(0, len(plot.panels), columns)]
    height = min(max(LINES // len(rows) - 1, LOWEST), HIGHEST)
    across = _limits(plot.panels, 0, logarithmic=plot.logarithmic)
    for row in rows:
        drawn = [_panel(panel, plot, across, (width, height), screen) for panel in row]
        yield from (_joined(parts) for parts in zip_longest(*drawn, fillvalue=""))
    below = [_scale(across, plot, width)] * len(rows[-1])
    yield _joined(below)


def _joined(parts: Sequence[str]) -> str:
    return (" " * GAP).join(parts).rstrip()


def _panel(
    panel: Panel, plot: Panels, across: Limits, size: tuple[int, int], screen: Screen
) -> Iterator[str]:
    """The title, and the curves beside their axis; every line is `width` characters wide."""
    width, height = size
    up = _limits([panel], 1, logarithmic=plot.logarithmic)
    canvas = Canvas(width - LABEL - 2, height, across, up)
    for series in panel.series:
        canvas.curve(_points(series, plot))
    yield _title(panel, width, screen)
    for i, cells in enumerate(canvas.characters()):
        text = "".join(_cell(c, curve, screen) for c, curve in cells)
        yield f"{_label(i, height, up, plot):>{LABEL}} ┤{text}"


def _cell(character: str, curve: int | None, screen: Screen) -> str:
    if curve and not screen.coloured:
        return MARKS[curve % len(MARKS)]
    return " " if curve is None else screen.paint(character, curve)


def _title(panel: Panel, width: int, screen: Screen) -> str:
    """The axis, and the names of the other curves in their colours or with their marks."""
    names = [panel.axis]
    for k, series in enumerate(panel.series[1:], start=1):
        names.append(series.name if screen.coloured else f"{MARKS[k % len(MARKS)]} {series.name}")
    start = " " * (LABEL + 2)
    room = width - len(start)
    shown, used = [], 0
    for k, name in enumerate(names):
        text = name[: max(room - used, 0)]
        used += len(text) + 2
        shown.append(screen.paint(text, k))
    return start + "  ".join(shown) + " " * max(room - used + 2, 0)


def _label(line: int, height: int, limits: Limits, plot: Panels) -> str:
    """The number at a line of the axis: at its ends, and at zero if that is between them."""
    low, high = limits
    zero = round((height - 1) * high / (high - low)) if low < 0.0 < high else -1
    if line in (0, height - 1):
        return _number(high if line == 0 else low, logarithmic=plot.logarithmic)
    return "0" if line == zero and not plot.logarithmic else ""


def _number(value: float, *, logarithmic: bool) -> str:
    return f"{10.0**value if logarithmic else value:.3g}"


def _scale(across: Limits, plot: Panels, width: int) -> str:
    """The ends of the horizontal axis, and its name between them."""
    low, high = (_number(x, logarithmic=plot.logarithmic) for x in across)
    room = width - LABEL - 2
    middle = f"{plot.across:^{max(room - len(low) - len(high), 0)}}"
    return " " * (LABEL + 2) + f"{low}{middle}{high}"


def _points(series: Series, plot: Panels) -> Array:
    if plot.logarithmic:
        found: Array = np.log10(series.points)
        return found
    return broken(series.points)


def _limits(panels: Sequence[Panel], axis: int, *, logarithmic: bool) -> Limits:
    """The least and the greatest value of an axis; some room about a constant."""
    parts = [series.points[axis] for panel in panels for series in panel.series]
    values = np.concatenate(parts)
    values = values[np.isfinite(values)]
    if logarithmic:
        values = np.log10(values)
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)
    if high - low > 1e-12 * max(abs(low), abs(high)):
        return low, high
    room = 0.5 * abs(low) or 1.0
    return low - room, high + room


def _forest(plot: Ranges, screen: Screen) -> Iterator[str]:
    """A line for each value: its name, its interval as text, and as a bar in percent of it."""
    texts = [(row.name, _value(row), _half(row)) for row in plot.rows]
    widths = [max(map(len, column)) for column in zip(*texts, strict=True)]
    used = sum(widths) + 2 * len(widths)
    width = max(screen.width - used, 11)
    width -= 1 - width % 2  # a place for zero in the middle
    for row, text in zip(plot.rows, texts, strict=True):
        name, value, half = text
        start = f"{name:<{widths[0]}}  {value:>{widths[1]}}  {half:<{widths[2]}}  "
        yield (start + _bar(row, plot.widest, width)).rstrip()
    end = f"{plot.widest:.3g} %"
    left, right = f"-{end}", f"+{end}"
    middle = width // 2 - len(left)
    yield " " * used + f"{left}{'0':>{middle + 1}}{right:>{width - len(left) - middle - 1}}"
    yield f"{'95 % interval, in percent of the estimate':>{used + width}}"


def _value(row: Range) -> str:
    return f"{row.value:.4g} {row.unit}".rstrip() if row.unit else f"{row.value:.4g}"


def _half(row: Range) -> str:
    half = (row.high - row.low) / 2.0
    return f"± {half:.2g}" if isfinite(half) else "unknown"


def _bar(row: Range, widest: float, width: int) -> str:
    """The interval about the value, which is in the middle; an arrow where it goes on."""
    middle = width // 2
    cells = [" "] * width
    for end, step, arrow in zip(row.shares(), (-1, 1), "◄►", strict=True):
        if np.isnan(end):
            continue
        reach = min(abs(end) / widest * middle, middle)
        for k in range(1, round(reach) + 1):
            cells[middle + step * k] = "─"
        if abs(end) > widest:
            cells[middle + step * middle] = arrow
    cells[middle] = "●"
    return "".join(cells)
