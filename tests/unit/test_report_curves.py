"""Curves of a report: records of any length reduced to what a figure can show."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from reports import a_line

from scarid_cli.reporting import curves
from scarid_cli.reporting.curves import POINTS, Curve

finite = st.floats(-1e9, 1e9)


def reduced(values: Sequence[float] | np.ndarray, sizes: Sequence[int] = (8192,)) -> np.ndarray:
    """The points of a curve whose samples, a second apart, come in batches of these sizes."""
    curve, x = Curve(), np.asarray(values, dtype=float)
    t, start, turn = np.arange(len(x), dtype=float), 0, 0
    while start < len(x):
        stop = start + sizes[turn % len(sizes)]
        curve.add(t[start:stop], x[start:stop])
        start, turn = stop, turn + 1
    return curve.points()


@given(st.lists(finite, min_size=1, max_size=POINTS))
def test_a_short_curve_is_kept_as_it_is(values: list[float]) -> None:
    np.testing.assert_array_equal(reduced(values), a_line(*values))


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 40_000), st.lists(st.integers(1, 9000), min_size=1), st.integers(0, 99))
def test_a_reduced_curve_keeps_extremes_order_and_size_however_it_arrives(
    rows: int, sizes: list[int], seed: int
) -> None:
    values = np.cumsum(np.random.default_rng(seed).standard_normal(rows))
    t, x = points = reduced(values)
    assert points.shape[1] <= POINTS + 2
    assert (x.min(), x.max()) == (values.min(), values.max())
    assert (np.diff(t) > 0.0).all()
    np.testing.assert_array_equal(x, values[t.astype(int)])
    np.testing.assert_array_equal(reduced(values, sizes), points)


def test_a_reduced_curve_shows_every_spike_in_equal_parts() -> None:
    values = np.zeros(64_000)
    values[1000::8000] = 5.0
    values[5000::8000] = -5.0
    t, x = reduced(values)
    np.testing.assert_array_equal(t[x > 0.0], np.arange(1000, 64_000, 8000))
    np.testing.assert_array_equal(t[x < 0.0], np.arange(5000, 64_000, 8000))
    assert np.diff(t).max() <= 128  # parts of 64 samples, two points each


def test_a_curve_has_no_line_across_a_gap() -> None:
    t = np.concatenate((np.arange(50.0), 90.0 + np.arange(50.0)))
    drawn = curves.broken(np.array([t, np.sin(t)]))
    assert np.flatnonzero(np.isnan(drawn[0])).tolist() == [50]
    np.testing.assert_array_equal(drawn[0][~np.isnan(drawn[0])], t)
