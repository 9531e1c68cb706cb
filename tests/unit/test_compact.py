"""A measurement that is read once and kept: it can be read again as it came."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.io.table import SEGMENT, Metadata, Table
from scarid_cli.stages.records import compact
from scarid_cli.stages.records.compact import Compact


def measurement(rows: int, batch: int, *, segments: bool = True) -> pa.Table:
    """A log of one joint, with a note, a temperature that is missing at times, and segments."""
    rng = np.random.default_rng(rows)
    values = {name: rng.standard_normal(rows) for name in ("t", "tau1", "q1")}
    hot: list[Any] = [None if k % 3 == 0 else 20.0 + k for k in range(rows)]
    table = pa.table(
        values | {"hot": pa.array(hot, pa.float64()), "note": [str(k) for k in range(rows)]}
    )
    if segments:
        table = table.append_column(SEGMENT, pa.array(np.arange(rows) // 5, pa.int64()))
    return pa.Table.from_batches(table.to_batches(max_chunksize=batch), table.schema)


def read(table: pa.Table) -> Compact:
    meta = Metadata(kind="measurement", period=0.01)
    return Compact.of(Table("log", table.schema, meta, iter(table.to_batches())), 1)


@given(rows=st.integers(0, 40), batch=st.integers(1, 12), again=st.integers(1, 12))
def test_it_is_read_again_as_it_came_in_batches_of_any_length(
    rows: int, batch: int, again: int
) -> None:
    table = measurement(rows, batch)
    kept = read(table)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compact, "ROWS", again)
        for _ in range(2):
            batches = list(kept.table.batches)
            assert all(b.num_rows <= again for b in batches)
            found = pa.Table.from_batches(batches, table.schema)
            assert found.equals(table)


@given(rows=st.integers(1, 40), batch=st.integers(1, 12))
def test_the_segments_are_those_of_the_log(rows: int, batch: int) -> None:
    table = measurement(rows, batch)
    parts = read(table).segments
    assert [part.shape[1] for part in parts] == np.unique(
        table.column(SEGMENT).to_numpy(), return_counts=True
    )[1].tolist()
    np.testing.assert_array_equal(np.hstack(parts)[0], table.column("q1").to_numpy())
    np.testing.assert_array_equal(np.hstack(parts)[1], table.column("tau1").to_numpy())


def test_a_log_without_gaps_is_one_segment_and_one_without_rows_none() -> None:
    assert [x.shape for x in read(measurement(7, 3, segments=False)).segments] == [(2, 7)]
    assert read(measurement(0, 3, segments=False)).segments == []


def test_what_is_missing_in_another_column_is_nan() -> None:
    hot = read(measurement(9, 4)).other(["hot"])[0]
    np.testing.assert_array_equal(np.isnan(hot), np.arange(9) % 3 == 0)
    np.testing.assert_array_equal(hot[1::3], 20.0 + np.arange(1, 9, 3))
