"""A Butterworth low-pass of an order, run forwards and backwards: its gain and its bandwidth."""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array

PERIODS = 3.0  # of the cut-off, after which the response to an impulse has decayed to 1e-4


def two_sided_bandwidth(order: int) -> float:
    """The -3 dB bandwidth of both passes, over the cut-off of one of them."""
    return float((2.0**0.5 - 1.0) ** (0.5 / order))


def two_sided_gain(frequency: Array, order: int) -> Array:
    """The gain of both passes at frequencies over the cut-off."""
    return np.asarray(1.0 / (1.0 + frequency ** (2 * order)))


def two_sided_taps(cutoff: float, order: int, most: int) -> Array:
    """The response to an impulse of both passes, at most so many samples to either side; sum 1.

    cutoff: in cycles per sample.
    """
    half = min(int(PERIODS / cutoff) + 1, most)
    length = 1 << (8 * half).bit_length()
    frequencies = np.asarray(np.fft.rfftfreq(length), dtype=np.float64) / cutoff
    response = np.fft.irfft(two_sided_gain(frequencies, order), length)
    taps = np.concatenate((response[length - half :], response[: half + 1]))
    return np.asarray(taps / taps.sum())
