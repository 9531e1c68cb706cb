"""The Butterworth low-pass against scipy's."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from scipy import signal
from unit.support import PERIOD, cuts

from scarid_cli.algorithms.filters.butterworth import Butterworth, ZeroPhase
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

RATE = 1.0 / PERIOD
ROWS = 60

every_order = pytest.mark.parametrize("order", range(1, 9))
cutoffs = pytest.mark.parametrize("cutoff", [0.5, 8.0, 60.0, 99.0])


def noise(samples: int) -> Array:
    return 5.0 + np.random.default_rng(1).standard_normal(samples)


def whole(low_pass: Butterworth | ZeroPhase, x: Array) -> Array:
    (y,) = over(low_pass, x, PERIOD)
    return y


@every_order
@cutoffs
def test_frequency_response_is_scipys(order: int, cutoff: float) -> None:
    ours = np.insert(Butterworth(cutoff, order).sections(PERIOD), 3, 1.0, axis=1)
    theirs = signal.butter(order, cutoff, fs=RATE, output="sos")
    # Short of half the rate, where a gain of nothing has no phase.
    w = np.linspace(0.0, 0.99 * RATE / 2.0, 500)
    _, response = signal.freqz_sos(ours, w, fs=RATE)
    _, expected = signal.freqz_sos(theirs, w, fs=RATE)
    np.testing.assert_allclose(response, expected, rtol=1e-8, atol=1e-12)


@every_order
@cutoffs
def test_causal_filter_starts_at_rest_as_sosfilt_zi_does(order: int, cutoff: float) -> None:
    x = noise(500)
    sections = signal.butter(order, cutoff, fs=RATE, output="sos")
    expected, _ = signal.sosfilt(sections, x, zi=signal.sosfilt_zi(sections) * x[0])
    np.testing.assert_allclose(whole(Butterworth(cutoff, order), x), expected, rtol=1e-9)


@every_order
@pytest.mark.parametrize("cutoff", [8.0, 60.0])
def test_zero_phase_filter_is_filtfilt(order: int, cutoff: float) -> None:
    x = noise(500)
    b, a = signal.butter(order, cutoff, fs=RATE)
    expected = signal.filtfilt(b, a, x, padlen=3 * order)
    # The polynomials b, a of filtfilt lose digits as the order grows: 1e-9 at order 8 and 8 Hz.
    np.testing.assert_allclose(whole(ZeroPhase(cutoff, order), x), expected, rtol=5e-9)


@every_order
def test_constant_passes_unchanged(order: int) -> None:
    x = np.full(ROWS, -7.3)
    for low_pass in (Butterworth(8.0, order), ZeroPhase(8.0, order)):
        np.testing.assert_allclose(whole(low_pass, x), x, rtol=1e-12)


@every_order
@given(chunks=cuts(ROWS))
@settings(max_examples=20, deadline=None)
def test_chunks_do_not_change_a_bit(order: int, chunks: list[slice]) -> None:
    low_pass, x = Butterworth(8.0, order), noise(ROWS)
    state, parts = low_pass.init(x[0], PERIOD), []
    for chunk in chunks:
        state, (y,) = low_pass.step(state, x[chunk])
        parts.append(y)
    np.testing.assert_array_equal(np.concatenate(parts), whole(low_pass, x))


def test_step_leaves_its_state_alone() -> None:
    low_pass, x = Butterworth(8.0), noise(ROWS)
    state = low_pass.init(0.0, PERIOD)
    first, second = (low_pass.step(state, x)[1] for _ in range(2))
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize("cutoff", [100.0, 101.0, np.inf])
def test_cutoff_at_or_above_half_the_rate_is_refused(cutoff: float) -> None:
    with pytest.raises(UsageFault, match=r"not below half the rate, 100 Hz|must be positive"):
        Butterworth(cutoff).init(0.0, PERIOD)


@pytest.mark.parametrize(
    ("settings", "complaint"),
    [
        ({"cutoff": 0.0}, "must be positive"),
        ({"cutoff": -8.0}, "must be positive"),
        ({"cutoff": np.nan}, "must be positive"),
        ({"cutoff": 8.0, "order": 0}, "must be positive"),
    ],
)
def test_setting_without_sense_is_refused(settings: dict[str, float], complaint: str) -> None:
    with pytest.raises(UsageFault, match=complaint):
        Butterworth(**settings)
