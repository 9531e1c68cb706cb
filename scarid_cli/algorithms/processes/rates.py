"""The rate at which a log is to be resampled: the mean rate of its rows, as a round number.

The interval between two rows says little about the rate of a clock that jitters, or whose stamps
are rounded, and neither does the median of the intervals: the mean rate does. Gaps do not count in
it, and rows that are missing count as if they were there.
"""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.processes.holding import MAX_GAP
from scarid_cli.arrays import Array, Marks, median

ROWS = 10_000  # of a log, whose mean rate is taken, at most
LATE = 2.5  # periods of two intervals: 2 with a late row, 3 with a missing one
FEW = 0.1  # of the rows: if more seem to be missing, it is the clock that jitters
# Of the rate, by which a rounder one may differ: that of a good clock, and that of any.
CLOSE, NEAR = 1e-4, 0.005


def mean_rate(steps: Array) -> float:
    """The mean rate [Hz] of rows that follow each other after these intervals [s], the first ones.

    Gaps do not count, nor do rows that repeat a time. It is 0 if time never increases.
    """
    steps = steps[:ROWS]
    steps = steps[steps > 0.0]
    if not len(steps):
        return 0.0
    period = median(steps)
    within = steps <= MAX_GAP * period
    lost = float(lost_rows(steps, period)[within].sum())
    count = float(np.count_nonzero(within))
    return (count + lost if lost <= FEW * count else count) / float(steps[within].sum())


def lost_rows(steps: Array, period: float) -> Array:
    """The number of rows that are missing in each interval [s], of rows every `period` [s].

    A late row makes a long interval beside a short one, and a missing row a long one only.
    """
    padded = np.concatenate(([period], steps, [period]))
    beside = np.minimum(padded[:-2], padded[2:])
    late = steps + np.minimum(beside, period) <= LATE * period
    return np.where(late, 0.0, np.maximum(np.round(steps / period) - 1.0, 0.0))


def round_rate(rate: float) -> float:
    """A rate [Hz] or period of few digits near a rate: 400 for 399.97, 1/0.003 for 333.33."""
    if not (rate > 0.0 and np.isfinite(1.0 / rate)):
        return rate
    period = _rounded(1.0 / rate, CLOSE, 2)
    found = _rounded(rate, CLOSE, 3) or (1.0 / period if period else None)
    return found or _rounded(rate, NEAR, 3) or rate


def _rounded(x: float, near: float, digits: int) -> float | None:
    """The number of the fewest digits that differs from x by at most this part, if there is one."""
    rounded = (float(f"{x:.{count}g}") for count in range(1, digits + 1))
    return next((y for y in rounded if abs(y - x) <= near * x), None)


def rate_text(rate: float) -> str:
    """The round rate near a rate [Hz], as it is typed."""
    return f"{round_rate(rate):.6g}"


def resampling_rate(t: Array, held: Marks) -> str:
    """The rate [Hz] at which these rows are to be resampled; empty if time never increases.

    Times t (rows) [s], and which rows are held samples.
    """
    rate = mean_rate(np.diff(t[np.isfinite(t) & ~held]))
    return rate_text(rate) if rate else ""
