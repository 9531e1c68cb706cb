"""Chapters on torques, soft sensors and logs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.reporting.kinds import Measurement, Metrics, MotionEstimate, Prediction
from scarid_cli.reporting.parts import Panel, Panels, Section, Series, number
from scarid_cli.reporting.signals import compared_with
from scarid_cli.reporting.signals import logs as logs_section
from scarid_cli.reporting.signals import soft_sensors as sensors_section
from scarid_cli.reporting.study.blocks import Block, Chapter, Figure, Fold, Grid, Key, figure
from scarid_cli.reporting.study.chart import INK, NARROW, WIDE, Chart, Line
from scarid_cli.reporting.study.svg import element, span
from scarid_cli.reporting.study.view import View
from scarid_cli.reporting.torques import experiment as torque_section
from scarid_cli.reporting.torques import experiments
from scarid_cli.reporting.wording import experiment_of, grouped, of_kind, titled, with_unit

COLUMNS = 3  # of narrow panels side by side
RESIDUAL = 58  # pixels, the height of the panel of a residual
TAIL = 0.2  # % of the samples at either end that an axis may clip


def torques(view: View, results: Sequence[Metrics | Prediction]) -> Iterator[Chapter]:
    """How well torques are predicted: all experiments side by side, then each one."""
    metrics = of_kind(results, Metrics)
    overview = [Grid(_ranked(view, section, metrics)) for section in experiments(metrics)]
    words = ("relative error", "R2", "residual", *map(experiment_of, results))
    if overview:
        note = overview[0].section.note
        yield Chapter("Torque prediction", "Torques", note, words, tuple(overview))
    for group in grouped(results, lambda r: (r.joints, r.name.experiment)):
        section = _ranked(view, torque_section(group, view.colours), metrics)
        blocks: list[Block] = [Grid(section)] if section.rows else []
        predicted = sorted(of_kind(group, Prediction), key=view.place)
        if overview and blocks and predicted:
            blocks = [Fold("Table of this experiment", tuple(blocks))]
        blocks = [*_predictions(view, predicted, metrics), *blocks]
        yield Chapter(section.title, section.title, "", words, tuple(blocks))


def _ranked(view: View, section: Section, metrics: Sequence[Metrics]) -> Section:
    """The section with the best method first, and published values below all others."""
    places = {r.name.shown: (r.name.published, view.place(r)) for r in metrics}
    return replace(section, rows=tuple(sorted(section.rows, key=lambda row: places[row[0]])))


def _predictions(
    view: View, group: Sequence[Prediction], metrics: Sequence[Metrics]
) -> Iterator[Block]:
    """The best few methods open, each of the others folded; the scales are shared."""
    if not group:
        return
    scales = [span([*_ends(r.measured[i] for r in group)]) for i in range(len(group[0].joints))]
    best, others = group[: view.FEW], group[view.FEW :]
    yield from (_prediction(view, r, scales, _residuals(best), metrics) for r in best)
    if others:
        shown = (_prediction(view, r, scales, _residuals(others), metrics) for r in others)
        names = ", ".join(r.name.label for r in others)
        yield Fold(f"{len(others)} other methods: {names}", tuple(shown))


def _residuals(group: Sequence[Prediction]) -> list[tuple[float, float]]:
    """The range of the residuals of each joint, the same for all these methods."""
    return [_symmetric([r.residuals[i] for r in group]) for i in range(len(group[0].joints))]


def _symmetric(curves: Sequence[Array]) -> tuple[float, float]:
    """A range about zero that clips only the most extreme samples."""
    values = np.concatenate([np.abs(curve[1]) for curve in curves])
    most = float(np.percentile(values, 100.0 - TAIL)) or 1.0
    return -1.1 * most, 1.1 * most


def _ends(curves: Iterable[Array]) -> Iterator[float]:
    for curve in curves:
        yield from (float(curve[1].min()), float(curve[1].max()))


def _prediction(
    view: View,
    result: Prediction,
    scales: Sequence[tuple[float, float]],
    residuals: Sequence[tuple[float, float]],
    metrics: Sequence[Metrics],
) -> Figure:
    name, style = result.name.label, view.style(result.name.label)
    quality = next((m.qualities for m in metrics if m.name == result.name), None)
    width = WIDE if len(result.joints) < COLUMNS else NARROW
    charts = []
    for i, joint in enumerate(result.joints):
        title = with_unit(f"tau{joint}", result.units[i])
        note = f"error {number(quality[i].relative_error)} %" if quality else ""
        lines = (Line("actual", INK, result.measured[i]), Line(name, style, result.predicted[i]))
        rest = (Line(name, style, result.residuals[i]),)
        charts.append(Chart(title, lines, scales[i], note=note, width=width))
        below = Chart(f"residual of {title}", rest, residuals[i], 0.0, RESIDUAL, width=width)
        charts.append(below)
    keys = (Key("actual", INK), Key(f"predicted, {name}", style))
    experiment = f" in the experiment {result.name.experiment}" if result.name.experiment else ""
    caption = f"{name}: measured and predicted torques{experiment}, with the residual below."
    return _paired(figure(caption, charts, keys, wide=width == WIDE))


def _paired(made: Figure) -> Figure:
    """Each panel with its residual in one column."""
    pairs = zip(made.panels[::2], made.panels[1::2], strict=True)
    return replace(made, panels=tuple(element("div", *pair, class_="pair") for pair in pairs))


def sensors(view: View, results: Sequence[MotionEstimate]) -> Iterator[Chapter]:
    """Soft sensors: their errors against the truth or the common motion, else the signals."""
    for group in grouped(results, compared_with):
        section = sensors_section(group, view.colours)
        ordered = sorted(group, key=view.place)
        blocks: list[Block] = [Grid(section)] if section.rows else []
        whole = [p for plot in section.plots[:1] if isinstance(plot, Panels) for p in plot.panels]
        blocks += [_sensor(view, ordered, at, panel) for at, panel in enumerate(whole)]
        note = section.note
        words = ("soft sensor", "matched", "settled", *(r.against for r in group))
        yield Chapter(section.title, section.title, note, words, tuple(blocks))


def _sensor(view: View, group: Sequence[MotionEstimate], at: int, panel: Panel) -> Figure:
    """One signal: a panel for each method, on one scale."""
    true = all(r.misses for r in group)
    curves = [r.misses[at] if true else r.curves[at] for r in group]
    limits = _symmetric(curves[: view.FEW]) if true else span([*_ends(curves)])
    charts = [
        Chart(
            r.name.label,
            (Line(r.name.label, view.style(r.name.label), curve),),
            limits,
            0.0 if true else None,
            RESIDUAL,
            f"{number(r.errors[at])} % rms" if r.errors else "",
        )
        for r, curve in zip(group, curves, strict=True)
    ]
    what = f"Error (estimate minus {group[0].against}) of" if true else "Estimates of"
    clipped = " The scale is that of the best three." if true and len(group) > view.FEW else ""
    return figure(f"{what} {panel.axis}, method by method, on one scale.{clipped}", charts)


def logs(view: View, results: Sequence[Measurement]) -> Iterator[Chapter]:
    """The logs themselves: torques, positions and references."""
    for group in grouped(results, experiment_of):
        section = logs_section(group)
        blocks: list[Block] = [Grid(section)] if section.rows else []
        blocks += [_log(view, plot) for plot in section.plots if isinstance(plot, Panels)]
        title = titled("Logs", group[0].name.experiment)
        yield Chapter(title, title, section.note, (), tuple(blocks))


def _log(view: View, plot: Panels) -> Figure:
    charts = [
        Chart(panel.axis, lines, span([*_ends(line.points for line in lines)]), width=WIDE)
        for panel in plot.panels
        for lines in [tuple(_line(view, series) for series in panel.series)]
    ]
    keys = [Key(one.name, _log_style(view, one)) for one in plot.panels[0].series]
    return figure(plot.caption, charts, keys, wide=True)


def _line(view: View, series: Series) -> Line:
    return Line(series.name, _log_style(view, series), series.points)


def _log_style(view: View, series: Series) -> str:
    """Logs are no methods: their colours come after those of the methods."""
    return INK if series.colour is None else f"m{len(view.colours) + series.colour}"
