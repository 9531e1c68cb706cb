"""Logs and motions in a report: torques, tracking, and what a soft sensor makes of positions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.statistics.prediction import Quality, accumulate, empty
from scarid_cli.arrays import Array
from scarid_cli.io.schemas import joints_of
from scarid_cli.io.table import Table, matrix, settled
from scarid_cli.reporting.curves import Curve
from scarid_cli.reporting.naming import Name
from scarid_cli.reporting.parts import Line, Panel, Panels, Section, number

ZOOM = (0.5, 0.575)  # of a record: a second and a half of twenty
MARGIN = 0.3  # of the range of the truth, beyond which a panel cuts an estimate off


@dataclass(frozen=True)
class Log:
    """Torque, position and reference per joint, as curves (2, points).

    `tracking` is the root-mean-square distance of position and reference.
    """

    name: Name
    robot: Robot | None
    torques: tuple[Array, ...]
    positions: tuple[Array, ...]
    references: tuple[Array, ...]
    tracking: tuple[float, ...]


@dataclass(frozen=True)
class Motion:
    """Velocity and acceleration per joint, and the true ones where the table has them.

    Curves (2, points), joint by joint; `errors` are relative to the size of the true signal [%].
    """

    name: Name
    robot: Robot | None
    columns: tuple[str, ...]
    curves: tuple[Array, ...]
    truths: tuple[Array, ...]
    errors: tuple[float, ...]


def log(table: Table, name: Name, robot: Robot | None, _others: Sequence[Robot]) -> Log:
    """A measurement."""
    joints = range(1, joints_of(table.columns, "q") + 1)
    torques = [f"tau{i}" for i in joints if f"tau{i}" in table.columns]
    positions = [f"q{i}" for i in joints]
    references = [f"q{i}_ref" for i in joints if f"q{i}_ref" in table.columns]
    curves = {column: Curve() for column in (*torques, *positions, *references)}
    sums = [empty() for _ in references]
    for batch in table.batches:
        t, *values = matrix(batch, ["t", *curves])
        signals = dict(zip(curves, values, strict=True))
        for column, x in signals.items():
            curves[column].add(t, x)
        for i, column in enumerate(references):
            sums[i] = accumulate(sums[i], signals[column], signals[column.removesuffix("_ref")])
    drawn = {column: curve.points() for column, curve in curves.items()}
    return Log(
        name=name,
        robot=robot,
        torques=tuple(drawn[column] for column in torques),
        positions=tuple(drawn[column] for column in positions),
        references=tuple(drawn[column] for column in references),
        tracking=tuple(Quality.of(s).rmse for s in sums),
    )


def motion(table: Table, name: Name, robot: Robot | None, _others: Sequence[Robot]) -> Motion:
    """What a soft sensor has made of a log; of its settled rows."""
    joints = range(1, joints_of(table.columns, "dq") + 1)
    columns = [f"{signal}{i}" for i in joints for signal in ("dq", "ddq")]
    truths = [f"{c}_true" for c in columns if f"{c}_true" in table.columns]
    truths = truths if len(truths) == len(columns) else []
    curves = [Curve() for _ in (*columns, *truths)]
    sums = [empty() for _ in truths]
    for batch in settled(table.batches):
        t, *signals = matrix(batch, ["t", *columns, *truths])
        for curve, x in zip(curves, signals, strict=True):
            curve.add(t, x)
        pairs = zip(signals, signals[len(columns) :], strict=False)
        sums = [accumulate(s, y, x) for s, (x, y) in zip(sums, pairs, strict=True)]
    points = [curve.points() for curve in curves]
    return Motion(
        name=name,
        robot=robot,
        columns=tuple(columns),
        curves=tuple(points[: len(columns)]),
        truths=tuple(points[len(columns) :]),
        errors=tuple(100.0 * np.sqrt(max(1.0 - Quality.of(s).r2, 0.0)) for s in sums),
    )


def logs(group: Sequence[Log]) -> Section:
    """Logs of one experiment beside each other (Fig. 3), and how well the robot tracked."""
    first = group[0]
    followed = [r for r in group if r.tracking]
    headers = [f"q{i + 1} [{_position_unit(first, i)}]" for i in range(len(first.positions))]
    plots = []
    if first.torques:
        plots.append(Panels("Torques, one line a log.", _torques(group), columns=1))
    if followed:
        plots.append(Panels("Positions and their references.", _tracking(followed), columns=1))
    return Section(
        title=f"Logs: {first.name.experiment}" if first.name.experiment else "Logs",
        note="Root-mean-square distance of position and reference." if followed else "",
        headers=("log", *headers) if followed else (),
        rows=tuple((r.name.label, *map(number, r.tracking)) for r in followed),
        plots=tuple(plots),
    )


def _torques(group: Sequence[Log]) -> tuple[Panel, ...]:
    """The first log is drawn wide and pale, below the others."""
    return tuple(
        Panel(
            f"tau{i + 1} [{_unit(group[0], i)}]",
            tuple(
                Line(r.name.label, k - 1 if k else None, r.torques[i])
                for k, r in enumerate(group)
                if r.torques
            ),
        )
        for i in range(len(group[0].torques))
    )


def _tracking(group: Sequence[Log]) -> tuple[Panel, ...]:
    return tuple(
        Panel(
            f"q{i + 1} [{_position_unit(group[0], i)}]",
            (
                Line("reference", None, group[0].references[i]),
                *(Line(r.name.label, k, r.positions[i]) for k, r in enumerate(group)),
            ),
        )
        for i in range(len(group[0].positions))
    )


def _unit(result: Log | Motion, joint: int) -> str:
    return result.robot.joints[joint].torque_unit if result.robot else "N m"


def _position_unit(result: Log | Motion, joint: int) -> str:
    return result.robot.joints[joint].unit if result.robot else "rad"


def soft_sensors(group: Sequence[Motion], colours: dict[str, int]) -> Section:
    """Velocities and accelerations of one experiment, method by method, with a zoom (Fig. 4)."""
    first = group[0]
    whole = [_estimates(group, colours, i) for i in range(len(first.columns))]
    end = first.curves[0][0, -1]
    zoomed = [_zoomed(panel, ZOOM[0] * end, ZOOM[1] * end) for panel in whole]
    known = [r for r in group if r.errors]
    return Section(
        title=f"Soft sensors: {first.name.experiment}" if first.name.experiment else "Soft sensors",
        note="Root-mean-square error of the settled rows over the size of the true signal, in %; "
        "of the estimate at its own time, so a delay counts."
        if known
        else "",
        headers=("method", *(f"{column} [%]" for column in first.columns)) if known else (),
        rows=tuple((r.name.label, *map(number, r.errors)) for r in known),
        plots=(
            Panels("Estimated velocities and accelerations.", tuple(whole), columns=1),
            Panels("The same, zoomed.", tuple(zoomed), columns=1),
        ),
    )


def _estimates(group: Sequence[Motion], colours: dict[str, int], i: int) -> Panel:
    first = group[0]
    column = first.columns[i]
    unit = _position_unit(first, int(column.lstrip("dq")) - 1)
    lines = [Line(r.name.label, colours[r.name.label], r.curves[i]) for r in group]
    limits = None
    if first.truths:
        lines.insert(0, Line("true", None, first.truths[i]))
        low, high = (float(f(first.truths[i][1])) for f in (np.min, np.max))
        limits = (low - MARGIN * (high - low), high + MARGIN * (high - low))
    per_time = "/s2" if column.startswith("ddq") else "/s"
    return Panel(f"{column} [{unit}{per_time}]", tuple(lines), limits=limits)


def _zoomed(panel: Panel, start: float, end: float) -> Panel:
    lines = [
        Line(line.name, line.colour, line.points[:, (start <= t) & (t <= end)])
        for line in panel.lines
        for t in [line.points[0]]
    ]
    return Panel(panel.axis, tuple(lines), panel.level, panel.limits)
