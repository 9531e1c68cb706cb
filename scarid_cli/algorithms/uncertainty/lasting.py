"""What lasts in the residual of a torque: not noise, but what the model lacks.

White noise behind a low-pass is uncorrelated after half a period of its bandwidth: there the
autocovariance of a Butterworth filter, forwards and backwards, has its first zero, whatever its
order. What the model lacks follows the motion, which is slower. So the autocovariance after that
is the power of what lacks. Oscillations count as well, for the mean of its squares is taken, less
that which noise alone gives it.
"""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.uncertainty.reversals import away_from_reversals
from scarid_cli.arrays import Array, Marks, Numbers

# Periods of the bandwidth, from beyond the first zero to before the motion has changed.
FIRST, LAST = 2.0 / 3.0, 4.0 / 3.0
LAGS = 32  # in a period: between them it hardly changes
FEWEST = 10  # independent values, of which there is a mean


def lasting(residual: Array, rows: Rows) -> Array:
    """The root mean square [N m or N] of what lasts in a residual (samples, joints), of each joint.

    Rows near reversals do not count, where sign(dq) is not the friction. It is nan of a joint of
    which too few rows are left.
    """
    period = 1.0 / (rows.bandwidth * rows.h) if rows.bandwidth and rows.h > 0.0 else 1.0
    first, last = (max(1, round(part * period)) for part in (FIRST, LAST))
    lags = range(first, last + 1, max(1, round(period / LAGS)))
    counts = away_from_reversals(rows) > 0.0
    values = np.where(counts, residual, 0.0)
    power = _autocovariance(values, counts, rows.at, 0)
    later = np.array([_autocovariance(values, counts, rows.at, lag) for lag in lags])
    with np.errstate(divide="ignore", invalid="ignore"):
        independent = np.count_nonzero(counts, axis=0) * min(1.0, 2.0 / period)
        squares = np.mean(later**2, axis=0) - power**2 / independent
        found = np.maximum(squares, 0.0) ** 0.25
    return np.where(independent >= FEWEST, found, np.nan)


def _autocovariance(values: Array, counts: Marks, at: Numbers, lag: int) -> Array:
    """The mean product (joints) of values this many samples apart; 0 where there are none."""
    later = np.searchsorted(at, at + lag)
    first = np.flatnonzero(at[np.minimum(later, len(at) - 1)] == at + lag)
    then = later[first]
    pairs = np.count_nonzero(counts[then] & counts[first], axis=0)
    return np.asarray(np.sum(values[then] * values[first], axis=0) / np.maximum(pairs, 1))
