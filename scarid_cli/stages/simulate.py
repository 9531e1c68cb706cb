"""Simulate a robot that follows a trajectory in closed loop, and log its sensors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.imperfections.registry import Imperfections
from scarid_cli.algorithms.imperfections.rows import StandstillAfter, StandstillBefore
from scarid_cli.algorithms.plants.loop import ClosedLoop, DivergedError, LoopState
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.sensors import building
from scarid_cli.algorithms.sensors.recorder import Recorder, Rows
from scarid_cli.algorithms.sensors.standstill import with_standstill
from scarid_cli.algorithms.trajectories.hermite import Motion, refine
from scarid_cli.errors import BadData, UsageFault
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import Table, doubles, matrix, motion_fields, number, numbers

SIGNALS = ("q", "dq", "ddq")


def simulate(
    table: Table,
    loop: ClosedLoop,
    log_rate: float,
    *,
    truth: bool,
    given: Imperfections | None = None,
) -> Table:
    """The log, at the log rate [Hz], of a robot that follows a trajectory in closed loop.

    The robot starts at rest at the first position of the trajectory. The log has measured signals,
    with the imperfections that are given, and the reference; `truth` adds the true signals, and
    their time where that is not the time of the row.
    """
    given = given or Imperfections(len(loop.robot.joints))
    ratio = _whole(loop.control_rate * table.period, "the trajectory's rate")
    keep = _whole(loop.control_rate / log_rate, "the log rate")
    recorder = building.recorder(given, loop.encoder, loop.control_rate, keep)
    schema = _schema(loop.robot, truth=truth, jitter=building.jitters(given))
    meta = replace(table.meta, kind="measurement", robot=loop.robot.name, period=1.0 / log_rate)
    references = _references(table, len(loop.robot.joints), ratio)
    before, after = (
        round(given.one(kind) * loop.control_rate) for kind in (StandstillBefore, StandstillAfter)
    )
    rows = _rows(with_standstill(references, before, after), loop, recorder)
    return Table(table.name, schema, meta, _batches(rows, schema))


def _whole(ratio: float, what: str) -> int:
    whole = round(ratio)
    if whole < 1 or abs(ratio - whole) > 1e-6 * ratio:
        raise UsageFault(f"the control rate must be a whole multiple of {what}")
    return whole


def _schema(robot: Robot, *, truth: bool, jitter: bool) -> pa.Schema:
    torque = [joint.torque_unit for joint in robot.joints]
    units = [joint.unit for joint in robot.joints]
    fields = [number("t", "s"), *numbers("q{i}", units), *numbers("tau{i}", torque)]
    fields += motion_fields(units, "_ref")
    if truth:
        fields += [*motion_fields(units, "_true"), *numbers("tau{i}_true", torque)]
        fields += [number("t_true", "s")] if jitter else []
    return pa.schema(fields)


Timed = tuple[float, Rows]  # rows, and the time of the first tick [s]


def _batches(rows: Iterator[Timed], schema: pa.Schema) -> Iterator[pa.RecordBatch]:
    """The rows as batches with as many columns as the schema has."""
    for start, part in rows:
        if not len(part.t):
            continue
        signals = [row for signal in (*part.logged, *part.true) for row in signal]
        columns = [start + part.t, *signals, start + part.t_true]
        arrays = [doubles(column) for column in columns[: len(schema)]]
        yield pa.RecordBatch.from_arrays(arrays, schema=schema)


def _rows(
    references: Iterator[tuple[float, Motion]], loop: ClosedLoop, recorder: Recorder
) -> Iterator[Timed]:
    state: LoopState | None = None
    recording = recorder.init(loop.seed)
    tick, start = 0, 0.0
    for start, reference in references:
        if state is None:
            state = loop.init(reference[0][:, 0])
        try:
            state, log = loop.step(state, reference[0], reference[1])
        except DivergedError as error:
            when = start + (tick + error.tick) / loop.control_rate
            raise BadData(
                f"the closed loop became unstable at t = {when:.4g} s; lower the gains or raise "
                "the control rate"
            ) from None
        recording, rows = recorder.step(recording, log, reference)
        tick += log.q.shape[1]
        yield start, rows
    yield start, recorder.finish(recording)


def _references(table: Table, joints: int, ratio: int) -> Iterator[tuple[float, Motion]]:
    """The time [s] of the first row, and the reference at the ticks of the loop, in chunks."""
    columns = of_joints(joints, *(f"{name}{{i}}_ref" for name in SIGNALS))
    period = table.period
    start: float | None = None
    last = np.empty((3 * joints, 0))
    for batch in table.batches:
        if start is None:
            start = batch.column("t")[0].as_py()
        rows = np.column_stack((last, matrix(batch, columns)))
        if rows.shape[1] > 1:
            q, dq, ddq = np.split(rows, 3)
            yield start, refine(q, dq, ddq, period, ratio)
        last = rows[:, -1:]
    q, dq, ddq = np.split(last, 3)
    yield start or 0.0, (q, dq, ddq)
