"""Clocks that are coarser than the rows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import Shell
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.algorithms.processes.coarse import Ticks


def ticks(t: np.ndarray, values: np.ndarray, cuts: list[int]) -> Ticks:
    found = Ticks()
    for piece in np.split(np.arange(len(t)), sorted(c % (len(t) + 1) for c in cuts)):
        found.after(t[piece], values[:, piece])
    return found


@given(
    st.integers(4, 200),
    st.integers(3, 9),
    st.integers(0, 1 << 16),
    st.lists(st.integers(0, 1 << 10), max_size=4),
)
def test_the_rate_is_found_whatever_the_pieces(
    rate: int, seconds: int, seed: int, cuts: list[int]
) -> None:
    t = np.arange(seconds * rate + 1) / rate
    values = np.random.default_rng(seed).standard_normal((2, len(t)))
    found = ticks(np.floor(t + 1e-9), values, cuts)
    assert found.coarse
    assert found.rate == rate
    assert found.rows == len(t)
    assert found.unlike == len(t) - seconds - 1
    assert not ticks(t, values, cuts).coarse


@given(
    st.sampled_from([62.5, 120.0, 125.0, 250.0, 333.0, 400.0, 1000.0]),
    st.sampled_from([0.008, 0.01, 0.016, 0.02, 0.1, 1.0]),
    st.sampled_from([0.0, 1.7e9]),
)
def test_the_rate_is_found_where_ticks_have_rows_by_turns(
    rate: float, tick: float, epoch: float
) -> None:
    """As of 250 Hz in hundredths of a second: 2 and 3 rows."""
    rows = np.arange(int(25.0 * rate))
    times = np.round(epoch + tick * np.floor(rows / rate / tick + 1e-6), 3)
    found = ticks(times, np.random.default_rng(0).standard_normal((2, len(rows))), [])
    if found.coarse:
        assert found.rate == rate


@given(st.integers(2, 5), st.lists(st.integers(0, 1 << 10), max_size=4))
def test_rows_that_are_written_several_times_are_no_coarse_clock(
    times: int, cuts: list[int]
) -> None:
    t = np.repeat(0.01 * np.arange(50), times)
    values = np.repeat(np.random.default_rng(0).standard_normal((2, 50)), times, axis=1)
    assert not ticks(t, values, cuts).coarse


@pytest.mark.parametrize("epoch", [0, 1_700_000_000])
def test_whole_seconds_are_told_and_mended(epoch: int, shell: Shell, tmp_path: Path) -> None:
    shell(
        f"awk -F, -v OFS=, 'NR > 1 {{ $1 = sprintf(\"%d\", {epoch} + int($1)) }} 1'"
        " $SAMPLES/scara2.csv > log.csv"
    )
    refused = shell("scarid resample --rate 100 log.csv -o regular.csv")
    assert refused.status == 65
    assert "495 of 501 rows with the time of the row before, and other values" in refused.err
    assert not (tmp_path / "regular.csv").exists()
    mended = shell(
        'eval "$(scarid check -q --robot scara2 --fix log.csv)" > mended.csv;'
        " scarid identify --robot scara2 mended.csv -o a.csv;"
        " scarid identify --robot scara2 $SAMPLES/scara2.csv -o b.csv; cmp a.csv b.csv"
    )
    assert mended.status == 0, mended.err
