"""What `info` tells of the clock of a log."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stages.tables import PERIOD, table

from scarid_cli.stages.info import described

SIZES = st.lists(st.sampled_from([1, 7, 40, 8192]), min_size=1, max_size=3)


@given(SIZES)
@settings(max_examples=10, deadline=None)
def test_long_intervals_are_gaps_however_the_rows_arrive(sizes: list[int]) -> None:
    """Those beyond five periods, as `resample` has it; a missing row or two are none."""
    t = 7.0 + PERIOD * np.delete(np.arange(300), [*range(3, 13), 50, *range(200, 260)])
    found = described(table({"t": t, "q1": np.sin(t)}, sizes)).document["time"]
    assert found["gaps"] == 2
    assert found["missing_time"] == pytest.approx((11 + 61) * PERIOD)
    assert found["mean_period"] == pytest.approx((299 - 11 - 61) / 226 * PERIOD)


def test_rows_without_a_time_are_missing_values_and_no_gap() -> None:
    t = PERIOD * np.arange(100.0)
    t[[0, 40, 41]] = np.nan
    found = described(table({"t": t, "q1": np.arange(100.0)}, [7])).document
    assert found["columns"][0]["missing"] == 3
    assert (found["time"]["start"], found["time"]["gaps"]) == (PERIOD, 0)
