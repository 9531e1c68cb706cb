"""A Butterworth low-pass of an order, run forwards and backwards: its gain and its bandwidth."""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array


def two_sided_bandwidth(order: int) -> float:
    """The -3 dB bandwidth of both passes, over the cut-off of one of them."""
    return float((2.0**0.5 - 1.0) ** (0.5 / order))


def two_sided_gain(frequency: Array, order: int) -> Array:
    """The gain of both passes at frequencies over the cut-off."""
    return np.asarray(1.0 / (1.0 + frequency ** (2 * order)))
