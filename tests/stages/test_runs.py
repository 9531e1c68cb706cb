"""Runs whose clock begins anew within one log: found, and put one after the other."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pyarrow as pa
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.io.table import Metadata, Table
from scarid_cli.runs import RUN, run_starts
from scarid_cli.stages.records.runs import runs_joined

PERIOD = 0.01


def joined(t: np.ndarray, sizes: list[int]) -> tuple[np.ndarray, list[str]]:
    """The times of a table of batches of these sizes, and what was said."""
    edges = np.unique(np.clip(np.cumsum([0, *sizes, len(t)]), 0, len(t)))
    schema = pa.schema([("t", pa.float64())])
    batches = [
        pa.RecordBatch.from_arrays([pa.array(t[a:b])], schema=schema)
        for a, b in pairwise(edges.tolist())
    ]
    said: list[str] = []
    table = runs_joined(Table("log", schema, Metadata(), iter(batches)), said.append)
    return np.concatenate([batch.column("t").to_numpy() for batch in table.batches]), said


@given(
    st.lists(st.integers(RUN + 2, 60), min_size=1, max_size=4),
    st.lists(st.integers(2, 50), max_size=8),
)
def test_every_run_goes_on_behind_the_one_before_it(runs: list[int], sizes: list[int]) -> None:
    """However the rows arrive; a gap of RUN periods is between two runs."""
    t = np.concatenate([PERIOD * np.arange(rows) for rows in runs])
    found, said = joined(t, sizes)
    steps = np.full(len(t) - 1, PERIOD)
    steps[np.cumsum(runs)[:-1] - 1] = RUN * PERIOD
    np.testing.assert_allclose(np.diff(found), steps, atol=1e-9)
    assert len(said) == len(runs) - 1


@given(st.integers(1, 150), st.lists(st.integers(2, 50), max_size=8))
def test_a_row_that_is_late_begins_no_run(row: int, sizes: list[int]) -> None:
    t = PERIOD * np.arange(200)
    t[row + 1 : row + 31] = np.roll(t[row + 1 : row + 31], -1)  # one row comes 30 rows late
    assert not run_starts(t, PERIOD)
    found, said = joined(t, sizes)
    np.testing.assert_array_equal(found, t)
    assert not said


@given(st.integers(1, 150), st.integers(1, RUN - 1), st.lists(st.integers(2, 50), max_size=8))
def test_times_that_leap_ahead_begin_no_run_where_they_return(
    row: int, count: int, sizes: list[int]
) -> None:
    t = PERIOD * np.arange(200)
    t[row : row + count] += 1e3
    assert not run_starts(t, PERIOD)
    found, said = joined(t, sizes)
    np.testing.assert_array_equal(found, t)
    assert not said


@given(
    st.sampled_from([86400.0, 2.0**32 * 1e-6, 2.0**32 * 1e-3, 2.0**16 * 1e-3]),
    st.integers(RUN + 2, 150),
    st.floats(0.0, 0.99),
    st.lists(st.integers(2, 50), max_size=8),
)
def test_a_clock_that_wraps_goes_on(
    wrap: float, before: int, phase: float, sizes: list[int]
) -> None:
    """As a time of the day at midnight, or a counter of 32 bits of microseconds."""
    t = PERIOD * (np.arange(200) + phase)
    logged = (t + wrap - PERIOD * before) % wrap
    found, said = joined(logged, sizes)
    np.testing.assert_allclose(found - found[0], t - t[0], atol=1e-6)
    assert len(said) == 1
    assert f"a clock that begins again after {wrap:.10g} s, which goes on" in said[0]
