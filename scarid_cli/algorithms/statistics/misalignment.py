"""The lag test: whether torques and derivatives belong to the same instant.

If torques and derivatives are misaligned, or if the derivatives are mostly noise, then the motion a
little earlier and later explains part of the torque that a row itself leaves unexplained.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, runs
from scarid_cli.arrays import Array

LAG = 0.025  # s: a typical delay of a soft sensor
PIECE = 1024  # samples that are processed at once
FLAT = 1e-9  # of the largest eigenvalue: directions below it are not in the lagged motion


def lag_share(rows: Rows, weights: Array, parameters: int) -> float:
    """The share of the residual that W one lag earlier and later explains, from 0 to 1.

    It is nan unless more rows have both neighbours than there are unknowns. The rows of a joint are
    weighted by `weights` (joints), the inverse standard deviations of the residuals. Slow rows
    should have been left out, because Coulomb friction near rest is not a matter of delay. The
    first `parameters` columns of W belong to the robot; only these are lagged.
    """
    if not weights.any():
        return 0.0  # no joint has a residual to explain
    lag = max(1, round(LAG / rows.h))
    p = rows.W.shape[2]
    unknowns, counted = p + 2 * parameters, 0
    total = np.zeros((unknowns + 1, unknowns + 1))
    for run in runs(rows.at):
        for part in _pieces(rows.part(run), lag):
            wide = _lagged(part, lag, weights, parameters)
            total += wide.T @ wide
            counted += int(np.count_nonzero(wide[:, -1]))
    if counted <= unknowns:
        return float("nan")
    own = [*range(p), -1]
    plain = _unexplained(total[np.ix_(own, own)])
    return 1.0 - _unexplained(total) / plain if plain > 0.0 else 0.0


def _pieces(rows: Rows, lag: int) -> Iterator[Rows]:
    """Parts of the rows that overlap by the lag on both sides."""
    for start in range(0, rows.samples, PIECE):
        part = rows.part(slice(max(0, start - lag), start + PIECE + lag))
        if part.samples > 2 * lag:
            yield part


def _lagged(rows: Rows, lag: int, weights: Array, parameters: int) -> Array:
    """The rows [W, W before - W, W after - W, y] of the samples that have both neighbours."""
    inner = slice(lag, rows.samples - lag)
    W, own = rows.W[inner], rows.W[inner, :, :parameters]
    before = rows.W[: -2 * lag, :, :parameters] - own
    after = rows.W[2 * lag :, :, :parameters] - own
    wide = np.concatenate((W, before, after, rows.y[inner, :, None]), axis=2)
    wide *= (rows.scales[inner] * weights)[:, :, None]
    return wide.reshape(-1, wide.shape[2])


def _unexplained(moments: Array) -> float:
    """The sum of squares of the last column that the others do not explain, from their products."""
    gram, with_y = moments[:-1, :-1], moments[:-1, -1]
    size = np.sqrt(np.diag(gram))
    size[size == 0.0] = 1.0
    values, vectors = np.linalg.eigh(gram / np.outer(size, size))
    kept = values > FLAT * values[-1]
    along = vectors[:, kept].T @ (with_y / size)
    return float(max(moments[-1, -1] - np.sum(along**2 / values[kept]), 0.0))
