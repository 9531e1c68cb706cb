"""Simulate a robot that follows a trajectory in closed loop, and log its sensors."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.imperfections.registry import Imperfections
from scarid_cli.algorithms.imperfections.rows import StandstillAfter, StandstillBefore
from scarid_cli.algorithms.plants import building
from scarid_cli.algorithms.plants.loop import (
    ClosedLoop,
    DivergedError,
    IndefiniteError,
    LoopState,
)
from scarid_cli.algorithms.sensors.recorder import Recorder, Rows
from scarid_cli.algorithms.sensors.signals import LoopLog
from scarid_cli.algorithms.sensors.standstill import with_standstill
from scarid_cli.algorithms.trajectories.hermite import Motion, refine
from scarid_cli.arrays import Array
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
    watch: Followed | None = None,
) -> Table:
    """The log, at the log rate [Hz], of a robot that follows a trajectory in closed loop.

    The robot starts at rest at the first position of the trajectory. The log has measured signals,
    with the imperfections that are given, and the reference. `truth` adds the true signals; the
    friction torques and the motion of the motors where imperfections of the robot change them; and
    the time of the truth where that is not the time of the row. `watch` takes how well the loop
    follows. With soft sensors in it, a loop that does not is refused at its end.
    """
    given = given or Imperfections(len(loop.robot.joints))
    ratio = _whole(loop.control_rate * table.period, "the trajectory's rate")
    keep = _whole(loop.control_rate / log_rate, "the log rate")
    recorder = building.recorder(given, loop, keep)
    _ = loop.plant  # refuses what cannot be simulated before anything is written
    schema = _schema(loop, truth=truth, jitter=building.jitters(given))
    meta = replace(table.meta, kind="measurement", robot=loop.robot.name, period=1.0 / log_rate)
    references = _references(table, len(loop.robot.joints), ratio)
    before, after = (
        round(given.one(kind) * loop.control_rate) for kind in (StandstillBefore, StandstillAfter)
    )
    if loop.sensors and watch is None:
        watch = Followed([joint.torque_limit for joint in loop.robot.joints])
    rows = _rows(with_standstill(references, before, after), loop, recorder, watch)
    return Table(table.name, schema, meta, _batches(rows, schema, len(loop.robot.joints)))


class Followed:
    """How well a loop follows its reference, and how its torques are.

    `limits` (joints) [N m or N] are those of the commanded torques.
    """

    def __init__(self, limits: Sequence[float]) -> None:
        joints = len(limits)
        self._limits = np.array(limits)[:, None]
        self._limited = np.zeros(joints)
        self._ticks = 0
        self._last: Array | None = None  # the last command (joints, 1)
        self._sums = np.zeros((4, joints))

    def take(self, reference: Array, log: LoopLog) -> None:
        """The reference (joints, ticks) and the log of some ticks."""
        before = log.command[:, :1] if self._last is None else self._last
        self._last = log.command[:, -1:]
        changes = np.diff(log.command, prepend=before)
        parts = ((reference - log.q_true) ** 2, changes**2, reference, reference**2)
        self._sums += [part.sum(axis=1) for part in parts]
        self._limited += np.count_nonzero(np.abs(log.command) >= self._limits, axis=1)
        self._ticks += reference.shape[1]

    @property
    def errors(self) -> Array:
        """The rms tracking error of each joint [rad or m]."""
        return np.asarray(np.sqrt(self._sums[0] / self._ticks))

    @property
    def changes(self) -> Array:
        """The rms change of the commanded torque of each joint from tick to tick [N m or N]."""
        return np.asarray(np.sqrt(self._sums[1] / self._ticks))

    @property
    def limited(self) -> Array:
        """The share of the time in which the torque of each joint is at its limit."""
        return np.asarray(self._limited / max(self._ticks, 1))

    @property
    def lost(self) -> bool:
        """Whether the robot follows worse than it would by resting at the mean of the reference."""
        mean, square = self._sums[2:] / self._ticks
        return bool(np.sum(self.errors**2) > np.sum(square - mean**2) > 0.0)


def _remedy(loop: ClosedLoop) -> str:
    """What to do about a loop that is unstable."""
    if loop.sensors:
        return "its soft sensor is too slow for the gains: lower these, or give a faster one"
    return "lower the gains or raise the control rate"


def _whole(ratio: float, what: str) -> int:
    whole = round(ratio)
    if whole < 1 or abs(ratio - whole) > 1e-6 * ratio:
        raise UsageFault(f"the control rate must be a whole multiple of {what}")
    return whole


def _schema(loop: ClosedLoop, *, truth: bool, jitter: bool) -> pa.Schema:
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
        fields += [number("t_true", "s")] if jitter else []
    return pa.schema(fields)


LOGGED = ("q{i}", "tau{i}", "q{i}_ref", "dq{i}_ref", "ddq{i}_ref")
MOTION = ("q{i}_true", "dq{i}_true", "ddq{i}_true")
TRUE = (*MOTION, "tau{i}_true", "friction{i}_true", "q{i}_motor_true", "dq{i}_motor_true")
Timed = tuple[float, Rows]  # rows, and the time of the first tick [s]


def _batches(rows: Iterator[Timed], schema: pa.Schema, joints: int) -> Iterator[pa.RecordBatch]:
    """The rows as batches with the columns of the schema."""
    names = of_joints(joints, *LOGGED, *TRUE)
    for start, part in rows:
        signals = (row for signal in (*part.logged, *part.true) for row in signal)
        columns = dict(zip(names, signals, strict=True))
        columns |= {"t": start + part.t, "t_true": start + part.t_true}
        if len(part.t):
            arrays = [doubles(columns[name]) for name in schema.names]
            yield pa.RecordBatch.from_arrays(arrays, schema=schema)


def _rows(
    references: Iterator[tuple[float, Motion]],
    loop: ClosedLoop,
    recorder: Recorder,
    watch: Followed | None,
) -> Iterator[Timed]:
    state: LoopState | None = None
    recording = recorder.init(loop.seed)
    start = 0.0
    for start, reference in references:
        if state is None:
            state = loop.init(reference[0][:, 0])
        try:
            state, log = loop.step(state, *reference)
        except DivergedError as error:
            when = start + error.tick / loop.control_rate
            raise BadData(
                f"the closed loop became unstable at t = {when:.4g} s; {_remedy(loop)}"
            ) from None
        except IndefiniteError:
            raise UsageFault(
                f"robot {loop.robot.name} cannot be simulated: its inertia matrix is not positive "
                "definite; give its links and motors inertias (`scarid robot check` shows them)"
            ) from None
        if watch:
            watch.take(reference[0], log)
        recording, rows = recorder.step(recording, log, reference)
        yield start, rows
    if loop.sensors and watch and watch.lost:
        raise BadData(f"the closed loop does not follow its reference; {_remedy(loop)}")
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
