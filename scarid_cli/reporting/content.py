"""What a report says: sections of a table and plots, the same for every way of showing them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from math import isfinite, nan
from typing import Any, TypeVar

from scarid_cli.arrays import Array
from scarid_cli.reporting.results import Metrics, Parameters, Prediction, Result, Trace

NONE = "-"
DOUBT = 30.0  # %: a parameter with a greater relative standard deviation is doubtful
PANELS = 8  # of a figure at most, so that it fits a page
# Where the start of a trace, as a part of it, needs an axis this many times longer, the axis
# leaves it out.
STARTS = (0.1, 0.25)
TRANSIENT = 2.5

R = TypeVar("R", bound=Result)


@dataclass(frozen=True)
class Bars:
    """One bar per name; `colour` is the number of the label in the report."""

    caption: str
    axis: str
    names: tuple[str, ...]
    values: tuple[float, ...]
    colours: tuple[int, ...]
    doubt: float


@dataclass(frozen=True)
class Line:
    """A curve (2, points) of a panel; `colour` is that of a label, None that of measurements."""

    name: str
    colour: int | None
    points: Array


@dataclass(frozen=True)
class Panel:
    """Curves over time; `level` is a horizontal line, `limits` those of the vertical axis."""

    axis: str
    lines: tuple[Line, ...]
    level: float | None = None
    limits: tuple[float, float] | None = None


@dataclass(frozen=True)
class Panels:
    """Panels under each other in columns, with one legend; `level` names the horizontal lines."""

    caption: str
    panels: tuple[Panel, ...]
    columns: int
    level: str = ""


Plot = Bars | Panels


@dataclass(frozen=True)
class Section:
    """A table under a title and a note; without rows only its plots are shown.

    The first `keys` columns tell what a row is, the first `texts` of them in words; the others
    belong together in groups of `group`.
    """

    title: str
    note: str
    headers: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    texts: int = 1
    keys: int = 1
    group: int = 1
    plots: tuple[Plot, ...] = ()


def sections(results: Sequence[Result]) -> list[Section]:
    """Everything that these results have to say."""
    colours = {name: i for i, name in enumerate(dict.fromkeys(r.name.label for r in results))}
    parameters = [r for r in results if isinstance(r, Parameters)]
    traces = [r for r in results if isinstance(r, Trace)]
    torques = [r for r in results if isinstance(r, (Metrics, Prediction))]
    return [
        *(
            section
            for group in _grouped(parameters, lambda r: (r.names, _robot_name(r)))
            for section in (_estimates(group, colours), _fit(group))
            if section
        ),
        *(
            _evolution(group, colours)
            for group in _grouped(traces, lambda r: (r.names, _robot_name(r), r.name.experiment))
        ),
        *(
            _torques(group, colours)
            for group in _grouped(torques, lambda r: (r.joints, r.name.experiment))
        ),
    ]


def _grouped(results: Sequence[R], key: Callable[[R], Hashable]) -> list[list[R]]:
    """Results that can share a table, in the order of the first of each."""
    groups: dict[Hashable, list[R]] = {}
    for result in results:
        groups.setdefault(key(result), []).append(result)
    return list(groups.values())


def _robot_name(result: Result) -> str | None:
    return result.robot.name if result.robot else None


def _shown(results: Sequence[Result]) -> list[str]:
    """How to name results beside each other: by label, where needed with the experiment."""
    labels = [result.name.label for result in results]
    if len(set(labels)) == len(labels):
        return labels
    return [f"{r.name.label} {r.name.experiment}".rstrip() for r in results]


def _estimates(group: Sequence[Parameters], colours: dict[str, int]) -> Section:
    first, robot, shown = group[0], group[0].robot, _shown(group)
    keys = [first.names, first.units]
    if robot:
        keys.append(tuple(f"{value:.4g}" for value in robot.apriori))
    columns = [column for r in group for column in (map(number, r.estimates), _all(r.deviations))]
    known = [_greatest(r.deviations) for r in group]
    bars = Bars(
        caption="Largest relative standard deviation of a parameter, per method (eq. 34). "
        f"Above {DOUBT:g} % a parameter is doubtful.",
        axis="largest relative standard deviation [%]",
        names=tuple(shown),
        values=tuple(known),
        colours=tuple(colours[r.name.label] for r in group),
        doubt=DOUBT,
    )
    return Section(
        title="Parameters",
        note=f"{_of_robot(group)}Each estimate with its relative standard deviation in % (eq. 34).",
        headers=(
            *("parameter", "unit", "a priori")[: len(keys)],
            *(header for name in shown for header in (name, "%")),
        ),
        rows=tuple(zip(*keys, *columns, strict=True)),
        texts=2,
        keys=len(keys),
        group=2,
        plots=(bars,) if any(map(isfinite, known)) else (),
    )


def _greatest(values: Sequence[float]) -> float:
    return max((value for value in values if isfinite(value)), default=nan)


def _fit(group: Sequence[Parameters]) -> Section | None:
    """What the metadata tell of the estimation; CSV tells nothing."""
    keys = ("condition_number", "samples", "residual_deviation")
    if not any(key in r.extra for r in group for key in keys):
        return None
    robot = group[0].robot
    units = {joint.torque_unit for joint in robot.joints} if robot else set()
    unit = f" [{units.pop()}]" if len(units) == 1 else ""
    return Section(
        title="Fit",
        note="Condition number of the observation matrix W; standard deviation of the residual.",
        headers=("method", "condition number", "samples", f"residual deviation{unit}"),
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
            (name, *map(number, r.errors)) for name, r in zip(shown, group, strict=True) if robot
        ),
        plots=tuple(
            Panels(
                caption="Time evolution of the estimates. Where their start goes far beyond, the "
                "axis leaves out the first 10 or 25 % of the record.",
                panels=part,
                columns=2,
                level="a priori" if robot else "",
            )
            for part in _parts(panels)
        ),
    )


def _panel(axis: str, lines: Sequence[Line], level: float | None) -> Panel:
    """The vertical axis shows the convergence: not the start, where that would dwarf the rest."""
    limits = None
    low, high = _range(lines, level, 0.0)
    for start in STARTS:
        late = _range(lines, level, start)
        span = late[1] - late[0]
        if high - low > TRANSIENT * span > 0.0:
            low, high = late
            limits = (low - 0.1 * span, high + 0.1 * span)
    return Panel(axis, tuple(lines), level, limits)


def _range(lines: Sequence[Line], level: float | None, start: float) -> tuple[float, float]:
    """The least and greatest value after this part of each record, and the level."""
    values = [] if level is None else [level]
    for line in lines:
        t, x = line.points
        late = x[t >= t[0] + start * (t[-1] - t[0])]
        values += [float(late.min()), float(late.max())]
    return min(values), max(values)


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
            number(q.rmse) if unit else f"{number(q.rmse)} {own}",
            number(q.relative_error),
        )
    ]


def _samples(result: Metrics) -> str:
    """The joints of one motion have as many."""
    return ", ".join(dict.fromkeys(number(q.samples) for q in result.qualities))


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


def _all(values: Sequence[float]) -> list[str]:
    return [number(value) for value in values]


def number(value: Any) -> str:
    """Four significant digits, whole numbers in full; what does not exist is a dash."""
    if isinstance(value, int) and not isinstance(value, bool):
        return str(value)
    if not isinstance(value, float) or not isfinite(value):
        return NONE
    # Adding zero turns -0.0 into 0.0; the alternative form keeps zeros but also a last point.
    return f"{value + 0.0:#.4g}".rstrip(".")


def split(section: Section, width: int, gap: int, *, wrapped: bool = False) -> list[Section]:
    """The section, or, where its table is wider than this many characters, parts side by side.

    Columns are `gap` characters apart; `wrapped` headers have their unit on a line of its
    own. Each part repeats the key columns; no part is empty.
    """
    columns = list(zip(section.headers, *section.rows, strict=True))
    widths = [_width(column, wrapped=wrapped) + gap for column in columns]
    left = width - sum(widths[: section.keys])
    parts: list[list[int]] = [[]]
    used = 0
    for start in range(section.keys, len(columns), section.group):
        group = list(range(start, start + section.group))
        size = sum(widths[i] for i in group)
        if parts[-1] and used + size > left:
            parts.append([])
            used = 0
        parts[-1] += group
        used += size
    return [_part(section, columns, [*range(section.keys), *part]) for part in parts]


def _width(column: tuple[str, ...], *, wrapped: bool) -> int:
    header, *cells = column
    lines = header.replace(" [", "\n[").split("\n") if wrapped else [header]
    return max(map(len, (*lines, *cells)))


def _part(section: Section, columns: list[tuple[str, ...]], chosen: list[int]) -> Section:
    headers, *rows = zip(*(columns[i] for i in chosen), strict=True)
    return replace(section, headers=headers, rows=tuple(rows))
