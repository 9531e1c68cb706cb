"""Estimate a robot's parameters from a motion, and judge whether they can be relied on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import pyarrow as pa

from scarid_cli.algorithms.regression.estimation import BaseEstimator
from scarid_cli.algorithms.regression.information import RESIDUAL, NotIdentifiableError
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.statistics.blocks import Blocks
from scarid_cli.algorithms.statistics.lag_test import LAG
from scarid_cli.algorithms.statistics.outcome import Outcome, outcome
from scarid_cli.algorithms.statistics.subsample import ALL, Subsample
from scarid_cli.algorithms.statistics.verdict import InUse, combination
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.table import Table, number, segment_field, with_columns
from scarid_cli.stages import Sink
from scarid_cli.stages.parameters import parameters
from scarid_cli.stages.rows import Treatment, treated

LAGS = 5  # rows that the subsample of a long record has at least in the lag of the lag test


@dataclass(frozen=True)
class Checkpoint:
    """Where an estimation is: it can be saved, and go on with another log.

    `subsample` and `blocks` are for the statistics, the latter unless the former holds all rows.
    `seen` are the samples so far, left out ones included.
    """

    state: Any
    subsample: Subsample
    blocks: Blocks | None
    seen: int = 0

    @classmethod
    def begun(cls, state: Any, h: float, *, holds: bool) -> Checkpoint:
        """Before the first sample; samples are h [s] apart."""
        if holds:
            return cls(state, Subsample(samples=ALL), None)
        thinnest = int(LAG / LAGS / h + 1e-9) if h > 0.0 else 1
        return cls(state, Subsample(thinnest=max(1, thinnest)), Blocks.every(h))


def identify(
    table: Table,
    robot: Robot,
    estimator: BaseEstimator,
    initial: Array,
    *,
    treatment: Treatment | None = None,
    variance: str = RESIDUAL,
    trace: Sink | None = None,
    checkpoint: Checkpoint | None = None,
    keep: Callable[[Checkpoint], None] | None = None,
) -> Table:
    """The parameters, once every row of the motion has been taken in.

    `trace` receives the estimates after every sample (Fig. 6). `checkpoint` is where an earlier
    estimation left off, `keep` receives where this one does.
    """
    treatment = treatment or Treatment()
    estimator = estimator.for_robot(robot)
    if trace:
        schema = _trace_schema(robot, table)
        meta = replace(table.meta, kind="trace", robot=robot.name)
        trace.start(replace(table, schema=schema, meta=meta).arrow_schema())
    if checkpoint is None:
        holds = treatment.holds or estimator.HOLDS
        state = estimator.init(initial)
        checkpoint = Checkpoint.begun(state, table.period, holds=holds)
    for batch, rows in treated(
        table, robot, treatment, checkpoint.seen, reference=estimator.REFERENCE
    ):
        checkpoint, estimates = _stepped(estimator, checkpoint, rows, trace=trace is not None)
        if trace and batch is not None:
            new = dict(zip(robot.names, estimates.T, strict=True))
            trace.write(with_columns(batch, schema, new))
    _check_enough(table, robot, checkpoint.subsample.counted)
    found = _outcome(table, robot, estimator, initial, checkpoint, treatment)
    if keep:
        keep(checkpoint)
    meta = replace(table.meta, kind="parameters", robot=robot.name)
    scores = found.found.scores
    weighted = scores is not None and scores.whitening is not None
    in_use = InUse(treatment.slow, treatment.align, weighted, treatment.essential)
    return parameters(found, robot, meta, in_use, variance=variance)


def _check_enough(table: Table, robot: Robot, counted: int) -> None:
    if counted <= len(robot.names):
        raise bad_data(
            table.name,
            f"{counted} rows that count",
            expected=f"more than the {len(robot.names)} parameters of {robot.name}",
            remedy="take a longer log, or leave out fewer rows",
        )


def _stepped(
    estimator: BaseEstimator, checkpoint: Checkpoint, rows: Rows, *, trace: bool
) -> tuple[Checkpoint, Array]:
    state, estimates = estimator.step(checkpoint.state, rows, trace=trace)
    seen = int(rows.at[-1]) + 1 if rows.samples else checkpoint.seen
    blocks = checkpoint.blocks.add(rows) if checkpoint.blocks else None
    return Checkpoint(state, checkpoint.subsample.add(rows), blocks, seen), estimates


def _outcome(
    table: Table,
    robot: Robot,
    estimator: BaseEstimator,
    initial: Array,
    checkpoint: Checkpoint,
    treatment: Treatment,
) -> Outcome:
    try:
        return outcome(
            estimator,
            initial,
            checkpoint.state,
            checkpoint.subsample,
            checkpoint.blocks,
            align=treatment.align,
            reduce=treatment.essential,
        )
    except NotIdentifiableError as error:
        names = [*robot.names, *(error.added or ["the delay"])]
        raise BadData(
            f"{table.name}: not identifiable: the motion leaves "
            f"{combination(error.direction, names[: len(error.direction)])} undetermined; "
            "use a log that excites every joint"
        ) from None


def _trace_schema(robot: Robot, table: Table) -> pa.Schema:
    fields = (number(p.name, p.unit) for p in robot.parameters)
    return pa.schema([number("t", "s"), *fields, *segment_field(table)])
