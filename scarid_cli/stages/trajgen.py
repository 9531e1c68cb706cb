"""Check a trajectory against limits, tabulate it, and judge how well it excites a robot."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.regression.information import NotIdentifiableError, absorb, empty, solve
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.trajectory import Trajectory
from scarid_cli.algorithms.trajectories.via import ViaPath
from scarid_cli.arrays import Array
from scarid_cli.errors import bad_data
from scarid_cli.io.table import Metadata, Table, doubles, motion_fields, number

BATCH_ROWS = 4096


def via_points(table: Table, robot: Robot) -> ViaPath:
    """The via points of a table with columns t, q1, q2, ..."""
    joints = range(1, len(robot.joints) + 1)
    batches = list(table.batches)
    if not batches:
        raise bad_data(
            table.name,
            "no rows",
            expected="two via points or more",
            remedy="give a row for each via point",
        )
    times = np.concatenate([batch.column("t").to_numpy() for batch in batches])
    columns = [np.concatenate([b.column(f"q{i}").to_numpy() for b in batches]) for i in joints]
    return ViaPath(times - times[0], np.column_stack(columns))


def checked(trajectory: Trajectory, limits: Limits, rate: float) -> Trajectory:
    """The trajectory itself, if every row of its table at this rate [Hz] is within the limits."""
    for t, motion in samples(trajectory, rate):
        limits.require(t, *motion)
    return trajectory


def tabulate(trajectory: Trajectory, robot: Robot, rate: float, meta: Metadata) -> Table:
    """The reference as a table, one row every 1 / rate [s]."""
    units = [joint.unit for joint in robot.joints]
    schema = pa.schema([number("t", "s"), *motion_fields(units, "_ref")])
    return Table("trajgen", schema, meta, _rows(trajectory, rate, schema))


def _rows(trajectory: Trajectory, rate: float, schema: pa.Schema) -> Iterator[pa.RecordBatch]:
    for t, motion in samples(trajectory, rate):
        columns = [t, *(row for signal in motion for row in signal)]
        yield pa.RecordBatch.from_arrays([doubles(c) for c in columns], schema=schema)


def conditioning(trajectory: Trajectory, robot: Robot, rate: float) -> str:
    """The condition number of the observation matrix W along the trajectory, in words."""
    state = empty(len(robot.parameters))
    for _, motion in samples(trajectory, rate):
        W = robot.regressor(*motion)
        state, _ = absorb(state, W, np.zeros(W.shape[:2]))
    try:
        return f"condition number of W {solve(state).condition:.4g}"
    except NotIdentifiableError:
        return "W is singular: not every parameter is excited"


def samples(trajectory: Trajectory, rate: float) -> Iterator[tuple[Array, tuple[Array, ...]]]:
    """The times [s] of the rows of the table, and the motion at these times, in batches."""
    count = round(trajectory.duration * rate) + 1
    for start in range(0, count, BATCH_ROWS):
        t = np.arange(start, min(start + BATCH_ROWS, count)) / rate
        yield t, trajectory.sample(t)
