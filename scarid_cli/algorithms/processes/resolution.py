"""The resolution of a sensor, as its readings show it."""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array

FEWEST = 20  # changes from which on a common step is no chance
WHOLE = 0.9  # of the changes, at least, are whole multiples of the resolution
TOLERANCE = 0.05  # of a step
ROUNDING = 5e-5  # of a change, by which a large one may be off if that is more
LARGEST = 0.25  # of a step: what is off by no more is still no chance
AT_ONCE = 3  # rows from one pair of equal readings to the next: a row between may be interpolated


def resolution_of(x: Array) -> float:
    """The resolution of a sensor as its readings x (rows) show it.

    It is the smallest change of which most are whole multiples: from one reading that repeats at
    once to the next one that does, as a row between them may be interpolated, or else from row to
    row. It is 0 at rest, and where there is no such change: the readings have the resolution of
    their numbers. Positions at which a robot stops between its motions are no steps of a sensor.
    """
    steps = np.diff(x)
    held = np.flatnonzero(steps == 0.0)
    at_once = np.diff(held) <= AT_ONCE
    return common_step(np.diff(x[held])[at_once], FEWEST) or common_step(steps, 1)


def common_step(changes: Array, fewest: int) -> float:
    """The smallest change, if most are whole multiples of it and there are at least `fewest`."""
    sizes = np.abs(changes)
    sizes = sizes[sizes > 0.0]
    if len(sizes) < fewest:
        return 0.0
    step = float(sizes.min())
    ratio = sizes / step
    error = np.abs(ratio - np.round(ratio))
    whole = error < np.clip(ROUNDING * ratio, TOLERANCE, LARGEST)
    return step if np.mean(whole) > WHOLE else 0.0
