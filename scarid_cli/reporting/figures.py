"""Plots as SVG, drawn by matplotlib without pyplot; equal plots give equal bytes."""

from __future__ import annotations

import contextlib
import io
import re
import warnings
from collections.abc import Iterator, Sequence
from math import ceil, isfinite
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from scarid_cli.reporting.curves import broken
from scarid_cli.reporting.parts import Bars, Panel, Panels, Plot, Ranges, Section, Series
from scarid_cli.reporting.ranges import forest

# Colours that colour-blind readers can distinguish: Okabe and Ito's palette, but wine (of Tol's
# muted palette) for its yellow, which is hardly visible on white. Black is for measurements.
PALETTE = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#882255")
DASHES = ("-", "-.", ":", (0, (1, 4)))  # of the first, second, ... turn through the palette
INK = "#222222"
BEYOND = 10.0  # times the doubtful value: the axis of bars ends there at the latest
DPI = 150
FIGURE_WIDTH = 6.7  # inches, the width of the text on an A4 page

STYLE = {
    "axes.axisbelow": True,
    "axes.edgecolor": "#888888",
    "axes.formatter.useoffset": False,
    "axes.grid": True,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.6,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.xmargin": 0.01,
    "font.size": 8.0,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.5,
    "legend.frameon": False,
    "lines.linewidth": 1.0,
    "path.simplify_threshold": 0.2,
    "svg.hashsalt": "scarid",  # without it the identifiers inside differ from run to run
    "text.color": INK,
    "text.parse_math": False,  # a dollar in a file name is a dollar
    "xtick.color": "#666666",
    "xtick.labelcolor": INK,
    "ytick.color": "#666666",
    "ytick.labelcolor": INK,
}
PAPER = {
    "facecolor": "white",
    "edgecolor": "none",
    "pad": 1.0,
}  # behind a label on a line
OFFSET: dict[str, Any] = {"textcoords": "offset points"}
NO_METADATA = dict.fromkeys(("Creator", "Date", "Format", "Type"))


def drawn(sections: Sequence[Section]) -> list[list[str]]:
    """Every plot of every section as an SVG document."""
    return [[draw(plot) for plot in section.plots] for section in sections]


def draw(plot: Plot, *, captioned: bool = False) -> str:
    """The plot as an SVG document, with its caption above it if it is to be `captioned`."""
    with styled():
        return svg(_figure(plot, captioned=captioned))


def png(plot: Plot) -> bytes:
    """The plot as a PNG, on white, with its caption."""
    with styled():
        out = io.BytesIO()
        figure = _figure(plot, captioned=True)
        figure.savefig(out, format="png", dpi=DPI, metadata={"Software": None})
    return out.getvalue()


@contextlib.contextmanager
def styled() -> Iterator[None]:
    """The style of all figures: a user's matplotlibrc must not change them."""
    with matplotlib.rc_context(), warnings.catch_warnings():
        # Nor must a missing glyph print a warning.
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        yield


def svg(figure: Figure) -> str:
    """The figure, made while `styled`, as an SVG document."""
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata=NO_METADATA)
    return re.sub(r'(?<= d=")[^"]*', _hundredths, out.getvalue())


def _figure(plot: Plot, *, captioned: bool) -> Figure:
    if isinstance(plot, Bars):
        figure = _bars(plot)
    elif isinstance(plot, Ranges):
        figure = forest(plot, FIGURE_WIDTH, PALETTE[0])
    else:
        figure = _panels(plot)
    if captioned:
        figure.suptitle(plot.caption, fontsize="medium", x=0.01, ha="left")
    return figure


def _hundredths(path: re.Match[str]) -> str:
    """Coordinates truncated to hundredths of a point, to make the page smaller."""
    return re.sub(r"(\.\d\d)\d+", r"\1", path[0])


def element(document: str) -> str:
    """The `<svg>` element alone, which fills the width of its place."""
    inner = document[document.index("<svg") :].strip()
    return re.sub(r' (xmlns(:xlink)?|version|width|height)="[^"]*"', "", inner, count=5)


def colour_of(index: int | None) -> str:
    """The colour of a label by its number in the report; None stands for measurements."""
    return "#000000" if index is None else PALETTE[index % len(PALETTE)]


