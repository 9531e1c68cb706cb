"""Read tables that hold one row per sample, batch by batch: their length does not matter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.inference.prediction import Quality, accumulate, empty
from scarid_cli.arrays import Array
from scarid_cli.errors import bad_data, bad_row
from scarid_cli.io.reader import require
from scarid_cli.io.schemas import joints_of
from scarid_cli.io.table import Table, matrix, settled
from scarid_cli.printable import printable
from scarid_cli.reporting.curves import Curve
from scarid_cli.reporting.kinds import Measurement, MotionEstimate, Prediction, Trace
from scarid_cli.reporting.source import Source

# A true column and its estimate, or an estimated column and the constant that it should be.
Comparison = tuple[str, str | float]


def trace(source: Source) -> Trace:
    """The running estimates of `scarid identify --trace`, compared with a priori values."""
    table = source.table
    columns = [column for column in table.columns if column != "t"]
    _require_estimates(table, columns)
    robot = source.robot_with(columns)
    apriori = robot.apriori if robot else np.full(len(columns), np.nan)
    comparisons = list(zip(columns, map(float, apriori), strict=True))
    curves, qualities = _read(_finite(table, columns), columns, comparisons)
    own = [parameter.unit for parameter in robot.parameters] if robot else [""] * len(columns)
    return Trace(
        name=source.name,
        robot=robot,
        names=tuple(map(printable, columns)),
        units=_units(table, columns, own),
        curves=_chosen(curves, columns),
        errors=tuple(quality.rmse for quality in qualities),
    )


def prediction(source: Source) -> Prediction:
    """Measured and predicted torques of `scarid validate --predictions`."""
    table, robot = source.table, source.robot
    joints = range(1, joints_of(table.columns, "tau") + 1)
    measured = [f"tau{i}" for i in joints]
    predicted = [f"tau{i}_pred" for i in joints]
    require(table, predicted, "this one beside each measured torque")
    pairs = list(zip(measured, predicted, strict=True))
    curves, _ = _read(table.batches, [*measured, *predicted], pairs, apart=True)
    own = [joint.torque_unit for joint in robot.joints] if robot else []
    return Prediction(
        name=source.name,
        robot=robot,
        joints=tuple(joints),
        units=_units(table, measured, own if len(own) == len(joints) else [""] * len(joints)),
        measured=_chosen(curves, measured),
        predicted=_chosen(curves, predicted),
        residuals=_chosen(curves, [difference(*pair) for pair in pairs]),
    )


def measurement(source: Source) -> Measurement:
    """A log: torques, positions, and how well they followed the reference."""
    table = source.table
    joints = range(1, joints_of(table.columns, "q") + 1)
    torques = [f"tau{i}" for i in joints if f"tau{i}" in table.columns]
    positions = [f"q{i}" for i in joints]
    references = [f"q{i}_ref" for i in joints if f"q{i}_ref" in table.columns]
    followed = [(reference, reference.removesuffix("_ref")) for reference in references]
    curves, qualities = _read(table.batches, [*torques, *positions, *references], followed)
    return Measurement(
        name=source.name,
        robot=source.robot,
        torques=_chosen(curves, torques),
        positions=_chosen(curves, positions),
        references=_chosen(curves, references),
        tracking=tuple(quality.rmse for quality in qualities),
    )


def motion(source: Source) -> MotionEstimate:
    """The derivatives that `scarid differentiate` estimated, in the settled rows."""
    table = source.table
    joints = range(1, joints_of(table.columns, "dq") + 1)
    columns = [f"{signal}{i}" for i in joints for signal in ("dq", "ddq")]
    truths = [f"{column}_true" for column in columns]
    truths = truths if set(truths) <= set(table.columns) else []
    pairs = list(zip(truths, columns, strict=False))
    batches = settled(table.batches)
    curves, qualities = _read(batches, [*columns, *truths], pairs, apart=True)
    return MotionEstimate(
        name=source.name,
        robot=source.robot,
        columns=tuple(columns),
        curves=_chosen(curves, columns),
        truths=_chosen(curves, truths),
        errors=tuple(100.0 * np.sqrt(max(1.0 - quality.r2, 0.0)) for quality in qualities),
        misses=_chosen(curves, [difference(*pair) for pair in pairs]),
        against="common motion" if source.with_common else "truth",
    )


def difference(column: str, other: object) -> str:
    """The name of the curve of a column subtracted from another one."""
    return f"{other} - {column}"


def _read(
    batches: Iterator[pa.RecordBatch],
    columns: Sequence[str],
    pairs: Sequence[Comparison] = (),
    *,
    apart: bool = False,
) -> tuple[dict[str, Array], list[Quality]]:
    """Each column as a curve over time, and how well the two of each pair agree.

    With `apart` there is also a curve of the second column of each pair minus the first.
    """
    curves = {column: Curve() for column in columns}
    curves |= {difference(*pair): Curve() for pair in pairs if apart}
    sums = [empty() for _ in pairs]
    for batch in batches:
        t, *values = matrix(batch, ["t", *columns])
        signals = dict(zip(columns, values, strict=True))
        for i, (column, other) in enumerate(pairs):
            x = signals[column]
            y = signals[other] if isinstance(other, str) else np.full_like(x, other)
            sums[i] = accumulate(sums[i], x, y)
            if apart:
                signals[difference(column, other)] = y - x
        for column, x in signals.items():
            curves[column].add(t, x)
    return {column: curve.points() for column, curve in curves.items()}, [*map(Quality.of, sums)]


def _chosen(curves: dict[str, Array], columns: Sequence[str]) -> tuple[Array, ...]:
    return tuple(curves[column] for column in columns)


def _units(table: Table, columns: Sequence[str], otherwise: Sequence[str]) -> tuple[str, ...]:
    """The units that the table states, else these."""
    units = (table.unit(column) or unit for column, unit in zip(columns, otherwise, strict=True))
    return tuple(map(printable, units))


def _require_estimates(table: Table, columns: list[str]) -> None:
    if not columns:
        raise bad_data(
            table.name,
            "the column t alone",
            expected="one column per parameter",
            remedy="write the trace with `scarid identify --trace`",
        )
    for column in columns:
        kind = table.schema.field(column).type
        if not (pa.types.is_floating(kind) or pa.types.is_integer(kind)):
            raise bad_data(
                table.name,
                f"type {kind}",
                expected="numbers, the estimates of a parameter",
                remedy="remove the column",
                column=column,
            )


def _finite(table: Table, columns: list[str]) -> Iterator[pa.RecordBatch]:
    """The batches; schemas do not know the names of parameters, so values are checked here."""
    row = 0
    for batch in table.batches:
        for column, values in zip(columns, matrix(batch, columns), strict=True):
            _require_finite(values, table.name, column, row)
        row += batch.num_rows
        yield batch


def _require_finite(values: Array, table: str, column: str, row: int) -> None:
    finite = np.isfinite(values)
    if not finite.all():
        at = int(np.argmin(finite))
        found = "an empty cell or nan" if np.isnan(values[at]) else str(values[at])
        raise bad_row(table, found, "a finite number", row + at + 1, column)
