"""Gains of the sliding mode differentiators (Levant 2003; Levant and Livne 2020)."""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array

LAMBDA = (
    (1.5, 1.1),
    (2.0, 2.12, 1.1),
    (3.0, 4.16, 3.06, 1.1),
    (5.0, 10.03, 9.30, 4.57, 1.1),
    (7.0, 23.72, 32.24, 20.26, 6.75, 1.1),
    (10.0, 47.69, 110.08, 101.96, 43.65, 9.91, 1.1),
    (12.0, 84.14, 281.37, 455.40, 295.74, 88.78, 14.13, 1.1),
)


def gains(order: int, bound: float) -> Array:
    """lambda_i bound^((i + 1) / (order + 1)) for i = 0 ... order, orders 1 to 7.

    bound: the largest derivative of order + 1.
    """
    powers = np.arange(1, order + 2) / (order + 1)
    scaled: Array = np.array(LAMBDA[order - 1]) * bound**powers
    return scaled
