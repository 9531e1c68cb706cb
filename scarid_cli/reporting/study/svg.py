"""Pieces of figures: elements, ticks of an axis, and curves as short paths."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor, isfinite, log10

import numpy as np
from markupsafe import Markup, escape

from scarid_cli.arrays import Array
from scarid_cli.reporting.curves import broken

STEPS = (1.0, 2.0, 5.0, 10.0)
WIDTH, HEIGHT = 4000, 1000  # of the grid of whole numbers on which curves are drawn
PASSES = 4  # of leaving out points that lie on the line between their neighbours
FARTHEST = 9.0  # heights of the plot: points beyond are drawn at this distance


def element(name: str, *children: str, **attributes: object) -> Markup:
    """An element with escaped attributes; `class_` is the class, `aria_label` aria-label."""
    given = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escape(_short(value))}"'
        for key, value in attributes.items()
    )
    inner = Markup("").join(children)  # escapes text, keeps elements
    return Markup(f"<{name}{given}>{inner}</{name}>") if children else Markup(f"<{name}{given}/>")


def _short(value: object) -> str:
    """Coordinates to a tenth of a pixel."""
    return f"{round(value, 1):g}" if isinstance(value, float) else str(value)


def ticks(low: float, high: float, count: int = 4) -> list[float]:
    """Round numbers from low to high, about so many."""
    if not high > low:
        return [low]
    rough = (high - low) / count
    power = 10.0 ** floor(log10(rough))
    step = power * next(s for s in STEPS if s * power >= rough * (1.0 - 1e-9))
    first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
    return [k * step + 0.0 for k in range(first, last + 1)]


def tick_label(value: float, step: float) -> str:
    """The number with as many places as its neighbours need."""
    if value and (abs(value) >= 1e5 or step < 1e-4):
        return f"{value:.2g}"
    places = max(0, -floor(log10(step) + 1e-9)) if step > 0.0 else 2
    return f"{value:.{places}f}"


def labels(values: Sequence[float]) -> list[str]:
    """The label of each tick."""
    step = values[1] - values[0] if len(values) > 1 else abs(values[0])
    return [tick_label(value, step) for value in values]


def path(points: Array, x: tuple[float, float], y: tuple[float, float]) -> str:
    """The curve (2, points) within these ranges as a path of whole numbers on the grid."""
    with np.errstate(divide="ignore", invalid="ignore"):
        across = np.rint(WIDTH * (points[0] - x[0]) / ((x[1] - x[0]) or 1.0))
        up = np.rint(HEIGHT * (y[1] - points[1]) / ((y[1] - y[0]) or 1.0))
    up = np.clip(up, -FARTHEST * HEIGHT, FARTHEST * HEIGHT)
    pieces = np.split(np.array([across, up]), _ends(broken(points)), axis=1)
    return "".join(_piece(_thinned(piece)) for piece in pieces if piece.shape[1])


def _ends(with_gaps: Array) -> list[int]:
    """Where a gap stands in the curve, counted without the gaps."""
    at = np.flatnonzero(np.isnan(with_gaps[0]))
    return [int(place) - k for k, place in enumerate(at)]


def _thinned(piece: Array) -> Array:
    """The piece without points that lie within a grid step of the line between their neighbours."""
    for _ in range(PASSES):
        (t0, t1, t2), (x0, x1, x2) = (
            (row[:-2], row[1:-1], row[2:]) for row in (piece[0], piece[1])
        )
        share = (t1 - t0) / np.maximum(t2 - t0, 1.0)
        near = np.abs(x0 + share * (x2 - x0) - x1) <= 1.0
        near[1::2] = False  # two neighbours are never left out together
        if not near.any():
            break
        keep = np.concatenate(([True], ~near, [True]))
        piece = piece[:, keep]
    return piece


def _piece(piece: Array) -> str:
    whole = piece.astype(int)
    steps = " ".join(f"{a} {b}" for a, b in np.diff(whole, axis=1).T.tolist())
    return f"M{whole[0, 0]} {whole[1, 0]}" + (f"l{steps}" if steps else "h1")


def span(values: Sequence[float], margin: float = 0.06) -> tuple[float, float]:
    """The range of these finite values with a margin; never empty."""
    known = [value for value in values if isfinite(value)]
    low, high = (min(known), max(known)) if known else (0.0, 1.0)
    more = margin * (high - low) or abs(high) or 1.0
    return low - more, high + more
