"""Predict the torques of a motion with identified parameters, and measure how well they agree."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.regression.rows import Rows, delay_column, joined
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.statistics.prediction import Quality, accumulate, empty
from scarid_cli.arrays import Array
from scarid_cli.io.table import Table
from scarid_cli.stages.parameters import Identified
from scarid_cli.stages.rows import treated

Part = tuple[pa.RecordBatch | None, Rows]


def predicted(
    table: Table, models: Sequence[Identified], treatment: Treatment
) -> Iterator[tuple[pa.RecordBatch | None, Rows, list[Array]]]:
    """Each part of a motion, with the torques (joints, samples) that each model predicts.

    All models have the same robot and the same delay, by which the predicted torques lead.
    """
    delay = models[0].delay
    parts = treated(table, models[0].robot, treatment)
    for (batch, rows), around, own in _surrounded(parts) if delay else _alone(parts):
        torques = [model.robot.torques(around.W, model.theta) for model in models]
        if delay:
            torques = [tau + delay * delay_column(around, tau.T).T for tau in torques]
        yield batch, rows, [np.ascontiguousarray(tau[:, own]) for tau in torques]


def _alone(parts: Iterator[Part]) -> Iterator[tuple[Part, Rows, slice]]:
    for part in parts:
        yield part, part[1], slice(None)


def _surrounded(parts: Iterator[Part]) -> Iterator[tuple[Part, Rows, slice]]:
    """Each part, its rows with one more sample before and after, and the slice of its own rows.

    A part is returned only after the next one has been read.
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
