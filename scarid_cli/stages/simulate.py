"""Simulate a robot that follows a trajectory in closed loop, and log its sensors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.plants.loop import (
    ClosedLoop,
    DivergedError,
    IndefiniteError,
    LoopLog,
    LoopState,
)
from scarid_cli.algorithms.trajectories.hermite import Motion, refine
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, UsageFault
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import Table, doubles, matrix, motion_fields, number, numbers

SIGNALS = ("q", "dq", "ddq")


def simulate(table: Table, loop: ClosedLoop, log_rate: float, *, truth: bool) -> Table:
    """The log, at the log rate [Hz], of a robot that follows a trajectory in closed loop.

    The robot starts at rest at the first position of the trajectory. The log has measured signals
    and the reference; `truth` adds the true signals, with the friction torques and the motion of
    the motors where imperfections of the robot change them.
    """
    period = table.period
    ratio = _whole(loop.control_rate * period, "the trajectory's rate")
    keep = _whole(loop.control_rate / log_rate, "the log rate")
    schema = _schema(loop, truth=truth)
    meta = replace(table.meta, kind="measurement", robot=loop.robot.name, period=1.0 / log_rate)
    return Table(table.name, schema, meta, _rows(table, loop, ratio, keep, schema))


def _whole(ratio: float, what: str) -> int:
    whole = round(ratio)
    if whole < 1 or abs(ratio - whole) > 1e-6 * ratio:
        raise UsageFault(f"the control rate must be a whole multiple of {what}")
    return whole


def _schema(loop: ClosedLoop, *, truth: bool) -> pa.Schema:
    torque = [joint.torque_unit for joint in loop.robot.joints]
    units = [joint.unit for joint in loop.robot.joints]
    fields = [number("t", "s"), *numbers("q{i}", units), *numbers("tau{i}", torque)]
    fields += motion_fields(units, "_ref")
    if truth:
        fields += [*motion_fields(units, "_true"), *numbers("tau{i}_true", torque)]
        if loop.imperfections.rub:
            fields += numbers("friction{i}_true", torque)
        if loop.imperfections.bend:
            fields += numbers("q{i}_motor_true", units)
            fields += numbers("dq{i}_motor_true", [f"{unit}/s" for unit in units])
    return pa.schema(fields)


def _rows(
    table: Table, loop: ClosedLoop, ratio: int, keep: int, schema: pa.Schema
) -> Iterator[pa.RecordBatch]:
    state: LoopState | None = None
    tick = 0
    for start, reference in _references(table, len(loop.robot.joints), ratio):
        if state is None:
            state = loop.init(reference[0][:, 0])
        try:
            state, log = loop.step(state, *reference)
        except DivergedError as error:
            when = start + error.tick / loop.control_rate
            raise BadData(
                f"the closed loop became unstable at t = {when:.4g} s; lower the gains or raise "
                "the control rate"
            ) from None
        except IndefiniteError:
            raise UsageFault(
                f"robot {loop.robot.name} cannot be simulated: its inertia matrix is not positive "
                "definite; give its links and motors inertias (`scarid robot check` shows them)"
            ) from None
        ticks = np.arange(-tick % keep, log.q.shape[1], keep)
        t = start + (tick + ticks) / loop.control_rate
        signals = [log.q, log.tau, *reference, *_truth(loop, log)]
        columns = [t, *(row[ticks] for signal in signals for row in signal)]
        arrays = [doubles(column) for column in columns[: len(schema)]]
        yield pa.RecordBatch.from_arrays(arrays, schema=schema)
        tick += log.q.shape[1]


def _truth(loop: ClosedLoop, log: LoopLog) -> list[Array]:
    """The true signals, in the order of the schema."""
    signals = [log.q_true, log.dq_true, log.ddq_true, log.tau_true]
    if loop.imperfections.rub:
        signals.append(log.friction_true)
    if loop.imperfections.bend:
        signals += [log.q_motor_true, log.dq_motor_true]
    return signals


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
