"""What a report needs of each table, read batch by batch."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.robots import reading
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.statistics.prediction import Quality, accumulate, empty
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, UsageFault, bad_data
from scarid_cli.io import schemas
from scarid_cli.io.reader import checked, require
from scarid_cli.io.table import Table, matrix
from scarid_cli.reporting.curves import Curve
from scarid_cli.reporting.naming import Name, name_of, names_of, printable
from scarid_cli.reporting.signals import Log, Motion, log, motion

REPORTED = ("parameters", "trace", "metrics", "prediction", "motion", "measurement")


@dataclass(frozen=True)
class Parameters:
    """Estimates with their relative standard deviations [%]; nan is unknown.

    `robust` ones are those that autocorrelated residuals cannot shrink.
    """

    name: Name
    robot: Robot | None
    names: tuple[str, ...]
    units: tuple[str, ...]
    estimates: tuple[float, ...]
    deviations: tuple[float, ...]
    extra: dict[str, Any]
    commands: tuple[str, ...] = ()
    robust: tuple[float, ...] = ()


@dataclass(frozen=True)
class Trace:
    """The estimates over time, one curve (2, points) per parameter; RMS errors of eq. 35."""

    name: Name
    robot: Robot | None
    names: tuple[str, ...]
    units: tuple[str, ...]
    curves: tuple[Array, ...]
    errors: tuple[float, ...]


@dataclass(frozen=True)
class Metrics:
    """Quality of the predicted torques per joint; nan is unknown."""

    name: Name
    robot: Robot | None
    joints: tuple[int, ...]
    units: tuple[str, ...]
    qualities: tuple[Quality, ...]


@dataclass(frozen=True)
class Prediction:
    """Measured and predicted torque per joint, as curves (2, points)."""

    name: Name
    robot: Robot | None
    joints: tuple[int, ...]
    units: tuple[str, ...]
    measured: tuple[Array, ...]
    predicted: tuple[Array, ...]


Result = Parameters | Trace | Metrics | Prediction | Log | Motion


def reportable(table: Table) -> Table:
    """The checked table, with its kind in the metadata; not every kind is a result."""
    stated = table.meta.kind
    if stated in REPORTED:
        return checked(table, stated)
    detected = None if stated else schemas.detect(table.columns)
    kind = detected.kind if detected else stated
    if kind in REPORTED:
        return checked(table, kind)
    if kind in (*schemas.KINDS, "via"):
        raise UsageFault(
            f"{table.name} is a {kind} table; report takes parameters, trace, metrics, prediction, "
            "motion and measurement tables"
        )
    raise BadData(
        f"{table.name}: found the columns {printable(', '.join(table.columns))}, expected a "
        "parameters, trace, metrics, prediction, motion or measurement table; name the columns as "
        "docs/tables.md does"
    )


def collect(tables: Sequence[Table], *, repeated: bool = False) -> list[Result]:
    """Read tables that are `reportable`; repeated: files of one name are repetitions."""
    robots = [_stated_robot(table) for table in tables]
    files, kinds = [t.name for t in tables], [t.meta.kind or "" for t in tables]
    alone = [name_of(file, kind) for file, kind in zip(files, kinds, strict=True)]
    names = alone if repeated else names_of(files, kinds)
    read: dict[str, Callable[[Table, Name, Robot | None, Sequence[Robot]], Result]] = {
        "parameters": _parameters,
        "trace": _trace,
        "metrics": _metrics,
        "prediction": _prediction,
        "motion": motion,
        "measurement": log,
    }
    others = [robot for robot in robots if robot]
    return [
        read[table.meta.kind or ""](table, name, robot, others)
        for table, name, robot in zip(tables, names, robots, strict=True)
    ]


def _stated_robot(table: Table) -> Robot | None:
    """The robot that the metadata names, if its description is here."""
    try:
        return reading.load(table.meta.robot) if table.meta.robot else None
    except (UsageFault, OSError, UnicodeDecodeError):
        return None


def _robot_of(names: Sequence[str], robot: Robot | None, others: Sequence[Robot]) -> Robot | None:
    """The robot with these parameters: the table's own, else another table's (CSV states none)."""
    candidates = [robot] if robot else others
    return next((r for r in candidates if r.names == list(names)), None)


def _parameters(
    table: Table, name: Name, robot: Robot | None, others: Sequence[Robot]
) -> Parameters:
    rows = _rows(table)
    names = _texts(rows["parameter"])
    return Parameters(
        name=name,
        robot=_robot_of(names, robot, others),
        names=names,
        units=_texts(rows["unit"]),
        estimates=tuple(rows["estimate"]),
        deviations=_numbers(rows, "relative_deviation"),
        extra=table.meta.extra,
        commands=tuple(entry["command"] for entry in table.meta.history),
        robust=_relative(_numbers(rows, "robust_error"), rows["estimate"]),
    )


def _relative(errors: Sequence[float], estimates: Sequence[float]) -> tuple[float, ...]:
    """In percent; nothing if none is known."""
    found = [
        100.0 * e / abs(x) if x else float("nan") for e, x in zip(errors, estimates, strict=True)
    ]
    return tuple(found) if np.isfinite(found).any() else ()


def _metrics(table: Table, name: Name, robot: Robot | None, _others: Sequence[Robot]) -> Metrics:
    rows = _rows(table)
    values = (_numbers(rows, column) for column in ("r2", "rmse", "relative_error"))
    return Metrics(
        name=name,
        robot=robot,
        joints=tuple(rows["joint"]),
        units=_texts(rows["unit"]),
        qualities=tuple(Quality(*row) for row in zip(*values, rows["samples"], strict=True)),
    )


def _rows(table: Table) -> dict[str, list[Any]]:
    """All values of a small table by column; it must have a row."""
    rows: dict[str, list[Any]] = {column: [] for column in table.columns}
    for batch in table.batches:
        for column, values in rows.items():
            values += batch.column(column).to_pylist()
    if not next(iter(rows.values())):
        raise bad_data(
            table.name, "no rows", expected="at least one", remedy="was the table cut short?"
        )
    return rows


def _texts(values: Sequence[str]) -> tuple[str, ...]:
    return tuple(map(printable, values))


def _numbers(rows: dict[str, list[Any]], column: str) -> tuple[float, ...]:
    """The numbers of an optional column; nan stands for each that is not there or infinite."""
    values = rows.get(column, [None] * len(next(iter(rows.values()))))
    return tuple(x if x is not None and np.isfinite(x) else np.nan for x in values)


def _trace(table: Table, name: Name, robot: Robot | None, others: Sequence[Robot]) -> Trace:
    columns = [column for column in table.columns if column != "t"]
    _require_estimates(table, columns)
    robot = _robot_of(columns, robot, others)
    apriori = robot.apriori if robot else np.full(len(columns), np.nan)
    curves = [Curve() for _ in columns]
    sums = [empty() for _ in columns]
    row = 0
    for batch in table.batches:
        t, *estimates = matrix(batch, ["t", *columns])
        for i, x in enumerate(estimates):
            _check_finite(x, table.name, columns[i], row)
            curves[i].add(t, x)
            sums[i] = accumulate(sums[i], x, np.full_like(x, apriori[i]))
        row += batch.num_rows
    own = [parameter.unit for parameter in robot.parameters] if robot else [""] * len(columns)
    return Trace(
        name=name,
        robot=robot,
        names=_texts(columns),
        units=_units(table, columns, own),
        curves=tuple(curve.points() for curve in curves),
        errors=tuple(Quality.of(s).rmse for s in sums),
    )


def _require_estimates(table: Table, columns: list[str]) -> None:
    if not columns:
        raise bad_data(
            table.name,
            "the column t alone",
            expected="a column per parameter",
            remedy="write the trace with `scarid identify --trace`",
        )
    for column in columns:
        kind = table.schema.field(column).type
        if not (pa.types.is_floating(kind) or pa.types.is_integer(kind)):
            raise bad_data(
                table.name,
                f"type {kind}",
                expected="numbers, the estimates of a parameter",
                remedy="drop the column",
                column=column,
            )


def _check_finite(values: Array, table: str, column: str, row: int) -> None:
    """An estimate must be a number: `checked` knows the names of no parameters."""
    finite = np.isfinite(values)
    if not finite.all():
        at = int(np.argmin(finite))
        raise bad_data(
            table,
            "an empty cell or nan" if np.isnan(values[at]) else str(values[at]),
            expected="a finite number",
            remedy="mend or remove the row",
            row=row + at + 1,
            column=column,
        )


def _units(table: Table, columns: Sequence[str], otherwise: Sequence[str]) -> tuple[str, ...]:
    return _texts(
        [table.unit(column) or unit for column, unit in zip(columns, otherwise, strict=True)]
    )


def _prediction(
    table: Table, name: Name, robot: Robot | None, _others: Sequence[Robot]
) -> Prediction:
    joints = range(1, schemas.joints_of(table.columns, "tau") + 1)
    measured = [f"tau{i}" for i in joints]
    predicted = [f"tau{i}_pred" for i in joints]
    require(table, predicted, "this one beside each measured torque")
    curves = [Curve() for _ in (*measured, *predicted)]
    for batch in table.batches:
        t, *torques = matrix(batch, ["t", *measured, *predicted])
        for curve, x in zip(curves, torques, strict=True):
            curve.add(t, x)
    own = [joint.torque_unit for joint in robot.joints] if robot else []
    points = [curve.points() for curve in curves]
    return Prediction(
        name=name,
        robot=robot,
        joints=tuple(joints),
        units=_units(table, measured, own if len(own) == len(joints) else [""] * len(joints)),
        measured=tuple(points[: len(joints)]),
        predicted=tuple(points[len(joints) :]),
    )
