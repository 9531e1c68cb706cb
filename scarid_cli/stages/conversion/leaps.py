"""Take the wraps of angles and counters, and single glitches, out of a log."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.processes.leaps import leaps_of
from scarid_cli.arrays import Array
from scarid_cli.io.table import Table, matrix, with_columns


def without_leaps(
    table: Table, columns: Iterable[str], *, unwrap: bool, despike: bool, report: list[str]
) -> Table:
    """The table, some of whose columns are unwrapped, and whose glitches are nan.

    It is held in memory: a modulus is known from the whole column. `report` receives what was done.
    """
    batches = list(table.batches)
    new: dict[str, Array] = {}
    for name in columns:
        parts = [matrix(batch, [name])[0] for batch in batches]
        x = np.concatenate(parts) if parts else np.empty(0)
        leaps = leaps_of(x)
        if unwrap and len(leaps.wraps):
            x = new[name] = leaps.unwrapped(x)
            report.append(
                f"{name}: unwrapped {len(leaps.wraps)} leaps of {leaps.modulus:.6g}, the first in "
                f"row {leaps.wraps[0] + 1}"
            )
        if despike and len(leaps.glitches):
            new[name] = leaps.without_glitches(x)
            rows = ", ".join(str(row + 1) for row in leaps.glitches)
            report.append(f"{name}: took out the glitches in rows {rows}")
    return replace(table, batches=_rows(table, batches, new))


def _rows(
    table: Table, batches: list[pa.RecordBatch], new: dict[str, Array]
) -> Iterator[pa.RecordBatch]:
    at = 0
    for batch in batches:
        part = {name: x[at : at + batch.num_rows] for name, x in new.items()}
        at += batch.num_rows
        yield with_columns(batch, table.schema, part) if part else batch
