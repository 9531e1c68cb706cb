"""Measure how well identified parameters predict the torques of a motion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.changes.wording import UNEXPLAINED
from scarid_cli.algorithms.inference.prediction import Quality, empty
from scarid_cli.algorithms.regression.counting import LeftOut
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.uncertainty.checkpoint import Checkpoint
from scarid_cli.io import schemas
from scarid_cli.io.table import Table, number, numbers, segment_field, table_of, with_columns
from scarid_cli.stages import Sink
from scarid_cli.stages.records.rows import treated
from scarid_cli.stages.records.times import Times
from scarid_cli.stages.results.changes import Known, verdict
from scarid_cli.stages.results.parameters import Identified
from scarid_cli.stages.results.prediction import Part, added, of_parts


class Beside(Protocol):
    """What judges the rows of a motion beside the metrics, as they pass."""

    def watched(self, parts: Iterator[Part], model: Identified, table: Table) -> Iterator[Part]:
        """The parts of the rows, which are seen on their way."""

    @property
    def extra(self) -> dict[str, Any]:
        """What it found, for the metadata of the metrics."""

    def told(self, change: dict[str, Any] | None, /) -> list[str]:
        """What it found in lines; `change` is what the verdict says of the robot."""


PREDICTED = 0.5  # of a torque: a prediction in another unit misses more


def validate(
    table: Table,
    model: Identified,
    *,
    treatment: Treatment | None = None,
    predictions: Sink | None = None,
    beside: Sequence[Beside] = (),
    before: Known | None = None,
    failed: Callable[[bool], Sequence[str]] = lambda _: (),
) -> Table:
    """The metrics of the torques that identified parameters predict for a motion, a row per joint.

    The predicted torques lead the motion by the delay that was fitted with the parameters.
    `predictions` receives the measured and predicted torques of every sample (Fig. 7-8), and
    all `beside` see the rows on their way. With
    `before`, what is known of the log of the identification, the metadata say whether the robot
    has changed since then. What `failed` among the checks of the log, told at its end and whether
    some torque is predicted, is then the likelier cause.
    """
    robot = model.robot
    sums, judged_sums = ([empty() for _ in robot.joints] for _ in range(2))
    schema = _prediction_schema(robot, table)
    if predictions:
        meta = replace(table.meta, kind="prediction", robot=robot.name)
        predictions.start(replace(table, schema=schema, meta=meta).arrow_schema())
    subsample = Checkpoint.at_start(None, table.period).subsample
    treatment, left_out = treatment or Treatment(), LeftOut()
    times = Times(table, 0)
    watched = times.watched(table)
    parts = treated(watched, robot, treatment, left_out=left_out)
    for other in beside:
        parts = other.watched(parts, model, table)
    for batch, rows, (torques,) in of_parts(parts, [model], table.period):
        sums = added(sums, rows, torques)
        if before:
            own = before.alike(rows)
            subsample = subsample.add(own)
            judged_sums = sums if own is rows else added(judged_sums, own, torques)
        if predictions and batch is not None:
            new = dict(zip(schema.names[1:], (*rows.y.T, *torques), strict=False))
            predictions.write(with_columns(batch, schema, new))
    extra: dict[str, Any] = {"left_out": left_out.counts} if treatment.counting else {}
    if model.delay:
        extra["delay"] = model.delay
    qualities = [Quality.of(joint) for joint in sums]
    if before:
        relative = np.array([Quality.of(one).relative_error / 100.0 for one in judged_sums])
        rows = left_out.settled(subsample.rows())
        judged = verdict(rows, model, before, relative, times)
        if causes := failed(bool(np.min(relative) < PREDICTED)):
            judged = replace(judged, grade=UNEXPLAINED, reason="; ".join(causes))
        extra["change"] = judged.extra
    for other in beside:
        extra |= other.extra
    return _metrics(table, robot, qualities, extra)


def _prediction_schema(robot: Robot, table: Table) -> pa.Schema:
    units = [joint.torque_unit for joint in robot.joints]
    torques = (*numbers("tau{i}", units), *numbers("tau{i}_pred", units))
    return pa.schema([number("t", "s"), *torques, *segment_field(table)])


def _metrics(table: Table, robot: Robot, qualities: list[Quality], extra: dict[str, Any]) -> Table:
    schema = schemas.load("metrics").arrow()
    rows = (
        (i, q.r2, q.rmse, joint.torque_unit, q.relative_error, q.samples)
        for i, (q, joint) in enumerate(zip(qualities, robot.joints, strict=True), start=1)
    )
    extra = {**table.meta.extra, **extra}
    meta = replace(table.meta, kind="metrics", robot=robot.name, extra=extra)
    return table_of("validate", schema, rows, meta)
