"""Predict torques with identified parameters, and measure how well."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.regression.rows import Rows, delay_column, joined
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.statistics.prediction import Quality, accumulate, empty
from scarid_cli.arrays import Array
from scarid_cli.io import schemas
from scarid_cli.io.table import Table, number, segment_field, with_columns
from scarid_cli.stages import Sink
from scarid_cli.stages.parameters import Identified, known
from scarid_cli.stages.rows import Treatment, treated


def validate(
    table: Table,
    model: Identified,
    *,
    treatment: Treatment | None = None,
    predictions: Sink | None = None,
) -> Table:
    """The metrics of the torques that identified parameters predict for a motion, a row per joint.

    The torques are predicted as early as those that the parameters were identified from.
    `predictions` receives the measured and predicted torques of every sample (Fig. 7-8).
    """
    robot = model.robot
    sums = [empty() for _ in robot.joints]
    schema = _prediction_schema(robot, table)
    if predictions:
        meta = replace(table.meta, kind="prediction", robot=robot.name)
        predictions.start(replace(table, schema=schema, meta=meta).arrow_schema())
    parts = treated(table, robot, treatment or Treatment())
    for batch, rows, predicted in _predicted(parts, model):
        tau = np.ascontiguousarray(rows.y.T)
        counts = [np.flatnonzero(s) for s in rows.scales.T]
        sums = [
            accumulate(s, x[at], y[at])
            for s, x, y, at in zip(sums, tau, predicted, counts, strict=True)
        ]
        if predictions and batch is not None:
            new = dict(zip(schema.names[1:], (*tau, *predicted), strict=False))
            predictions.write(with_columns(batch, schema, new))
    return _metrics(table, robot, [Quality.of(s) for s in sums], model.delay)


Part = tuple[pa.RecordBatch | None, Rows]


def _predicted(
    parts: Iterator[Part], model: Identified
) -> Iterator[tuple[pa.RecordBatch | None, Rows, Array]]:
    """Each part of the motion with its predicted torques (joints, samples)."""
    if not model.delay:
        for batch, rows in parts:
            yield batch, rows, model.robot.torques(rows.W, model.theta)
        return
    for (batch, rows), around, own in _with_neighbours(parts):
        torques = model.robot.torques(around.W, model.theta)
        early = torques + model.delay * delay_column(around, torques.T).T
        yield batch, rows, np.ascontiguousarray(early[:, own])


def _with_neighbours(parts: Iterator[Part]) -> Iterator[tuple[Part, Rows, slice]]:
    """Each part, its rows with the sample before and the one after it, and where they are in these.

    A part waits for the next one.
    """
    before: list[Rows] = []
    held: Part | None = None
    for part in chain(parts, [None]):
        if held:
            rows = held[1]
            after = [part[1].part(slice(0, 1))] if part else []
            around = joined([*before, rows, *after])
            yield held, around, slice(len(before), len(before) + rows.samples)
            before = [rows.part(slice(-1, None))]
        held = part


def _prediction_schema(robot: Robot, table: Table) -> pa.Schema:
    fields = [number("t", "s")]
    for suffix in ("", "_pred"):
        fields += [
            number(f"tau{i}{suffix}", joint.torque_unit)
            for i, joint in enumerate(robot.joints, start=1)
        ]
    return pa.schema([*fields, *segment_field(table)])


def _metrics(table: Table, robot: Robot, qualities: list[Quality], delay: float) -> Table:
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
    extra = {**table.meta.extra, **({"delay": delay} if delay else {})}
    meta = replace(table.meta, kind="metrics", robot=robot.name, extra=extra)
    return Table("validate", schema, meta, iter([batch]))
