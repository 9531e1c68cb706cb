"""Runs of a robot that stand in one log one after the other, each with a clock that begins anew."""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array, Numbers, median

RUN = 20  # periods by which the time of a new run goes back at least, and of the gap before it
SECOND = "a second run begins there: `scarid convert` puts it behind the first"
SORT = "sort the log and remove repeated rows"


def period_of(times: Array | Numbers) -> float:
    """The period of a clock, in its unit; 0 if time never increases."""
    steps = np.diff(times)
    forward = steps[steps > 0]
    return median(forward.astype(np.float64)) if len(forward) else 0.0


def run_starts(times: Array | Numbers, period: float) -> list[int]:
    """The rows (from 0) in which the clock begins anew.

    A row that is late comes before the one before it by a few periods, and the time is beyond that
    again a few rows later; a new run goes back by more, and behind a few rows whose times leap
    ahead the time goes on.
    """
    back = np.flatnonzero(np.diff(times) < -RUN * period) if period else np.empty(0, np.int64)
    latest = np.maximum.accumulate(times)
    return [
        at + 1
        for at in back.tolist()
        if not np.any(times[at + 1 : at + 1 + RUN] > latest[at])
        and times[at + 1] < times[max(0, at + 1 - RUN) : at + 1].min()
    ]


def remedy_back(times: Array) -> str:
    """What to do about a time that goes back in these rows."""
    return SECOND if run_starts(times, period_of(times)) else SORT
