"""Read the tables of a report; each becomes a result of its kind."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from scarid_cli.algorithms.inference.prediction import Quality
from scarid_cli.algorithms.robots import reading
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.errors import BadData, UsageFault, bad_data
from scarid_cli.io import schemas
from scarid_cli.io.reader import checked
from scarid_cli.io.stated import stated_robot
from scarid_cli.io.table import Table
from scarid_cli.printable import printable
from scarid_cli.reporting.common import with_common
from scarid_cli.reporting.kinds import (
    Comparison,
    Hung,
    JointGains,
    Loads,
    Metrics,
    Parameters,
    Result,
)
from scarid_cli.reporting.naming import name_of, names_of
from scarid_cli.reporting.records import measurement, motion, prediction, trace
from scarid_cli.reporting.said import files_of, of_comparison, of_validation
from scarid_cli.reporting.source import Source

WRONG = "wrong"  # key of the metadata of gains
HUNG = {"values": "estimate", "low": "low", "high": "high", "body": "body"}  # columns
OVER_TIME = ("t_start", "t_end", "t_found", "load_mass", "load_mass_half")


class NotReported(UsageFault):
    """A table of a kind that has no place in a report."""


def reportable(table: Table) -> Table:
    """The checked table, with its kind in the metadata; NotReported if its kind is no result."""
    stated = table.meta.kind
    detected = None if stated else schemas.detect(table.columns)
    kind = detected.kind if detected else stated
    if kind in READERS:
        return checked(table, kind)
    *others, last = READERS
    if kind in (*schemas.KINDS, "via"):
        raise NotReported(
            f"{table.name} is a {kind} table; report takes {', '.join(others)} and {last} tables"
        )
    raise BadData(
        f"{table.name}: found the columns {printable(', '.join(table.columns))}, expected a "
        f"{', '.join(others)} or {last} table; name the columns as docs/tables.md does"
    )


def collect(tables: Sequence[Table], *, repeated: bool = False) -> list[Result]:
    """Read tables that are `reportable`; repeated: files of one name are repetitions."""
    robots = [_stated_robot(table) for table in tables]
    files, kinds = [t.name for t in tables], [t.meta.kind or "" for t in tables]
    alone = [name_of(file, kind) for file, kind in zip(files, kinds, strict=True)]
    names = alone if repeated else names_of(files, kinds)
    known = [robot for robot in robots if robot]
    beside = with_common(tables, names)
    return [
        READERS[kind](Source(table, name, robot, known, with_common=table is not own))
        for own, table, kind, name, robot in zip(tables, beside, kinds, names, robots, strict=True)
        if table
    ]


def _stated_robot(table: Table) -> Robot | None:
    """The robot that the metadata name, if its description is found."""
    try:
        return reading.load(robot) if (robot := stated_robot(table)) else None
    except (UsageFault, OSError, UnicodeDecodeError):
        return None


def _parameters(source: Source) -> Parameters:
    table, rows = source.table, _rows(source.table)
    names = _texts(rows["parameter"])
    return Parameters(
        name=source.name,
        robot=source.robot_with(names),
        names=names,
        units=_texts(rows["unit"]),
        estimates=tuple(rows["estimate"]),
        deviations=_numbers(rows, "relative_deviation"),
        extra=table.meta.extra,
        commands=tuple(entry["command"] for entry in table.meta.history),
        robust=_relative(_numbers(rows, "robust_error"), rows["estimate"]),
        low=_numbers(rows, "low"),
        high=_numbers(rows, "high"),
        file=table.name,
    )


def _relative(errors: Sequence[float], estimates: Sequence[float]) -> tuple[float, ...]:
    """The relative errors in percent of the estimates; empty if none is known."""
    found = [
        100.0 * e / abs(x) if x else float("nan") for e, x in zip(errors, estimates, strict=True)
    ]
    return tuple(found) if np.isfinite(found).any() else ()


def _metrics(source: Source) -> Metrics:
    rows, meta = _rows(source.table), source.table.meta
    values = (_numbers(rows, column) for column in ("r2", "rmse", "relative_error"))
    return Metrics(
        name=source.name,
        robot=source.robot,
        joints=tuple(rows["joint"]),
        units=_texts(rows["unit"]),
        qualities=tuple(Quality(*row) for row in zip(*values, rows["samples"], strict=True)),
        by=files_of(meta)[1],
        said=of_validation(meta, source.name.shown),
    )


def _comparison(source: Source) -> Comparison:
    _rows(source.table)
    said = of_comparison(source.table.meta, source.name.shown)
    return Comparison(source.name, source.robot, said)


def _gains(source: Source) -> JointGains:
    rows = _rows(source.table)
    return JointGains(
        name=source.name,
        robot=source.robot,
        joints=tuple(rows["joint"]),
        factors=_numbers(rows, "gain"),
        low=_numbers(rows, "low"),
        high=_numbers(rows, "high"),
        wrong=tuple(source.table.meta.extra.get(WRONG, ())),
    )


def _payload(source: Source) -> Hung:
    rows, extra = _rows(source.table), source.table.meta.extra
    return Hung(
        source.name,
        source.robot,
        frame=str(extra.get("frame", "the flange")),
        possible=bool(extra.get("possible", True)),
        away=float(extra.get("away", 0.0)),
        quantities=_texts(rows["quantity"]),
        units=_texts(rows["unit"]),
        **{name: _numbers(rows, column) for name, column in HUNG.items()},
    )


def _loads(source: Source) -> Loads:
    rows = _rows(source.table)
    return Loads(
        source.name, source.robot, tuple(zip(*(_numbers(rows, x) for x in OVER_TIME), strict=True))
    )


def _rows(table: Table) -> dict[str, list[Any]]:
    """All values of a small table by column; it must have a row."""
    rows: dict[str, list[Any]] = {column: [] for column in table.columns}
    for batch in table.batches:
        for column, values in rows.items():
            values += batch.column(column).to_pylist()
    if not next(iter(rows.values())):
        raise bad_data(
            table.name,
            "no rows",
            expected="at least one",
            remedy="check that the command that wrote the table has succeeded",
        )
    return rows


def _texts(values: Sequence[str]) -> tuple[str, ...]:
    return tuple(map(printable, values))


def _numbers(rows: dict[str, list[Any]], column: str) -> tuple[float, ...]:
    """The numbers of an optional column; nan for each that is missing or infinite."""
    values = rows.get(column, [None] * len(next(iter(rows.values()))))
    return tuple(x if x is not None and np.isfinite(x) else np.nan for x in values)


READERS: dict[str, Callable[[Source], Result]] = {
    "parameters": _parameters,
    "trace": trace,
    "metrics": _metrics,
    "comparison": _comparison,
    "gains": _gains,
    "payload": _payload,
    "loads": _loads,
    "prediction": prediction,
    "motion": motion,
    "measurement": measurement,
}