def _bars(plot: Bars) -> Figure:
    figure = Figure(figsize=(FIGURE_WIDTH, 0.7 + 0.3 * len(plot.names)), layout="constrained")
    axes = figure.subplots()
    places = range(len(plot.names))
    values = [value if isfinite(value) else 0.0 for value in plot.values]
    bars = axes.barh(places, values, height=0.62, color=[colour_of(i) for i in plot.colours])
    for bar, pale in zip(bars, plot.pale, strict=True):
        bar.set_alpha(0.4 if pale else 1.0)
    for place, value, end in zip(places, plot.values, values, strict=True):
        beyond = end > BEYOND * plot.doubt
        text = _percent(value) + (", beyond the axis" if beyond else "")
        at = (min(end, BEYOND * plot.doubt), place)
        shift, side = (-4, "right") if beyond else (4, "left")
        axes.annotate(text, at, (shift, 0), **OFFSET, ha=side, va="center", bbox=PAPER)
    axes.axvline(plot.doubt, color=INK, linestyle="--", linewidth=0.9)
    axes.set_xlim(0.0, min(1.12 * max(*values, plot.doubt), BEYOND * plot.doubt))
    axes.set_ylim(len(plot.names) - 0.5, -0.5)
    axes.set_yticks(places, plot.names)
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel(plot.axis)
    above = ("data", "axes fraction")
    text = f"doubtful above {plot.doubt:g} %"
    axes.annotate(text, (plot.doubt, 1.0), (0, 3), xycoords=above, **OFFSET, ha="center")
    return figure


def _percent(value: float) -> str:
    if not isfinite(value):
        return "unknown"
    return f"{value:.3g} %" if value < 1000.0 else f"{value:,.0f} %"


def _panels(plot: Panels) -> Figure:
    columns = min(plot.columns, len(plot.panels))
    rows = ceil(len(plot.panels) / columns)
    height = 0.5 + (1.5 if columns > 1 else 1.7) * rows
    figure = Figure(figsize=(FIGURE_WIDTH, height), layout="constrained")
    grid = figure.subplots(rows, columns, sharex=True, squeeze=False).flatten().tolist()
    for axes, panel in zip(grid, plot.panels, strict=False):
        count = len(panel.series)
        for k, series in enumerate(panel.series):  # the first above the others
            above = 0 if series.colour is None else 1 + (count - k) / count
            axes.plot(*broken(series.points), **_style(series), zorder=1.0 + above)
        if panel.level is not None:
            axes.axhline(panel.level, color=INK, linestyle="--", linewidth=0.9)
        if panel.limits:
            axes.set_ylim(*panel.limits)
        axes.set_ylabel(panel.axis)
        if plot.logarithmic:
            axes.set(xscale="log", yscale="log")
            plain_powers(axes)
        else:
            axes.locator_params(axis="y", nbins=5)
    _label_across(grid, len(plot.panels), columns, plot.across)
    figure.align_ylabels()
    if len({tuple(one.name for one in panel.series) for panel in plot.panels}) == 1:
        _legend(figure, plot)
    else:
        for axes, panel in zip(grid, plot.panels, strict=False):
            _own_legend(axes, panel)
    return figure


def plain_powers(axes: Axes) -> None:
    """Number the logarithmic axes as 0.01, 0.1, 1: powers would be set as mathematics."""
    for axis in (axes.xaxis, axes.yaxis):
        if axis.get_scale() == "log":
            axis.set_major_formatter(lambda value, _: f"{value:g}")
            axis.set_minor_formatter(lambda *_: "")


def _style(series: Series) -> dict[str, Any]:
    """Measurements are drawn wide and below: they remain visible under a good prediction."""
    if series.colour is None:
        return {"color": "#000000", "linewidth": 1.6, "alpha": 0.35}
    dashes = DASHES[series.colour // len(PALETTE) % len(DASHES)]
    return {"color": colour_of(series.colour), "linestyle": dashes}


def _label_across(grid: Sequence[Axes], used: int, columns: int, across: str) -> None:
    """The horizontal axis is labelled under the lowest panel of each column."""
    for axes in grid[used:]:
        axes.remove()
    for axes in grid[max(0, used - columns) : used]:
        axes.tick_params(labelbottom=True)
        axes.set_xlabel(across)


def _own_legend(axes: Axes, panel: Panel) -> None:
    """The names of curves that differ from panel to panel; the axis names a single one."""
    if len(panel.series) > 1:
        handles = [Line2D([], [], **_style(one)) for one in panel.series]
        names = [one.name for one in panel.series]
        place = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.0}
        axes.legend(handles, names, ncols=len(names), **place)


def _legend(figure: Figure, plot: Panels) -> None:
    """The legend stands above the panels, where it covers no data."""
    entries = [(one.name, Line2D([], [], **_style(one))) for one in plot.panels[0].series]
    if plot.level:
        entries.append((plot.level, Line2D([], [], color=INK, linestyle="--", linewidth=0.9)))
    names, handles = zip(*entries, strict=True)
    columns = max(1, min(len(names), 110 // (max(map(len, names)) + 8)))
    figure.legend(handles, names, loc="outside upper center", ncols=columns)
