"""What to type where a log has no constant rate, or lacks values."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import pyarrow as pa

from scarid_cli.errors import CORRECT, BadData
from scarid_cli.io.table import concatenated

ENOUGH = 1000  # rows, from which on the mean rate of rounded times is known within a tenth of a %

# Given the first rows from a fault on, what to do about it.
Remedy = Callable[[pa.RecordBatch], str]


def _corrected(_: pa.RecordBatch) -> str:
    return CORRECT


def _resampled(_: pa.RecordBatch) -> str:
    return "put it on a constant rate with `scarid resample`"


@dataclass(frozen=True)
class Remedies:
    """What mends a row that lacks a `value`, and a `clock` that does not keep to its rate."""

    value: Remedy = _corrected
    clock: Remedy = _resampled


def read_on(batch: pa.RecordBatch, batches: Iterator[pa.RecordBatch]) -> pa.RecordBatch:
    """The rows of a batch and enough of those that follow, up to the next fault."""
    rows, count = [batch], batch.num_rows
    try:
        while count < ENOUGH and (following := next(batches, None)) is not None:
            rows.append(following)
            count += following.num_rows
    except BadData:
        pass
    return concatenated(rows)
