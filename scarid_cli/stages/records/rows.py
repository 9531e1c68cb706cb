"""The rows of the regression from a motion, after the treatment that the user asked for."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.regression.counting import LeftOut, counted
from scarid_cli.algorithms.regression.estimation import BaseEstimator
from scarid_cli.algorithms.regression.rows import (
    Rows,
    bare,
    joined,
    regressed,
    runs,
    without_slow,
)
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.errors import bad_data
from scarid_cli.io.facts import ORDER
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import Table, matrix, segments_of, settled_runs

MEASURED = ("q{i}", "dq{i}", "ddq{i}", "tau{i}")
FOLLOWED = ("q{i}_ref", "dq{i}_ref", "ddq{i}_ref", "tau{i}")
REFERENCE = FOLLOWED[:2]
GAP_DURATION = 0.05  # s: longer than the intervals in the subsample of a long record


def treated(
    table: Table,
    robot: Robot,
    treatment: Treatment,
    seen: int = 0,
    estimator: BaseEstimator | None = None,
    left_out: LeftOut | None = None,
) -> Iterator[tuple[pa.RecordBatch | None, Rows]]:
    """The rows of the settled samples, each part with the batch that it comes from.

    `left_out` counts the rows that are left out near reversals and standstill.

    Rows that are decimated are a single part, without a batch. `seen` is the number of the first
    sample. The rows include the reference position and velocity if the estimator needs them and the
    table has them; for one that follows the reference, the rows are those of the reference. Where
    the delay of the torques is fitted and nothing is decimated, rows are bare, as few may be kept.
    """
    fitted = 0
    if treatment.counting:
        counting = replace(treatment.counting, motors=robot.motors)
        treatment = replace(treatment, counting=counting)
    parts = _parts(table, robot, treatment, seen, estimator)
    for batch, rows in _treated(parts, treatment, left_out or LeftOut()):
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
    parts: Iterator[tuple[pa.RecordBatch, Rows]], treatment: Treatment, left_out: LeftOut
) -> Iterator[tuple[pa.RecordBatch | None, Rows]]:
    if treatment.counting and not treatment.decimate:
        parts = counted(parts, treatment.counting, left_out)
    if not treatment.decimate:
        yield from parts
        return
    held = [rows for _, rows in parts]
    if held:
        yield None, _decimated(joined(held), treatment, left_out)


def _parts(
    table: Table, robot: Robot, treatment: Treatment, seen: int, estimator: BaseEstimator | None
) -> Iterator[tuple[pa.RecordBatch, Rows]]:
    """The rows of consecutive parts of the table; what is decimated keeps its slow rows."""
    slow = np.array(treatment.slow) if treatment.slow and not treatment.decimate else None
    gaps = Gaps(table.period)
    signals = FOLLOWED if estimator and estimator.FOLLOWS else MEASURED
    known = set(of_joints(len(robot.joints), *REFERENCE)) <= set(table.columns)
    bandwidth, order = _low_pass(table, treatment)
    noise = tuple(table.meta.extra.get("velocity_noise") or ())
    start, end = treatment.skip
    for first, kept in _after(start, settled_runs(_without_last(end, table.batches))):
        at = seen + first + gaps.before(kept) + np.arange(kept.num_rows)
        motion = _signals(robot, kept, *signals)
        reference = None
        if known and estimator and estimator.REFERENCE:
            reference = _signals(robot, kept, *REFERENCE)
        rows = bare(motion, at, table.period, reference)
        rows = rows if treatment.align and not treatment.decimate else regressed(rows, robot)
        rows = rows if slow is None else without_slow(rows, slow)
        yield kept, replace(rows, bandwidth=bandwidth, order=order, noise=noise)


def _low_pass(table: Table, treatment: Treatment) -> tuple[float | None, int | None]:
    """The bandwidth [Hz] and the order of what the motion has passed, as far as they are known.

    The order is that of the bandwidth in the metadata, and of no other one that a user states.
    """
    bandwidth = table.meta.extra.get("bandwidth")
    stated = treatment.counting.bandwidth if treatment.counting else None
    return bandwidth, table.meta.extra.get(ORDER) if stated in (None, bandwidth) else None


def _signals(robot: Robot, batch: pa.RecordBatch, *names: str) -> Array:
    """The signals of these names (names, joints, samples)."""
    columns = of_joints(len(robot.joints), *names)
    return matrix(batch, columns).reshape(len(names), -1, batch.num_rows)


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
