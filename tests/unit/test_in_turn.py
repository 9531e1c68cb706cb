"""Rows with the values of one source each, against interpolation by pandas."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.algorithms.processes.in_turn import in_turn, interpolated
from scarid_cli.errors import BadData
from scarid_cli.io.table import SEGMENT, Metadata, Table
from scarid_cli.stages.records.filled import Filled


def rows(seed: int, sources: int, chance: float) -> tuple[np.ndarray, np.ndarray]:
    """Times (rows) [s] and values (2 sources, rows): of a source in its rows, elsewhere nan."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(0.001, 0.003, 60 * sources))
    values = np.full((2 * sources, len(t)), np.nan)
    for row in range(len(t)):
        own = row % sources if rng.random() > chance else int(rng.integers(sources))
        values[2 * own : 2 * own + 2, row] = rng.standard_normal(2)
    return t, values


@given(st.integers(0, 1 << 16), st.integers(2, 4), st.floats(0.0, 0.2))
def test_values_are_those_of_interpolation_by_time(seed: int, sources: int, chance: float) -> None:
    t, values = rows(seed, sources, chance)
    assert in_turn(values)
    kept, found = interpolated(t, values)
    frame = pd.DataFrame(values.T, index=t).interpolate("index", limit_area="inside")
    assert np.isfinite(values[0, kept]).all()
    np.testing.assert_allclose(found.T, frame.to_numpy()[kept], rtol=1e-12)
    lost = np.setdiff1d(np.flatnonzero(np.isfinite(values[0])), kept)
    outside = frame.isna().any(axis=1).to_numpy()[lost]
    assert outside.sum() >= len(lost) - 20  # the others lie in gaps of a source


def test_nothing_is_interpolated_across_a_gap_of_a_source() -> None:
    t, values = rows(1, 2, 0.0)
    values[2:, 40:80] = np.nan
    kept, _ = interpolated(t, values)
    assert not np.any((kept >= 40) & (kept < 79))
    assert np.count_nonzero(kept < 40) > 15
    assert np.count_nonzero(kept >= 79) > 15


@pytest.mark.parametrize("share", [0.0, 0.1, 0.4])
def test_a_log_with_single_holes_is_not_one_of_sources_in_turn(share: float) -> None:
    values = np.random.default_rng(2).standard_normal((4, 500))
    values[1, : int(500 * share)] = np.nan
    assert not in_turn(values)


def table(t: np.ndarray, values: np.ndarray, segments: np.ndarray) -> Table:
    columns = {"t": t, "q1": values[0], "tau1": values[2], SEGMENT: segments}
    batch = pa.RecordBatch.from_pydict({k: pa.array(x) for k, x in columns.items()})
    return Table("log", batch.schema, Metadata(), iter([batch.slice(0, 50), batch.slice(50)]))


def test_segments_are_filled_apart_and_rows_keep_their_numbers() -> None:
    t, values = rows(3, 2, 0.0)
    segments = (np.arange(len(t)) >= 60).astype(np.int64)
    filled = Filled(["t", "q1", "tau1"])
    made = filled.removed(table(t, values, segments))
    (batch,) = made.batches
    numbers = [made.row(k) - 1 for k in range(1, batch.num_rows + 1)]
    assert batch["t"].to_pylist() == t[numbers].tolist()
    assert filled.count == len(t) - batch.num_rows
    first, second = (
        interpolated(t[own], values[[0, 2]][:, own]) for own in (segments == 0, segments == 1)
    )
    expected = [*first[1][1], *second[1][1]]
    np.testing.assert_array_equal(batch["tau1"].to_numpy(), expected)


def test_sources_that_never_overlap_are_refused() -> None:
    t, values = rows(4, 2, 0.0)
    values[0, :60] = values[2, 60:] = np.nan
    with pytest.raises(BadData, match="no row of q1 lies between readings of tau1"):
        list(Filled(["t", "q1", "tau1"]).removed(table(t, values, np.zeros(len(t), int))).batches)
