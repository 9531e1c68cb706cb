"""Values with their 95 % intervals, as a forest drawn by matplotlib."""

from __future__ import annotations

from math import isfinite

import numpy as np
from matplotlib.figure import Figure

from scarid_cli.reporting.parts import Range, Ranges


def forest(plot: Ranges, width: float, colour: str) -> Figure:
    """The figure, so many inches wide: a row for each value, its interval in percent of it."""
    rows = plot.rows
    figure = Figure(figsize=(width, 0.9 + 0.24 * len(rows)), layout="constrained")
    axes = figure.subplots()
    widest = plot.widest
    axes.axvline(0.0, color="#888888", linewidth=0.6)
    for place, row in enumerate(rows):
        ends = [float(np.clip(end, -widest, widest)) for end in row.shares() if not np.isnan(end)]
        axes.plot(ends, [place] * len(ends), color=colour, linewidth=2.2)
        for end, mark in zip(row.shares(), "<>", strict=True):
            if abs(end) > widest:
                axes.plot(np.clip(end, -widest, widest), place, mark, color=colour, clip_on=False)
        axes.plot(0.0, place, "o", color=colour, markersize=4.0)
    axes.set_xlim(-1.02 * widest, 1.02 * widest)
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_yticks(range(len(rows)), [row.name for row in rows])
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("95 % interval, in percent of the estimate")
    beside = axes.secondary_yaxis("right")
    beside.set_yticks(range(len(rows)), [written(row) for row in rows])
    beside.tick_params(length=0)
    beside.spines["right"].set_visible(False)
    return figure


def written(row: Range) -> str:
    """The estimate and half its interval, with the unit."""
    half = (row.high - row.low) / 2.0
    text = f"{row.value:.4g}" + (f" ± {half:.2g}" if isfinite(half) else " ± unknown")
    return f"{text} {row.unit}".rstrip()
