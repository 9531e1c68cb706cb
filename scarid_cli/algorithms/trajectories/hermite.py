"""Finer samples of a reference, by quintic Hermite interpolation.

Between two rows lies the polynomial of fifth order with the position, velocity and acceleration of
both rows. It is exact within a segment of a trajectory of fifth order, at any rate of the table.
"""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array

Motion = tuple[Array, Array, Array]

# Rows: value at 0, slope at 0, curvature at 0, curvature at 1, slope at 1, value at 1.
BASIS = np.array(
    [
        [1.0, 0.0, 0.0, -10.0, 15.0, -6.0],
        [0.0, 1.0, 0.0, -6.0, 8.0, -3.0],
        [0.0, 0.0, 0.5, -1.5, 1.5, -0.5],
        [0.0, 0.0, 0.0, 0.5, -1.0, 0.5],
        [0.0, 0.0, 0.0, -4.0, 7.0, -3.0],
        [0.0, 0.0, 0.0, 10.0, -15.0, 6.0],
    ]
)


def refine(q: Array, dq: Array, ddq: Array, period: float, ratio: int) -> Motion:
    """Position, velocity and acceleration (joints, (rows - 1) * ratio), from row to row.

    q, dq and ddq are (joints, rows), a period [s] apart; each row becomes `ratio` samples.
    """
    known = (
        q[:, :-1],
        dq[:, :-1] * period,
        ddq[:, :-1] * period**2,
        ddq[:, 1:] * period**2,
        dq[:, 1:] * period,
        q[:, 1:],
    )
    powers = (np.arange(ratio) / ratio) ** np.arange(6)[:, None]
    degree = np.arange(6)[:, None]
    slopes = BASIS[:, 1:] @ (degree[1:] * powers[:-1]) / period
    bends = BASIS[:, 2:] @ (degree[2:] * degree[1:-1] * powers[:-2]) / period**2
    return _blend(known, BASIS @ powers), _blend(known, slopes), _blend(known, bends)


def _blend(known: tuple[Array, ...], weights: Array) -> Array:
    # Summed term by term: a matrix product would round differently with the number of rows.
    total = known[0][:, :, None] * weights[0]
    for values, row in zip(known[1:], weights[1:], strict=True):
        total = total + values[:, :, None] * row
    return np.reshape(total, (len(total), -1))
