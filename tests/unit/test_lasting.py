"""What lasts in a residual, beside noise behind a low-pass that scipy makes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import butter, sosfiltfilt

from scarid_cli.algorithms.regression.rows import Rows, plain
from scarid_cli.algorithms.uncertainty.lasting import lasting
from scarid_cli.arrays import Array

H, CUTOFF, SAMPLES = 0.01, 8.0, 4000
TIME = H * np.arange(SAMPLES)


def rows(order: int = 4) -> Rows:
    """Rows of two joints that reverse every five seconds, behind a low-pass of this order."""
    velocity = np.sign(np.sin(2.0 * np.pi * 0.1 * TIME + 0.1))
    motion = np.zeros((4, 2, SAMPLES))
    motion[1] = velocity
    bandwidth = CUTOFF * (np.sqrt(2.0) - 1.0) ** (1.0 / (2 * order))  # of both runs together
    one = plain(np.zeros((SAMPLES, 2, 1)), np.ones((SAMPLES, 2)), H)
    return replace(one, motion=motion, bandwidth=bandwidth, order=order)


def noise(seed: int, order: int = 4) -> Array:
    """White noise behind the low-pass, with a root mean square of 1 (samples, joints)."""
    sections = butter(order, 2.0 * H * CUTOFF, output="sos")
    passed = sosfiltfilt(sections, np.random.default_rng(seed).standard_normal((SAMPLES, 2)), 0)
    return np.asarray(passed / passed.std(axis=0))


@pytest.mark.parametrize("order", [2, 3, 4, 6])
def test_noise_does_not_last(order: int) -> None:
    """Its power is 1; an ideal low-pass would leave 0.13 of it, in the side lobes of a sinc."""
    found = [lasting(noise(seed, order), rows(order)) ** 2 for seed in range(20)]
    assert np.mean(found) < 0.13


@settings(max_examples=30)
@given(st.floats(0.5, 3.0), st.floats(0.1, 0.5), st.integers(0, 1000))
def test_what_follows_the_motion_lasts(size: float, frequency: float, seed: int) -> None:
    """But for a tenth, by which a slow sine changes over the lags, and for what noise adds.

    The product of noise and sine has the standard deviation 2 size / sqrt(n), with n independent
    values of the noise: five of these are exceeded once in two million examples.
    """
    lacks = size * np.sqrt(2.0) * np.sin(2.0 * np.pi * frequency * TIME)
    found = lasting(noise(seed) + np.column_stack((lacks, np.zeros(SAMPLES))), rows())
    independent = 2.0 * CUTOFF * TIME[-1]
    chance = 5.0 * 2.0 * size / np.sqrt(independent)
    assert found[0] ** 2 == pytest.approx(size**2, abs=0.1 * size**2 + chance)
    assert found[1] < 0.5


def test_rows_near_reversals_and_those_left_out_do_not_count() -> None:
    every = rows()
    turns = np.abs(np.diff(every.motion[1, 0], append=every.motion[1, 0, -1])) > 0.0
    residual = np.where(turns[:, None], 1e3, noise(0))
    few = every.part(np.r_[0:1500, 2500:SAMPLES])
    assert np.all(lasting(residual, every) < 0.5)
    assert np.all(lasting(residual[few.at], few) < 0.5)


def test_too_few_rows_say_nothing() -> None:
    short = rows().part(np.arange(40))
    assert np.all(np.isnan(lasting(noise(0)[:40], short)))
