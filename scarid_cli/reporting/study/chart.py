"""Curves over time: small panels that share a legend, and can be enlarged in the browser."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from scarid_cli.arrays import Array
from scarid_cli.reporting.study import svg

NARROW, WIDE = 340, 500  # pixels of a panel, of three or two of which side by side
LEFT, RIGHT = 46, 6
TOP, BOTTOM = 6, 18
TIME = "t [s]"
INK = "ink"  # the class of measured and true signals


@dataclass(frozen=True)
class Line:
    """A curve (2, points); `style` is the class of its colour. Curves that are `off` are hidden."""

    name: str
    style: str
    points: Array
    off: bool = False


@dataclass(frozen=True)
class Chart:
    """A panel: its title, its lines, the range of its vertical axis, and a level to be marked.

    `height` is that of the plot in pixels.
    """

    title: str
    lines: tuple[Line, ...]
    limits: tuple[float, float]
    level: float | None = None
    height: int = 104
    note: str = ""
    width: int = NARROW

    @property
    def across(self) -> int:
        """The width of the plot in pixels."""
        return self.width - LEFT - RIGHT


def times(charts: Sequence[Chart]) -> tuple[float, float]:
    """The time [s] from the first to the last sample of all curves."""
    ends = [line.points[0, [0, -1]] for chart in charts for line in chart.lines]
    first = min((float(end[0]) for end in ends), default=0.0)
    last = max((float(end[1]) for end in ends), default=1.0)
    return first, last if last > first else first + 1.0


def drawn(chart: Chart, between: tuple[float, float]) -> Markup:
    """The panel as an SVG element with a title above it."""
    plot = svg.element(
        "svg",
        *_content(chart, between),
        class_="plot",
        x=LEFT,
        y=TOP,
        width=chart.across,
        height=chart.height,
        viewBox=f"0 0 {svg.WIDTH} {svg.HEIGHT}",
        preserveAspectRatio="none",
    )
    size = f"0 0 {chart.width} {TOP + chart.height + BOTTOM}"
    image = svg.element(
        "svg",
        _frame(chart),
        *_vertical(chart),
        *_horizontal(chart, between),
        svg.element("text", TIME, x=LEFT - 5, y=TOP + chart.height + 13, class_="y"),
        plot,
        viewBox=size,
        role="img",
        aria_label=f"{chart.title} over time. {chart.note}".strip(),
        class_="chart",
        data_x=f"{between[0]:.10g} {between[1]:.10g}",
        data_y=f"{chart.limits[0]:.6g} {chart.limits[1]:.6g}",
    )
    note = svg.element("small", chart.note) if chart.note else ""
    return svg.element("div", svg.element("h4", chart.title, " ", note), image, class_="panel")


def _content(chart: Chart, between: tuple[float, float]) -> list[Markup]:
    low, high = chart.limits
    content = []
    if chart.level is not None:
        y = svg.HEIGHT * (high - chart.level) / (high - low)
        content.append(svg.element("path", d=f"M0 {y:.0f}h{svg.WIDTH}", class_="level"))
    for line in chart.lines:
        state = f"curve {line.style}{' off' if line.off else ''}"
        content.append(
            svg.element("path", d=svg.path(line.points, between, chart.limits), class_=state)
        )
    return content


def _frame(chart: Chart) -> Markup:
    size = {"width": chart.across, "height": chart.height}
    return svg.element("rect", x=LEFT, y=TOP, class_="frame", **size)


def _vertical(chart: Chart) -> list[Markup]:
    low, high = chart.limits
    values = svg.ticks(low, high)
    return [
        svg.element(
            "text",
            text,
            x=LEFT - 5,
            y=TOP + chart.height * (high - value) / (high - low) + 3.5,
            class_="y",
        )
        for value, text in zip(values, svg.labels(values), strict=True)
    ]


def _horizontal(chart: Chart, between: tuple[float, float]) -> list[Markup]:
    first, last = between
    wide, values = chart.across, svg.ticks(*between, 5)
    below = TOP + chart.height + 13
    return [
        svg.element(
            "text", text, x=LEFT + wide * (value - first) / (last - first), y=below, class_="x"
        )
        for value, text in zip(values, svg.labels(values), strict=True)
    ]
