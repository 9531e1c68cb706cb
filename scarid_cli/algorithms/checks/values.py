"""Values that are missing, torques that stay at a value, and positions of two joints in one."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from scarid_cli.algorithms.checks.finding import Finding, failed, joints_text, ok, several, warning
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.regression.counting import SLOW
from scarid_cli.arrays import Array

# A signal that turns at its extreme has sqrt(2) - 1 times as many values at the second level of its
# resolution as at the first. Five times more at the first is no turn.
PILE = 5.0 / (2.0**0.5 - 1.0)
BIN = 0.01  # of the range: the levels below the extreme that it is compared with, at least one
FEWEST = 10  # values at the extreme
MANY = 0.05  # of the rows: the torque of so many is not known
INTERVAL = 0.2  # s, over which a moving joint goes further than a resting one with its noise
SEEN = 1000  # rows of a log in which equal positions are looked for first
MOST = 0.5  # of the rows in which a joint moves: more with one torque are not measured


def missing(log: Log) -> Finding:
    """Cells that are empty, nan or infinite."""
    counts = {
        name: int(np.count_nonzero(~np.isfinite(x)))
        for name, x in zip(["t", *log.names], [log.t, *log.signals], strict=True)
    }
    total = sum(counts.values())
    if not total:
        return ok("missing values", "none")
    columns = ", ".join(name for name, count in counts.items() if count)
    figure = f"{several(total, 'cell')} empty or not finite, in {columns}"
    if log.in_turn:
        figure = f"each row has the values of one source; {figure}"
        filled = log.filled().resampling("--missing", "fill")
        return failed("missing values", figure, f"{filled} interpolates them at the rows of q1")
    advice = f"{log.resampling('--missing', 'drop')} leaves these rows out, and interpolates"
    return failed("missing values", figure, advice)


def saturation(tau: Array) -> Finding:
    """Torques (joints, rows) that are flat at their greatest or least value."""
    counts = {i: clipped(x) for i, x in enumerate(tau, start=1)}
    flat = {i: count for i, count in counts.items() if count}
    if not flat:
        return ok("saturation", "no torque stays at its extreme")
    share = max(flat.values()) / tau.shape[1]
    figure = (
        f"the torque of {joints_text(flat)} stays at its extreme in {100.0 * share:.2g} % of the "
        "rows"
    )
    advice = "clipped: move more slowly, or raise the range of the sensor or the limit of the drive"
    return (failed if share > MANY else warning)("saturation", figure, advice)


def clipped(x: Array) -> int:
    """How many values (rows) lie at an extreme at which the signal is flat; 0 if it turns there."""
    x = x[np.isfinite(x)]
    return sum(_piled(y) for y in (x, -x)) if len(x) and np.ptp(x) > 0.0 else 0


def _piled(x: Array) -> int:
    """How many values are the greatest, if they are far more than those of a level just below."""
    levels, counts = np.unique(x, return_counts=True)
    near = int(np.count_nonzero(levels > levels[-1] - BIN * (levels[-1] - levels[0])))
    below = counts[-max(near, 2) : -1]
    count = int(counts[-1])
    return count if count >= FEWEST and count > PILE * below.mean() else 0


def copied(q: Array) -> Finding:
    """Positions (joints, rows) that are those of an earlier joint in every row, while it moves."""
    few = q[:, :: max(1, q.shape[1] // SEEN)]  # of a long log, hardly two joints agree in these
    pairs = [
        (i, j)
        for i, j in combinations(range(len(q)), 2)
        if _equal(few[i], few[j]) and _equal(q[i], q[j]) and np.nanmax(q[i]) > np.nanmin(q[i])
    ]
    first = {j: i for i, j in reversed(pairs)}
    if not first:
        return ok("equal positions", "none")
    texts = [f"q{j + 1} is q{first[j] + 1}" for j in sorted(first)]
    figure = f"{', '.join(texts)} in all {several(q.shape[1], 'row')}, although it moves"
    maps = " ".join(f"--map q{j + 1}=X" for j in sorted(first))
    advice = f"one column was logged twice: name that of the joint: `scarid convert {maps}`"
    return failed("equal positions", figure, advice)


def _equal(x: Array, y: Array) -> bool:
    return np.array_equal(x, y, equal_nan=True)


def constant(tau: Array) -> Finding:
    """Torques (joints, rows) that never change."""
    still = [i for i, x in enumerate(tau, start=1) if not np.nanmax(x) > np.nanmin(x)]
    if not still:
        return ok("constant torque", "none")
    figure = f"the torque of {joints_text(still)} never changes"
    return failed("constant torque", figure, "log the motor's torque or current of every joint")


def dead_zone(log: Log, period: float) -> Finding:
    """Torques that seldom change while their joint moves, in a log of this period [s]."""
    rows = max(1, round(INTERVAL / period))
    shares = np.array([_same(x, y, rows) for x, y in zip(log.q, log.tau, strict=True)])
    dead = np.flatnonzero(shares > MOST)
    if not len(dead):
        return ok("dead zone", "torques change while joints move")
    figure = (
        f"the torque of {joints_text(dead + 1)} is one and the same value in "
        f"{', '.join(f'{100.0 * x:.0f}' for x in shares[dead])} % of the rows in which it moves"
    )
    advice = "small torques are not measured: log the motor's current with all its digits"
    return failed("dead zone", figure, advice)


def _same(q: Array, tau: Array, rows: int) -> float:
    """The largest share with one torque of the rows in which a joint moves.

    It moves where it goes far within so many rows.
    """
    way = np.abs(q[rows:] - q[:-rows])
    moves = way > SLOW * np.sqrt(np.nanmean(way**2)) if np.isfinite(way).any() else way > 0.0
    moves &= np.isfinite(tau[: len(way)])
    values, counts = np.unique(tau[: len(way)][moves], return_counts=True)
    return float(counts.max() / counts.sum()) if len(values) else 0.0
