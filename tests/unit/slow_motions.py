"""Rows of a regression whose columns, and noise, change as slowly as motions do."""

from __future__ import annotations

import numpy as np
from unit.regressions import estimated

from scarid_cli.algorithms.estimators import ls
from scarid_cli.algorithms.regression.estimation import Estimation
from scarid_cli.algorithms.regression.rows import Rows, plain
from scarid_cli.arrays import Array

H = 0.005
P = 3
THETA = np.array([2.0, -1.0, 0.5])


def smooth(samples: int, columns: int, rng: np.random.Generator, reach: int = 20) -> Array:
    """Columns that change slowly, as motions do."""
    kernel = np.hanning(2 * reach + 1)
    noise = rng.standard_normal((samples + 2 * reach, columns))
    return np.column_stack([np.convolve(x, kernel, "valid") for x in noise.T])


def regression(samples: int = 2000, seed: int = 0, *, coloured: bool = True) -> Rows:
    """One joint with slow regressors and noise that is slow as well, or white."""
    rng = np.random.default_rng(seed)
    W = smooth(samples, P, rng)
    noise = smooth(samples, 1, rng)[:, 0] if coloured else rng.standard_normal(samples)
    return plain(W[:, None, :], (W @ THETA + noise)[:, None], H)


def least_squares(rows: Rows) -> Estimation:
    """Of the rows."""
    return estimated(ls.Estimator(), rows)
