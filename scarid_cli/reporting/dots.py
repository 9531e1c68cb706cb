"""How well each method predicts the torques of one experiment, as dots on a logarithmic axis."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from math import ceil, floor, isfinite, log10, nan, sqrt

from scarid_cli.reporting import svg

WIDTH = 760.0
TOP = 22.0
BOTTOM = 36.0
LEFT = 150.0
RIGHT = 540.0  # to the right of it stand R2 and the verdict
VERDICT = 672.0
JOINT = 9.0  # the height of a joint in a row
LEAST = 26.0  # the height of a row
SHOWN = 3  # values of R2 in a row at most; of more joints the least
UNITS = (1.0, 2.0, 5.0)


@dataclass(frozen=True)
class Dots:
    """A method: R2 of each joint, and the published ones; `verdict` may be empty."""

    name: str
    colour: int
    verdict: str
    r2: tuple[float, ...]
    published: tuple[float, ...] = ()


def error_of(r2: float) -> float:
    """The root-mean-square error in percent of the standard deviation of the torque."""
    return 100.0 * sqrt(max(1.0 - r2, 1e-12)) if isfinite(r2) else nan


def draw(rows: Sequence[Dots], joints: Sequence[int], label: str) -> str:
    """The best method first; each joint is a dot with its number."""
    height = max(LEAST, JOINT * len(joints) + 6.0)
    bottom = TOP + height * len(rows)
    low, high = _limits([e for row in rows for r2 in (*row.r2, *row.published)
                         if isfinite(e := error_of(r2))])  # fmt: skip
    scale = (RIGHT - LEFT - 14.0) / (high - low)
    body = [*_axis(low, high, scale, bottom)]
    for place, row in enumerate(rows):
        inner = "".join(_row(row, joints, TOP + height * place, height, low, scale))
        body.append(f'<g class="{svg.colour(row.colour)}">{inner}</g>')
    return svg.element(WIDTH, bottom + BOTTOM, label, body)


def _limits(errors: Sequence[float]) -> tuple[float, float]:
    """The exponents at the ends of the axis."""
    if not errors:
        return 0.0, 2.0
    low, high = log10(min(errors)) - 0.08, log10(max(errors)) + 0.08
    return (low, high) if high - low > 0.5 else (low - 0.25, high + 0.25)


def _axis(low: float, high: float, scale: float, bottom: float) -> Iterator[str]:
    units = UNITS if high - low < 2.5 else (1.0,)
    for power in range(floor(low), ceil(high) + 1):
        for value in (unit * 10.0**power for unit in units):
            x = LEFT + (log10(value) - low) * scale
            if low <= log10(value) <= high:
                yield svg.line(x, TOP - 4.0, x, bottom + 2.0, "g")
                yield svg.text(x, bottom + 15.0, f"{value:g} %", "m c")
    words = "error of the predicted torque, in % of its standard deviation (logarithmic)"
    yield svg.text((LEFT + RIGHT) / 2, bottom + 31.0, words, "m c")
    yield svg.text(RIGHT + 6.0, 13.0, "R2", "b")
    yield svg.text(VERDICT, 13.0, "verdict", "b")


def _row(
    row: Dots, joints: Sequence[int], top: float, height: float, low: float, scale: float
) -> Iterator[str]:
    """Name, dots joined by a line, and R2."""
    middle = top + height / 2
    xs = [LEFT + (log10(error_of(x)) - low) * scale for x in row.r2]
    ys = [middle + JOINT * (i - (len(joints) - 1) / 2) for i in range(len(joints))]
    places = list(zip(xs, ys, strict=True))
    yield f"<title>{escape(_words(row))}</title>"
    yield svg.text(LEFT - 10.0, middle + 4.0, _cut(row.name), "e")
    for (x, y), joint in zip(places, joints, strict=True):
        if isfinite(x):
            yield f'<circle cx="{svg.short(x)}" cy="{svg.short(y)}" r="5.2" class="f"/>'
            yield svg.text(x, y + 2.8, str(joint), "n c")
    for published, (_, y) in zip(row.published, places, strict=False):
        if isfinite(published):
            x = LEFT + (log10(error_of(published)) - low) * scale
            yield f'<circle cx="{svg.short(x)}" cy="{svg.short(y)}" r="4.4" class="h"/>'
    yield svg.text(RIGHT + 6.0, middle + 4.0, r2_text(row.r2))
    yield svg.text(VERDICT, middle + 4.0, row.verdict, f"v {row.verdict.replace(' ', '-')}")


def _words(row: Dots) -> str:
    verdict = f" ({row.verdict})" if row.verdict else ""
    return f"{row.name}{verdict}: R2 {r2_text(row.r2)}"


def r2_text(values: Sequence[float]) -> str:
    """R2 of each joint; of many joints the least."""
    known = [x for x in values if isfinite(x)]
    if len(values) > SHOWN and known:
        return f"at least {min(known):.4f}"
    return ", ".join(f"{x:.4f}" if isfinite(x) else "-" for x in values)


def _cut(name: str) -> str:
    return name if len(name) <= 22 else f"{name[:21]}…"
