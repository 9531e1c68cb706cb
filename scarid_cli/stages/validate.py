"""Predict torques with identified parameters, and measure how well."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.statistics.prediction import Quality, accumulate, empty
from scarid_cli.arrays import Array
from scarid_cli.errors import bad_data
from scarid_cli.io import schemas
from scarid_cli.io.table import Table, number, segment_field, with_columns
from scarid_cli.stages import Sink
from scarid_cli.stages.identify import known
from scarid_cli.stages.rows import Treatment, treated


def estimates(table: Table, robot: Robot) -> tuple[Robot, Array]:
    """The values of a parameter table, which must be those of this robot.

    With them the robot as it was identified: dry friction may have got a part that fades with
    speed (`separable`).
    """
    batches = list(table.batches)
    names = [name for batch in batches for name in batch.column("parameter").to_pylist()]
    values = np.concatenate([batch.column("estimate").to_numpy() for batch in batches])
    found = dict(zip(names, values.tolist(), strict=True))
    joints = range(1, len(robot.joints) + 1)
    velocities = {i: found[f"vs{i}"] for i in joints if f"vs{i}" in found}
    wanted = [*robot.names, *(f"{kind}{i}" for kind in ("Fst", "vs") for i in velocities)]
    if names != wanted:
        raise bad_data(
            table.name,
            f"the parameters {', '.join(names)}",
            expected=f"those of {robot.name}: {', '.join(robot.names)}",
            remedy="choose the robot they were identified for with --robot",
            column="parameter",
        )
    return robot.with_stribeck(velocities), values[: len(values) - len(velocities)]


def validate(
    table: Table,
    robot: Robot,
    theta: Array,
    *,
    treatment: Treatment | None = None,
    predictions: Sink | None = None,
) -> Table:
    """The metrics of the torques that theta predicts for a motion, one row per joint.

    `predictions` receives the measured and predicted torques of every sample (Fig. 7-8).
    """
    sums = [empty() for _ in robot.joints]
    schema = _prediction_schema(robot, table)
    if predictions:
        meta = replace(table.meta, kind="prediction", robot=robot.name)
        predictions.start(replace(table, schema=schema, meta=meta).arrow_schema())
    for batch, rows in treated(table, robot, treatment or Treatment()):
        predicted = robot.torques(rows.W, theta)
        tau = np.ascontiguousarray(rows.y.T)
        counts = [np.flatnonzero(s) for s in rows.scales.T]
        sums = [
            accumulate(s, x[at], y[at])
            for s, x, y, at in zip(sums, tau, predicted, counts, strict=True)
        ]
        if predictions and batch is not None:
            new = dict(zip(schema.names[1:], (*tau, *predicted), strict=False))
            predictions.write(with_columns(batch, schema, new))
    return _metrics(table, robot, [Quality.of(s) for s in sums])


def _prediction_schema(robot: Robot, table: Table) -> pa.Schema:
    fields = [number("t", "s")]
    for suffix in ("", "_pred"):
        fields += [
            number(f"tau{i}{suffix}", joint.torque_unit)
            for i, joint in enumerate(robot.joints, start=1)
        ]
    return pa.schema([*fields, *segment_field(table)])


def _metrics(table: Table, robot: Robot, qualities: list[Quality]) -> Table:
    schema = schemas.load("metrics").arrow()
    batch = pa.RecordBatch.from_arrays(
        [
            pa.array(range(1, len(qualities) + 1), pa.int64()),
            known(np.array([quality.r2 for quality in qualities])),
            known(np.array([quality.rmse for quality in qualities])),
            pa.array([joint.torque_unit for joint in robot.joints]),
            known(np.array([quality.relative_error for quality in qualities])),
            pa.array([quality.samples for quality in qualities], pa.int64()),
        ],
        schema=schema,
    )
    meta = replace(table.meta, kind="metrics", robot=robot.name)
    return Table("validate", schema, meta, iter([batch]))
