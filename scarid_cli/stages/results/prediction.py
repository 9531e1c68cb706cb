"""Predict the torques of a motion with identified parameters, and measure how well they agree."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.inference.prediction import Quality, accumulate, empty
from scarid_cli.algorithms.regression.counting import LeftOut
from scarid_cli.algorithms.regression.rows import Rows, joined
from scarid_cli.algorithms.regression.shifting import led
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.arrays import Array
from scarid_cli.io.table import Table
from scarid_cli.stages.records.rows import treated
from scarid_cli.stages.results.parameters import Identified

Part = tuple[pa.RecordBatch | None, Rows]
Predicted = tuple[pa.RecordBatch | None, Rows, list[Array]]


def predicted(
    table: Table,
    models: Sequence[Identified],
    treatment: Treatment,
    left_out: LeftOut | None = None,
) -> Iterator[Predicted]:
    """Each part of a motion, with the torques (joints, samples) that each model predicts.

    All models have the same robot and the same delay, by which the predicted torques lead.
    `left_out` counts the rows that are left out.
    """
    parts = treated(table, models[0].robot, treatment, left_out=left_out)
    return of_parts(parts, models, table.period)


def of_parts(
    parts: Iterable[Part], models: Sequence[Identified], period: float
) -> Iterator[Predicted]:
    """The same of parts whose samples are `period` [s] apart."""
    delay, low_pass = models[0].delay, models[0].low_pass
    needed = max(model.reach(period) for model in models)
    for (batch, rows), around, own in _with_context(parts, needed):
        torques = [model.torques(around) for model in models]
        if delay:
            torques = [led(around, tau.T, delay, low_pass=low_pass).T for tau in torques]
        yield batch, rows, [np.ascontiguousarray(tau[:, own]) for tau in torques]


def _with_context(parts: Iterable[Part], needed: int) -> Iterator[tuple[Part, Rows, slice]]:
    """Each part, its rows with up to `needed` samples before and after, and the slice of its own.

    A part is returned once so many samples after it have been read.
    """
    before: list[Rows] = []
    waiting: deque[Part] = deque()
    for part in chain(parts, [None]):
        if part:
            waiting.append(part)
        following = sum(rows.samples for _, rows in waiting) - (
            waiting[0][1].samples if waiting else 0
        )
        while waiting and (part is None or following >= needed):
            own = waiting.popleft()
            after = [rows for _, rows in waiting]
            around = joined([*before, own[1], *after])
            first = sum(rows.samples for rows in before)
            yield own, around, slice(first, first + own[1].samples)
            before = _last(needed, [*before, own[1]])
            following -= waiting[0][1].samples if waiting else 0


def _last(count: int, parts: list[Rows]) -> list[Rows]:
    """The last so many samples of consecutive rows."""
    if not count:
        return []
    rows = joined(parts)
    return [rows.part(slice(max(0, rows.samples - count), None))]


def added(sums: list[Array], rows: Rows, torques: Array) -> list[Array]:
    """The sums of each joint after the rows whose scale is not zero.

    `torques` (joints, samples) are the predicted ones.
    """
    counts = [np.flatnonzero(scale) for scale in rows.scales.T]
    parts = zip(sums, rows.y.T, torques, counts, strict=True)
    return [accumulate(own, tau[at], found[at]) for own, tau, found, at in parts]


def qualities(
    table: Table, models: Sequence[Identified], treatment: Treatment
) -> list[list[Quality]]:
    """How well each model predicts each joint's torques."""
    sums = [[empty() for _ in model.robot.joints] for model in models]
    for _, rows, torques in predicted(table, models, treatment):
        sums = [added(own, rows, tau) for own, tau in zip(sums, torques, strict=True)]
    return [[Quality.of(joint) for joint in own] for own in sums]
