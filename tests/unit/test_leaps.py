"""Wraps and glitches in generated signals, against the signals that they were put into."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from scarid_cli.algorithms.processes.leaps import COUNTERS, TURNS, leaps_of
from scarid_cli.arrays import Array

ROWS = 2000


def motion(seed: int, *, noise: float = 1e-5) -> Array:
    """Five sines of 5 s to 1 s, several rad in all, at 200 Hz."""
    rng = np.random.default_rng(seed)
    t = np.arange(ROWS) / 200.0
    hertz, phase = rng.uniform(0.2, 1.0, 5), rng.uniform(0.0, 2.0 * pi, 5)
    size = rng.uniform(0.3, 1.0, 5) / hertz
    sines = size[:, None] * np.sin(2.0 * pi * hertz[:, None] * t + phase[:, None])
    return np.asarray(sines.sum(axis=0) + noise * rng.standard_normal(ROWS))


@given(st.integers(0, 2**32 - 1), st.sampled_from([2.0 * pi, pi, 360.0, 65536.0, 5.0]))
def test_a_signal_is_unwrapped_by_the_modulus_that_its_leaps_show(
    seed: int, modulus: float
) -> None:
    smooth = motion(seed) * (modulus / 6.0)
    wrapped = smooth % modulus
    leaps = leaps_of(wrapped)
    true = np.flatnonzero(np.abs(np.diff(wrapped)) > 0.5 * modulus) + 1
    assert leaps.wraps.tolist() == true.tolist()
    if len(true):
        assert leaps.modulus == pytest.approx(modulus, rel=0.02)
        off = leaps.unwrapped(wrapped) - smooth
        assert np.ptp(off) < 0.02 * modulus * len(true)


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 1e-5, 1e-2]), st.floats(1e-3, 1e3))
def test_a_motion_has_no_leaps(seed: int, noise: float, scale: float) -> None:
    leaps = leaps_of(scale * motion(seed, noise=noise))
    assert (len(leaps.wraps), len(leaps.glitches)) == (0, 0)


@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.floats(2.0, 1e6))
def test_single_glitches_are_found_and_taken_out(seed: int, count: int, size: float) -> None:
    assume(
        all(abs(size - known) > 0.1 * known for known in (*TURNS, *COUNTERS))
    )  # as if it wrapped
    rng = np.random.default_rng(seed)
    rows = np.sort(rng.choice(np.arange(10, ROWS - 10, 5), count, replace=False))
    spoiled = motion(seed)
    spoiled[rows] += size * rng.choice([-1.0, 1.0], count)
    leaps = leaps_of(spoiled)
    assert leaps.glitches.tolist() == rows.tolist()
    assert np.flatnonzero(np.isnan(leaps.without_glitches(spoiled))).tolist() == rows.tolist()


def test_missing_values_and_constants_have_no_leaps() -> None:
    x = motion(1)
    x[100:200] = np.nan
    assert not len(leaps_of(x).wraps)
    for still in (np.zeros(ROWS), np.full(ROWS, np.nan), np.zeros(3), np.empty(0)):
        assert not len(leaps_of(still).wraps) + len(leaps_of(still).glitches)
