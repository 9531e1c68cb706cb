"""What a report says: sections of a table and plots, the same for every way of showing them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from math import ceil, isfinite, nan
from typing import TypeVar

from scarid_cli.reporting import published
from scarid_cli.reporting.parts import NONE, Bars, Line, Panel, Panels, Section, number
from scarid_cli.reporting.results import Metrics, Parameters, Prediction, Result, Trace
from scarid_cli.reporting.signals import Log, Motion, logs, soft_sensors

DOUBT = 30.0  # %: a parameter with a greater relative standard deviation is doubtful
PANELS = 8  # of a figure at most, so that it fits a page
# Where the start of a trace, as a part of it, needs an axis this many times longer, the axis
# leaves it out.
STARTS = (0.1, 0.25)
TRANSIENT = 2.5
KEPT = 2 / 3  # of the lines of a panel, which decide its axis if the others stray

R = TypeVar("R", bound=Result)


def sections(results: Sequence[Result], values: published.Values | None = None) -> list[Section]:
    """Everything that these results have to say, with published values beside them."""
    labels = (r.name.label for r in results if not isinstance(r, Log))
    colours = {name: i for i, name in enumerate(dict.fromkeys(labels))}
    results = published.beside(results, values or {})
    parameters = [r for r in results if isinstance(r, Parameters)]
    traces = [r for r in results if isinstance(r, Trace)]
    torques = [r for r in results if isinstance(r, (Metrics, Prediction))]
    return [
        *_verdicts(parameters),
        *published.settings(results, values or {}),
        *(logs(group) for group in _grouped(_of(results, Log), _experiment)),
        *(soft_sensors(group, colours) for group in _grouped(_of(results, Motion), _experiment)),
        *(
            section
            for group in _grouped(parameters, lambda r: (r.names, _robot_name(r), _experiment(r)))
            for section in (_estimates(group, colours), _fit(group))
            if section
        ),
        *(
            _evolution(group, colours)
            for group in _grouped(traces, lambda r: (r.names, _robot_name(r), r.name.experiment))
        ),
        *_experiments(_of(results, Metrics)),
        *(
            _torques(group, colours)
            for group in _grouped(torques, lambda r: (r.joints, r.name.experiment))
        ),
    ]


def _verdicts(results: Sequence[Parameters]) -> list[Section]:
    """Whether to believe each estimation, before anything else."""
    rows = [
        (_caption(r, r.name.label), r.extra["verdict"], "; ".join(r.extra["reasons"]))
        for r in results
        if "verdict" in r.extra
    ]
    if not rows:
        return []
    note = "Whether the estimates can be relied on, and why."
    headers = ("method", "verdict", "why")
    return [Section("Verdict", note, headers, tuple(rows), texts=3, keys=3, prose=True)]


def _of(results: Sequence[Result], kind: type[R]) -> list[R]:
    return [r for r in results if isinstance(r, kind)]


def _experiment(result: Result) -> str:
    return result.name.experiment


def _grouped(results: Sequence[R], key: Callable[[R], Hashable]) -> list[list[R]]:
    """Results that can share a table, in the order of the first of each."""
    groups: dict[Hashable, list[R]] = {}
    for result in results:
        groups.setdefault(key(result), []).append(result)
    return list(groups.values())


def _robot_name(result: Result) -> str | None:
    return result.robot.name if result.robot else None


def _shown(results: Sequence[Result]) -> list[str]:
    """How to name results beside each other."""
    return [result.name.shown for result in results]


def _estimates(group: Sequence[Parameters], colours: dict[str, int]) -> Section:
    first, robot, shown = group[0], group[0].robot, _shown(group)
    keys = [first.names, first.units]
    if robot:
        keys.append(tuple(f"{value:.4g}" for value in robot.apriori))
    robust = any(r.robust for r in group)
    columns = [
        _cells(r, values)
        for r in group
        for values in (r.estimates, r.deviations, *([_robust(r)] if robust else []))
    ]
    percents = ("%", "robust %") if robust else ("%",)
    known = [_greatest(r.deviations) for r in group]
    bars = Bars(
        caption="Largest relative standard deviation of a parameter, per method (eq. 34). "
        f"Above {DOUBT:g} % a parameter is doubtful.",
        axis="largest relative standard deviation [%]",
        names=tuple(shown),
        values=tuple(known),
        colours=tuple(colours[r.name.label] for r in group),
        pale=tuple(r.name.published for r in group),
        doubt=DOUBT,
    )
    return Section(
        title=_titled("Parameters", first),
        note=f"{_of_robot(group)}Each estimate with its relative standard deviation in % (eq. 34)"
        + (", and one that autocorrelated residuals cannot shrink." if robust else "."),
        headers=(
            *("parameter", "unit", "a priori")[: len(keys)],
            *(header for name in shown for header in (name, *percents)),
        ),
        rows=tuple(zip(*keys, *columns, strict=True)),
        texts=2,
        keys=len(keys),
        group=1 + len(percents),
        plots=(bars,) if any(map(isfinite, known)) else (),
    )


def _robust(result: Parameters) -> tuple[float, ...]:
    return result.robust or (nan,) * len(result.names)


def _greatest(values: Sequence[float]) -> float:
    return max((value for value in values if isfinite(value)), default=nan)


def _fit(group: Sequence[Parameters]) -> Section | None:
    """What the metadata tell of the estimation; CSV tells nothing."""
    keys = ("condition_number", "samples", "residual_deviation", "lag_share")
    group = [r for r in group if any(key in r.extra for key in keys)]
    if not group:
        return None
    robot = group[0].robot
    units = {joint.torque_unit for joint in robot.joints} if robot else set()
    unit = f" [{units.pop()}]" if len(units) == 1 else ""
    return Section(
        title=_titled("Fit", group[0]),
        note="Condition number of the observation matrix W; standard deviation of the residual; "
        "part of it that the motion 25 ms before and after explains, near 1 if torques and "
        "derivatives do not belong to the same instant.",
        headers=("method", "condition number", "samples", f"residual deviation{unit}", "lag share"),
        rows=tuple(
            (name, *(number(r.extra.get(key)) for key in keys))
            for name, r in zip(_shown(group), group, strict=True)
        ),
    )


def _evolution(group: Sequence[Trace], colours: dict[str, int]) -> Section:
    first, robot, shown = group[0], group[0].robot, _shown(group)
    panels = [
        _panel(
            _with_unit(name, unit),
            [
                Line(label, colours[r.name.label], r.curves[i])
                for label, r in zip(shown, group, strict=True)
                if r.curves
            ],
            robot.apriori[i] if robot else None,
        )
        for i, (name, unit) in enumerate(zip(first.names, first.units, strict=True))
    ]
    return Section(
        title=_titled("Estimates over time", first),
        note=f"{_of_robot(group)}Root-mean-square error of each parameter against its a priori "
        "value over the record (eq. 35)."
        if robot
        else "",
        headers=("method", *map(_with_unit, first.names, first.units)) if robot else (),
        rows=tuple(
            (name, *_cells(r, r.errors)) for name, r in zip(shown, group, strict=True) if robot
        ),
        plots=tuple(
            Panels(
                caption="Time evolution of the estimates. The axis shows where most of them go "
                "after the first 10 or 25 % of the record; lines beyond are cut off.",
                panels=part,
                columns=2,
                level="a priori" if robot else "",
            )
            for part in _parts(panels)
        ),
    )


def _panel(axis: str, lines: Sequence[Line], level: float | None) -> Panel:
    """The vertical axis shows the convergence: not the start, where that would dwarf the rest.

    Nor a line that strays where most of the others do not.
    """
    limits = None
    low, high = _range(lines, level, 0.0)
    for start in STARTS:
        late = _usual(lines, level, start)
        span = late[1] - late[0]
        if high - low > TRANSIENT * span > 0.0:
            low, high = late
            limits = (low - 0.1 * span, high + 0.1 * span)
    return Panel(axis, tuple(lines), level, limits)


def _usual(lines: Sequence[Line], level: float | None, start: float) -> tuple[float, float]:
    """The range after this part of each record, without the third of the lines that stray most."""
    whole = _range(lines, level, start)
    by_span = sorted(lines, key=lambda line: _span(_range([line], level, start)))
    kept = by_span[: ceil(len(lines) * KEPT)]
    usual = _range(kept, level, start)
    return usual if _span(whole) > TRANSIENT * _span(usual) else whole


def _span(limits: tuple[float, float]) -> float:
    return limits[1] - limits[0]


def _range(lines: Sequence[Line], level: float | None, start: float) -> tuple[float, float]:
    """The least and greatest value after this part of each record, and the level."""
    values = [] if level is None else [level]
    for line in lines:
        t, x = line.points
        late = x[t >= t[0] + start * (t[-1] - t[0])]
        values += [float(late.min()), float(late.max())]
    return min(values), max(values)


def _experiments(results: Sequence[Metrics]) -> list[Section]:
    """All experiments side by side, where there are several with the same joints."""
    first = results[0] if results else None
    experiments = list(dict.fromkeys(_experiment(r) for r in results))
    if not first or len(experiments) < 2 or any(r.joints != first.joints for r in results):
        return []
    units = [_common([r.units[i] for r in results]) for i in range(len(first.joints))]
    by_name = {(r.name.shown, _experiment(r)): r for r in results}
    measures = (0, 1)  # of the three of `_metrics_row`: R2, error
    headers = [
        f"{experiment} {_metrics_headers(first.joints, units)[3 * i + measure]}"
        for measure in measures
        for experiment in experiments
        for i in range(len(first.joints))
    ]
    rows = [
        (
            shown,
            *(
                _metrics_row(r, units)[3 * i + measure] if r else NONE
                for measure in measures
                for r in (by_name.get((shown, experiment)) for experiment in experiments)
                for i in range(len(first.joints))
            ),
        )
        for shown in dict.fromkeys(_shown(results))
    ]
    return [
        Section(
            title="Torque prediction",
            note=f"{_of_robot(results)}Coefficient of determination R2 (eq. 36) and "
            "root-mean-square error (eq. 35) of each experiment.",
            headers=("method", *headers),
            rows=tuple(rows),
            group=len(experiments) * len(first.joints),
        )
    ]


def _torques(group: Sequence[Metrics | Prediction], colours: dict[str, int]) -> Section:
    metrics = [r for r in group if isinstance(r, Metrics)]
    predictions = [r for r in group if isinstance(r, Prediction)]
    title = _titled("Torque prediction", group[0])
    plots = [
        Panels(
            caption=f"Actual and predicted torques: {_caption(r, name)}.",
            panels=part,
            columns=1,
        )
        for name, r in zip(_shown(predictions), predictions, strict=True)
        for part in _parts(_torque_panels(r, name, colours[r.name.label]))
    ]
    if not metrics:
        return Section(title, note="", plots=tuple(plots))
    units = [_common([r.units[i] for r in metrics]) for i in range(len(metrics[0].joints))]
    return Section(
        title=title,
        note=f"{_of_robot(metrics)}Per joint: coefficient of determination R2 (eq. 36), "
        "root-mean-square error (eq. 35), norm of the error over that of the torque in %.",
        headers=("method", "samples", *_metrics_headers(metrics[0].joints, units)),
        rows=tuple(
            (name, _samples(r), *_metrics_row(r, units))
            for name, r in zip(_shown(metrics), metrics, strict=True)
        ),
        keys=2,
        group=3,
        plots=tuple(plots),
    )


def _metrics_headers(joints: Sequence[int], units: Sequence[str]) -> list[str]:
    return [
        header
        for joint, unit in zip(joints, units, strict=True)
        for header in (
            f"tau{joint} R2",
            _with_unit(f"tau{joint} RMSE", unit),
            f"tau{joint} error [%]",
        )
    ]


def _metrics_row(result: Metrics, units: Sequence[str]) -> list[str]:
    """A unit that is not common to the column stands in the cell."""
    return [
        cell
        for q, own, unit in zip(result.qualities, result.units, units, strict=True)
        for cell in (
            f"{q.r2:.4f}" if isfinite(q.r2) else NONE,
            _cells(result, [q.rmse])[0] + ("" if unit else f" {own}"),
            number(q.relative_error),
        )
    ]


def _samples(result: Metrics) -> str:
    """The joints of one motion have as many, unless slow rows were left out."""
    counts = [q.samples for q in result.qualities]
    least, most = number(min(counts) or None), number(max(counts) or None)
    return least if least == most else f"{least} to {most}"


def _torque_panels(result: Prediction, name: str, colour: int) -> list[Panel]:
    curves = zip(result.joints, result.units, result.measured, result.predicted, strict=True)
    return [
        Panel(
            _with_unit(f"tau{joint}", unit),
            (Line("actual", None, actual), Line(f"predicted, {name}", colour, predicted)),
        )
        for joint, unit, actual, predicted in curves
    ]


def _parts(panels: Sequence[Panel]) -> list[tuple[Panel, ...]]:
    """As many panels as fit a page."""
    return [tuple(panels[i : i + PANELS]) for i in range(0, len(panels), PANELS)]


def _titled(title: str, result: Result) -> str:
    return f"{title}: {result.name.experiment}" if result.name.experiment else title


def _caption(result: Result, shown: str) -> str:
    experiment = result.name.experiment
    return shown if not experiment or shown.endswith(experiment) else f"{shown}, {experiment}"


def _of_robot(results: Sequence[Result]) -> str:
    names = dict.fromkeys(name for r in results if (name := _robot_name(r)))
    return f"Robot {', '.join(names)}. " if names else ""


def _with_unit(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name


def _common(units: Sequence[str]) -> str:
    """The unit of all, or nothing."""
    return units[0] if len(set(units)) == 1 else ""


def _cells(result: Result, values: Sequence[float]) -> list[str]:
    """Published values as they were printed."""
    return [_printed(x) if result.name.published else number(x) for x in values]


def _printed(value: float) -> str:
    return f"{value:g}" if isfinite(value) else NONE
