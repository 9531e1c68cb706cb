"""Chapters on the methods, their estimates, and the estimates over time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from scarid_cli.algorithms.inference.verdict import DOUBT, GOOD
from scarid_cli.reporting.estimates import constants, fit
from scarid_cli.reporting.evolution import evolution
from scarid_cli.reporting.kinds import Parameters, Trace
from scarid_cli.reporting.parts import NONE, Panels, Section
from scarid_cli.reporting.said import ALARMING, FINE, Said
from scarid_cli.reporting.study.blocks import (
    Block,
    Chapter,
    Figure,
    Fold,
    Grid,
    Matrix,
    Methods,
    figure,
)
from scarid_cli.reporting.study.chart import Chart, Line
from scarid_cli.reporting.study.forest import Row, forest
from scarid_cli.reporting.study.intervals import Interval, intervals, written
from scarid_cli.reporting.study.svg import span
from scarid_cli.reporting.study.view import View
from scarid_cli.reporting.wording import grouped, titled

ACROSS = 6  # methods of a matrix side by side
FEW = 5  # methods of a list that are not folded


def methods(view: View) -> Iterator[Chapter]:
    """The verdict on each method, the best first."""
    ranked = view.ranking.standings if view.ranking else ()
    rows = [
        (s.name, view.style(s.label), s.grade, (*s.reasons, "")[0], s.reasons[1:])
        for s in ranked
        if s.grade
    ]
    if not rows:
        return
    blocks: list[Block] = [Methods(tuple(rows[:FEW]))]
    if rows[FEW:]:
        blocks.append(
            Fold(f"The other {len(rows) - FEW} identifications", (Methods(tuple(rows[FEW:])),))
        )
    note = "Whether the estimates of each method can be relied on, and why; the best first."
    said = " ".join(reason for standing in ranked for reason in standing.reasons)
    asked = ("known within 30 %", "model torque within", "residual", "matched", "soft sensor")
    words = [word for word in asked if word in said]
    yield Chapter("Verdicts", "Verdicts", note, ("verdict", *words), tuple(blocks))


def changed(said: Sequence[Said]) -> Iterator[Chapter]:
    """Whether the robot has changed, by validate and compare; the alarming verdicts first."""
    order = sorted(said, key=lambda one: (*ALARMING, *FINE).index(one.verdict))
    rows = [(one.title, "", one.verdict, one.reason, ()) for one in order]
    if not rows:
        return
    blocks: list[Block] = [Methods(tuple(rows[:FEW]))]
    if rows[FEW:]:
        blocks.append(Fold(f"The other {len(rows) - FEW}", (Methods(tuple(rows[FEW:])),)))
    note = "Whether the robot is the one that was identified, by validate and compare."
    title = "Has the robot changed?"
    yield Chapter(title, "Changes", note, ("unchanged",), tuple(blocks))


def parameters(view: View, results: Sequence[Parameters]) -> Iterator[Chapter]:
    """All estimates: as a matrix, and with their intervals; the group of the best first."""
    groups = sorted(grouped(results, same_parameters), key=lambda g: min(map(view.place, g)))
    for i, group in enumerate(groups):
        ordered = sorted(group, key=lambda r: (r.name.published, view.place(r)))
        blocks: tuple[Block, ...] = (
            _forest(view, ordered),
            *_matrices(view, ordered),
            *_details(ordered),
        )
        title = titled("Parameters", group[0].name.experiment)
        robot = f"Robot {group[0].robot_name}. " if group[0].robot_name else ""
        if i:
            good = sum(r.extra.get("verdict") == GOOD for r in group)
            robot += f"{len(group)} identifications; the verdict on {good or 'none'} is good. "
            blocks = (Fold("Show the estimates", blocks),)
        yield Chapter(title, title, robot, tuple(_words(group)), blocks)


def _words(group: Sequence[Parameters]) -> Iterator[str]:
    """The words that the chapter of these estimates uses."""
    yield "95 % interval"
    if group[0].robot:
        yield "a priori"
    if any(r.name.published for r in group):
        yield "published"
    if any("condition_number" in r.extra for r in group):
        yield "condition number"


def same_parameters(result: Parameters | Trace) -> tuple[tuple[str, ...], str | None, str]:
    """Results that share a table have the same parameters, robot and experiment."""
    return result.names, result.robot_name, result.name.experiment


def _forest(view: View, group: Sequence[Parameters]) -> Figure:
    first = group[0]
    apriori = [float(x) for x in first.robot.apriori] if first.robot else None
    found = [intervals(r) for r in group]
    panels = tuple(
        forest(
            name,
            unit,
            [
                Row(r.name.shown, view.style(r.name.label), each[i], r.name.published)
                for r, each in zip(group, found, strict=True)
            ],
            apriori[i] if apriori else None,
        )
        for i, (name, unit) in enumerate(zip(first.names, first.units, strict=True))
    )
    line = " The dashed line is the a priori value." if apriori else ""
    caption = (
        f"Each estimate with its 95 % interval, the best method first.{line} An arrow points to "
        "what lies beyond the axis, which shows the best three in full; the numbers are on the "
        "right. Hollow points are published."
        if len(group) > 1
        else f"Each estimate with its 95 % interval.{line}"
    )
    return Figure(caption, panels, wide=True)


def _matrices(view: View, group: Sequence[Parameters]) -> Iterator[Matrix]:
    """Parameters down and methods across, in parts that fit a page."""
    for start in range(0, len(group), ACROSS):
        yield _matrix(view, group[start : start + ACROSS])


def _matrix(view: View, part: Sequence[Parameters]) -> Matrix:
    first, apriori = part[0], part[0].robot.apriori if part[0].robot else None
    found = [intervals(r) for r in part]
    rows = []
    for i, (name, unit) in enumerate(zip(first.names, first.units, strict=True)):
        known = float(apriori[i]) if apriori is not None else None
        keys = (name, unit, *([] if known is None else [f"{known:.4g}"]))
        cells = tuple(_cell(r, each[i], known) for r, each in zip(part, found, strict=True))
        rows.append((keys, cells))
    return Matrix(
        headers=tuple((r.name.shown, view.style(r.name.label)) for r in part),
        keys=("parameter", "unit", "a priori")[: 2 if apriori is None else 3],
        rows=tuple(rows),
    )


def _cell(result: Parameters, interval: Interval, known: float | None) -> tuple[str, str, str]:
    """The estimate, half its interval, and whether it is known and contains the a priori value."""
    estimate, half, percent = written(interval)
    text = f"{interval.estimate:g}" if result.name.published else estimate
    if not half:
        return text.replace("nan", NONE), "", ""
    missed = known is not None and not interval.holds(known)
    vague = not interval.relative() <= 2.0 * DOUBT
    more = f"± {half} ({percent})" if percent else f"± {half}"
    return text, more, "missed" if missed else "vague" if vague else "sure"


def _details(group: Sequence[Parameters]) -> Iterator[Fold]:
    sections: list[Section] = [*fit(group), *constants(group)]
    for section in sections:
        yield Fold(section.title, (Grid(section),))


def over_time(view: View, results: Sequence[Trace]) -> Iterator[Chapter]:
    """Running estimates: the best few are shown at first."""
    for group in grouped(results, same_parameters):
        section = evolution(group, view.colours)
        blocks: list[Block] = []
        if ordered := sorted((r for r in group if r.curves), key=view.place):
            blocks.append(_running(view, ordered, section))
        if section.rows:
            blocks.append(Fold("Errors of the running estimates", (Grid(section),)))
        yield Chapter(section.title, section.title, "", (), tuple(blocks))


def _running(view: View, group: Sequence[Trace], section: Section) -> Figure:
    panels = [p for plot in section.plots if isinstance(plot, Panels) for p in plot.panels]
    charts = [
        Chart(panel.axis, _lines(view, group, i), _limits(group, i, panel.level), panel.level)
        for i, panel in enumerate(panels)
    ]
    level = " The dashed line is the a priori value." if group[0].robot else ""
    caption = (
        "Estimates over time. The vertical axis shows the best three after the first tenth of the "
        f"record; what lies beyond it is clipped.{level}"
    )
    return figure(caption, charts, view.keys([r.name.label for r in group]))


def _lines(view: View, group: Sequence[Trace], i: int) -> tuple[Line, ...]:
    """The best last, above the others."""
    hidden = {key.name for key in view.keys([r.name.label for r in group]) if key.off}
    lines = (
        Line(r.name.label, view.style(r.name.label), r.curves[i], r.name.label in hidden)
        for r in group
    )
    return tuple(reversed(tuple(lines)))


def _limits(group: Sequence[Trace], i: int, level: float | None) -> tuple[float, float]:
    """The range of the best few after the first tenth of the record."""
    values = [] if level is None else [level]
    for result in group[: View.FEW]:
        t, x = result.curves[i]
        late = x[t >= t[0] + 0.1 * (t[-1] - t[0])]
        values += [float(late.min()), float(late.max())]
    return span(values)
