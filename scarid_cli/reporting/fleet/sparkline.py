"""The course of a parameter over the logs of a robot, with its interval and its outliers."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np
from markupsafe import Markup

from scarid_cli.arrays import Array
from scarid_cli.reporting.fleet.reading import Row
from scarid_cli.reporting.study.svg import element, span

WIDTH, HEIGHT, EDGE = 190, 46, 4  # pixels
MOST = 120  # points of a line: longer courses are drawn through medians
MARKS = 60  # outliers that are marked at most
FENCE = 3.0  # interquartile ranges beyond which an estimate does not decide the axis


def sparkline(rows: Sequence[Row], outliers: set[str]) -> Markup:
    """The estimates in the order of the logs; the band is their 95 % interval.

    `outliers` are the names of the logs that differ in this parameter.
    """
    values = _columns(rows)
    x, y = _scales(values)
    name = f"{rows[0]['parameter']} over {len(rows)} logs, {len(outliers)} of which differ"
    return element(
        "svg",
        element("path", d=_band(_reduced(values), x, y), class_="band"),
        element("path", d=_line(_reduced(values), x, y), class_="course"),
        *_marks(rows, outliers, x, y),
        viewBox=f"0 0 {WIDTH} {HEIGHT}",
        role="img",
        aria_label=name,
        class_="spark",
    )


Scale = tuple[float, float]  # pixel = first + second * value


def _columns(rows: Sequence[Row]) -> Array:
    """Order, estimate, low and high (4, logs); without an interval the estimate itself."""
    return np.array(
        [(r["order"], r["estimate"], _known(r, "low"), _known(r, "high")) for r in rows],
        dtype=float,
    ).T


def _known(row: Row, end: str) -> float:
    value: float | None = row.get(end)
    estimate: float = row["estimate"]
    return estimate if value is None or not isfinite(value) else value


def _scales(values: Array) -> tuple[Scale, Scale]:
    """The axes: all logs, and the usual estimates with their usual intervals."""
    low, high = limits(values)
    first, last = float(values[0].min()), float(values[0].max())
    across = (WIDTH - 2 * EDGE) / ((last - first) or 1.0)
    up = -(HEIGHT - 2 * EDGE) / (high - low)
    return (EDGE - across * first, across), (EDGE - up * high, up)


def limits(values: Array) -> tuple[float, float]:
    """The range of the estimates that are not far outside the middle half of them.

    So one log of a robot wired differently does not flatten the drift of all others.
    """
    estimates = values[1]
    quarter, half, three = np.percentile(estimates, (25.0, 50.0, 75.0))
    width = float(np.median(values[3] - values[2]))
    fence = FENCE * max(three - quarter, width / 2.0, 1e-9 * abs(half))
    usual = (estimates >= quarter - fence) & (estimates <= three + fence)
    ends = [float(f(estimates[usual])) for f in (np.min, np.max)]
    return span([ends[0] - width / 2.0, ends[1] + width / 2.0])


def _at(scale: Scale, value: float) -> float:
    return round(scale[0] + scale[1] * value, 1)


def _reduced(values: Array) -> Array:
    """At most MOST columns, each the median of neighbouring logs."""
    count = values.shape[1]
    if count <= MOST:
        return values
    return np.array([np.median(part, axis=1) for part in np.array_split(values, MOST, axis=1)]).T


def _line(values: Array, x: Scale, y: Scale) -> str:
    points = " ".join(f"{_at(x, t):g} {_inside(_at(y, v)):g}" for t, v in values[:2].T.tolist())
    return f"M{points}" if values.shape[1] > 1 else f"M{points}h2"


def _band(values: Array, x: Scale, y: Scale) -> str:
    """Along the upper ends, and back along the lower ones."""
    order, _, low, high = values.tolist()
    there = [f"{_at(x, t):g} {_inside(_at(y, v)):g}" for t, v in zip(order, high, strict=True)]
    back = [f"{_at(x, t):g} {_inside(_at(y, v)):g}" for t, v in zip(order, low, strict=True)]
    return f"M{' '.join(there)} {' '.join(reversed(back))}z"


def _inside(y: float) -> float:
    """On the figure: what lies beyond it stands at its edge."""
    return min(max(y, EDGE - 1.0), HEIGHT - EDGE + 1.0)


def _marks(rows: Sequence[Row], outliers: set[str], x: Scale, y: Scale) -> list[Markup]:
    """The latest outliers, each with the name of its log."""
    found = [row for row in rows if row["log"] in outliers][-MARKS:]
    return [
        element(
            "circle",
            element("title", f"{row['log']}: {row['estimate']:.4g}"),
            cx=_at(x, row["order"]),
            cy=_inside(_at(y, row["estimate"])),
            r=2.6,
            class_="outlier",
        )
        for row in found
    ]
