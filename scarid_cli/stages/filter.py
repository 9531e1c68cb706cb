"""Low-pass chosen columns: row by row as they come, or forwards and backwards over all of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.filters.butterworth import Butterworth
from scarid_cli.algorithms.recursion import Lowpass
from scarid_cli.errors import bad_data
from scarid_cli.io.table import Table, matrix, with_columns


def causal(table: Table, filters: dict[str, Lowpass]) -> Table:
    """Streaming: each row leaves as it comes. One filter per column."""
    for lowpass in filters.values():
        lowpass.init(0.0, table.meta.period or 0.0)  # refuses settings before anything is written
    return replace(table, batches=_causal(table, filters))


def zero_phase(table: Table, columns: list[str], lowpass: Butterworth) -> Table:
    """Without delay; holds the whole table."""
    lowpass.sections(table.meta.period or 0.0)
    return replace(table, batches=_zero_phase(table, columns, lowpass))


def _causal(table: Table, filters: dict[str, Lowpass]) -> Iterator[pa.RecordBatch]:
    period = table.meta.period or 0.0
    states: dict[str, Any] = {}
    for batch in table.batches:
        columns = dict(zip(filters, matrix(batch, list(filters)), strict=True))
        for name, x in columns.items():
            if name not in states:
                states[name] = filters[name].init(float(x[0]), period)
            states[name], columns[name] = filters[name].step(states[name], x)
        yield with_columns(batch, table.schema, columns)


def _zero_phase(table: Table, columns: list[str], lowpass: Butterworth) -> Iterator[pa.RecordBatch]:
    batches = list(table.batches)
    rows = sum(batch.num_rows for batch in batches)
    if rows <= lowpass.padding:
        raise bad_data(
            table.name,
            f"{rows} rows",
            expected=f"more than {lowpass.padding} for a zero-phase filter of this order",
            remedy="give a longer log",
        )
    values = np.column_stack([matrix(batch, columns) for batch in batches])
    for row in values:
        row[:] = lowpass.zero_phase(row, table.meta.period or 0.0)
    start = 0
    for batch in batches:
        part = values[:, start : start + batch.num_rows]
        yield with_columns(batch, table.schema, dict(zip(columns, part, strict=True)))
        start += batch.num_rows
