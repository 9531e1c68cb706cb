"""The rows of the regression from a motion, after the treatment that the user asked for."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.regression.counting import Counting, LeftOut, counted
from scarid_cli.algorithms.regression.rows import Rows, joined, rows_of, runs, without_slow
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.errors import bad_data
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import Table, matrix, segments_of, settled_runs

GAP_DURATION = 0.05  # s: longer than the intervals in the subsample of a long record


@dataclass(frozen=True)
class Treatment:
    """How the rows of a motion are treated before the fit.

    `skip` rows at the start and at the end of the table are left out. W and the torques are
    decimated by each factor of `decimate` in turn. Rows of a joint that is slower than `slow`
    (joints) [rad/s or m/s] are left out, and those near a reversal or standstill as `counting`
    says; it is None if all rows count. Two more options concern the fit: `align` also fits the time
    by which the torques lead the motion, and `essential` drops parameters that are not essential.
    """

    skip: tuple[int, int] = (0, 0)
    decimate: tuple[int, ...] = ()
    slow: tuple[float, ...] = ()
    counting: Counting | None = None
    align: bool = False
    essential: bool = False

    @property
    def holds(self) -> bool:
        """Whether the treatment needs all rows at once."""
        return bool(self.decimate) or self.align


@dataclass(frozen=True)
class Columns:
    """The columns that the regression of a robot needs from a motion sampled every h [s].

    With `reference`, these include the reference position and velocity if the table has them. If
    the estimator `follows` the reference, the motion is that of the reference as well.
    """

    robot: Robot
    h: float
    reference: bool
    follows: bool

    def motion(self, batch: pa.RecordBatch) -> Array:
        """Position, velocity, acceleration and torque (4, joints, samples)."""
        joints = len(self.robot.joints)
        of = "_ref" if self.follows else ""
        names = of_joints(joints, f"q{{i}}{of}", f"dq{{i}}{of}", f"ddq{{i}}{of}", "tau{i}")
        return matrix(batch, names).reshape(4, joints, batch.num_rows)

    def references(self, columns: list[str], batch: pa.RecordBatch) -> Array | None:
        """The reference position and velocity (2, joints, samples), if needed and present."""
        joints = len(self.robot.joints)
        names = of_joints(joints, "q{i}_ref", "dq{i}_ref")
        if not self.reference or not set(names) <= set(columns):
            return None
        return matrix(batch, names).reshape(2, joints, batch.num_rows)

    def rows(self, columns: list[str], batch: pa.RecordBatch, at: int, slow: Array | None) -> Rows:
        """The rows of a batch whose first sample has the number `at`."""
        return rows_of(
            self.robot,
            self.motion(batch),
            np.arange(at, at + batch.num_rows),
            self.h,
            slow=slow,
            reference=self.references(columns, batch),
        )


def treated(
    table: Table,
    robot: Robot,
    treatment: Treatment,
    seen: int = 0,
    *,
    reference: bool = False,
    follows: bool = False,
    left_out: LeftOut | None = None,
) -> Iterator[tuple[pa.RecordBatch | None, Rows]]:
    """The rows of the settled samples, each part with the batch that it comes from.

    `left_out` counts the rows that are left out near reversals and standstill.

    A treatment that needs all rows at once gives a single part, without a batch. `seen` is the
    number of the first sample. With `reference`, the rows include the reference of the robot; if
    the estimator `follows` it, they are those of the reference.
    """
    fitted = 0
    columns = Columns(robot, table.period, reference, follows)
    for batch, rows in _treated(table, columns, treatment, seen, left_out or LeftOut()):
        fitted += int(np.count_nonzero(rows.scales))
        yield batch, rows
    if not fitted:
        raise bad_data(
            table.name,
            "no rows to fit",
            expected="some rows that are settled and not left out",
            remedy="take a longer log, or leave out fewer rows",
        )


def _treated(
    table: Table, columns: Columns, treatment: Treatment, seen: int, left_out: LeftOut
) -> Iterator[tuple[pa.RecordBatch | None, Rows]]:
    parts = _parts(table, columns, treatment, seen)
    if treatment.counting and not treatment.decimate:
        parts = counted(parts, treatment.counting, left_out)
    if not treatment.holds:
        yield from parts
        return
    held = [rows for _, rows in parts]
    if held:
        yield None, _decimated(joined(held), treatment, left_out)


def _parts(
    table: Table, columns: Columns, treatment: Treatment, seen: int
) -> Iterator[tuple[pa.RecordBatch, Rows]]:
    """The rows of consecutive parts of the table; what is decimated keeps its slow rows."""
    slow = np.array(treatment.slow) if treatment.slow and not treatment.decimate else None
    gaps = Gaps(table.period)
    start, end = treatment.skip
    for first, kept in _after(start, settled_runs(_without_last(end, table.batches))):
        yield kept, columns.rows(table.columns, kept, seen + first + gaps.before(kept), slow)


class Gaps:
    """The jumps of the sample numbers at the gaps of a record, as if each took GAP_DURATION."""

    def __init__(self, period: float) -> None:
        self._first: int | None = None
        self._jump = max(1, round(GAP_DURATION / period)) if period > 0.0 else 1

    def before(self, batch: pa.RecordBatch) -> int:
        """The sum of all jumps before this batch, which lies within one segment."""
        segment = int(segments_of(batch)[0])
        if self._first is None:
            self._first = segment
        return (segment - self._first) * self._jump


def _without_last(rows: int, batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
    """The batches without the last rows of the table: rows are held back until enough follow."""
    held: deque[pa.RecordBatch] = deque()
    count = 0
    for batch in batches:
        held.append(batch)
        count += batch.num_rows
        while count - held[0].num_rows >= rows:
            count -= held[0].num_rows
            yield held.popleft()
            if not held:
                break
    if count > rows:
        yield held[0].slice(0, count - rows)


def _after(
    start: int, parts: Iterator[tuple[int, pa.RecordBatch]]
) -> Iterator[tuple[int, pa.RecordBatch]]:
    """The parts without the first rows of the table, each with the number of its first row."""
    for first, batch in parts:
        skipped = max(0, start - first)
        if skipped < batch.num_rows:
            yield first + skipped, batch.slice(skipped)


def _decimated(rows: Rows, treatment: Treatment, left_out: LeftOut) -> Rows:
    """The rows after all decimations, of which some may then be left out."""
    if not treatment.decimate:
        return rows
    from scarid_cli.algorithms.regression.decimation import decimated  # scipy.signal takes a second

    for factor in treatment.decimate:
        rows = decimated(rows, factor)
    if treatment.slow:
        rows = without_slow(rows, np.array(treatment.slow))
    if not treatment.counting:
        return rows
    parts = ((None, rows.part(run)) for run in runs(rows.at))
    counting = treatment.counting.decimated(rows.h)
    return joined([part for _, part in counted(parts, counting, left_out)])
