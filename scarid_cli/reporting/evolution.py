"""The section on running estimates: their errors (Table 3) and their course over time (Fig. 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import ceil

from scarid_cli.reporting.kinds import Trace
from scarid_cli.reporting.parts import Panel, Panels, Section, Series, pages
from scarid_cli.reporting.wording import cells, robots_of, shown, titled, with_unit

# The vertical axis leaves out the start of a record, up to one of these parts of it, where that
# start alone would make the axis this many times longer.
STARTS = (0.1, 0.25)
TRANSIENT = 2.5
KEPT = 2 / 3  # of the curves of a panel decide its axis if the others stray

CAPTION = (
    "Estimates over time. Where the initial transient or a stray curve would dwarf the others, the "
    "vertical axis shows the range of most estimates after the first 10 % or 25 % of the record, "
    "and curves outside it are clipped."
)


def evolution(group: Sequence[Trace], colours: dict[str, int]) -> Section:
    """Running estimates of the same parameters, with errors where a priori values are known."""
    first, robot = group[0], group[0].robot
    level = "a priori" if robot else ""
    plots = (Panels(CAPTION, part, 2, level) for part in pages(_panels(group, colours)))
    title = titled("Estimates over time", first.name.experiment)
    section = Section(title, note="", plots=tuple(plots))
    if not robot:
        return section
    return replace(
        section,
        note=f"{robots_of(group)}Root-mean-square error of each running estimate with respect to "
        "its a priori value, over the whole record (eq. 35).",
        headers=("method", *map(with_unit, first.names, first.units)),
        rows=tuple(
            (name, *cells(r, r.errors)) for name, r in zip(shown(group), group, strict=True)
        ),
    )


def _panels(group: Sequence[Trace], colours: dict[str, int]) -> list[Panel]:
    """One panel for each parameter."""
    first, robot = group[0], group[0].robot
    return [
        _panel(
            with_unit(name, unit),
            [
                Series(label, colours[r.name.label], r.curves[i])
                for label, r in zip(shown(group), group, strict=True)
                if r.curves
            ],
            robot.apriori[i] if robot else None,
        )
        for i, (name, unit) in enumerate(zip(first.names, first.units, strict=True))
    ]


def _panel(axis: str, series: Sequence[Series], level: float | None) -> Panel:
    """The vertical axis shows the convergence: not the start, where that would dwarf the rest.

    Nor a curve that strays where most of the others do not.
    """
    limits = None
    low, high = _range(series, level, 0.0)
    for start in STARTS:
        late = _usual(series, level, start)
        span = late[1] - late[0]
        if high - low > TRANSIENT * span > 0.0:
            low, high = late
            limits = (low - 0.1 * span, high + 0.1 * span)
    return Panel(axis, tuple(series), level, limits)


def _usual(series: Sequence[Series], level: float | None, start: float) -> tuple[float, float]:
    """The range after this part of each record, without the third of the curves that stray most."""
    whole = _range(series, level, start)
    by_span = sorted(series, key=lambda one: _span(_range([one], level, start)))
    kept = by_span[: ceil(len(series) * KEPT)]
    usual = _range(kept, level, start)
    return usual if _span(whole) > TRANSIENT * _span(usual) else whole


def _span(limits: tuple[float, float]) -> float:
    return limits[1] - limits[0]


def _range(series: Sequence[Series], level: float | None, start: float) -> tuple[float, float]:
    """The least and greatest value after this part of each record, and the level."""
    values = [] if level is None else [level]
    for one in series:
        t, x = one.points
        late = x[t >= t[0] + start * (t[-1] - t[0])]
        values += [float(late.min()), float(late.max())]
    return min(values), max(values)
