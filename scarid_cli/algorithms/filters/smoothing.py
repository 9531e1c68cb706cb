"""The Kalman smoother of a record, part by part, in memory that does not grow with the record.

The filter runs forwards once. The way back from the end of a record forgets where it began: what
follows a row by AHEAD time constants of the closed loop changes nothing but its last digits. Parts
of the record are therefore smoothed with so many rows after them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import ceil, inf, log

import numpy as np

from scarid_cli.algorithms.filters import kalman
from scarid_cli.algorithms.filters.kalman_method import KalmanMethod, settled
from scarid_cli.algorithms.processes.method import MatchedForm
from scarid_cli.algorithms.processes.process import Process
from scarid_cli.arrays import Array

AHEAD = 40.0  # time constants: e^-40 is a hundredth of the rounding of a double
ROWS = 16384  # of a part, at least
TIMES = 4  # rows of a part for each row ahead, at least: a quarter is smoothed twice

# The first of position, velocity and acceleration, and the one after the last.
POSITION, DERIVATIVES, ALL = (0, 1), (1, 3), (0, 3)


@dataclass(frozen=True)
class SmoothingState:
    """The filter, and the records of the rows that wait; h [s]."""

    filter: kalman.KalmanState
    waiting: tuple[kalman.Records, ...]
    h: float


@dataclass(frozen=True)
class Smoothing(Process):
    """Some of position, velocity and acceleration, as `method` smooths them with known settings."""

    method: KalmanMethod
    outputs: tuple[int, int] = ALL

    def lag(self, h: float) -> float:  # noqa: ARG002 (the same at every rate)
        return inf

    def init(self, x: float, h: float) -> SmoothingState:
        return SmoothingState(self.method.model(h).at_rest(x), (), h)

    def step(self, state: SmoothingState, x: Array) -> tuple[SmoothingState, tuple[Array, ...]]:
        after, new = kalman.recorded(state.filter, x)
        waiting, found = (*state.waiting, new), []
        ahead = rows_ahead(self.method, state.h)
        part = max(ROWS, TIMES * ahead)
        while sum(map(len, waiting)) >= part + ahead:
            records = kalman.Records.joined(waiting)
            found.append(self._smoothed(records.first(part + ahead), after, state.h)[:part])
            waiting = (records.last(len(records) - part),)
        rows = self._columns(np.concatenate(found)) if found else ()
        return SmoothingState(after, waiting, state.h), rows

    def finish(self, state: SmoothingState) -> tuple[Array, ...]:
        if not state.waiting:
            return ()
        records = kalman.Records.joined(state.waiting)
        return self._columns(self._smoothed(records, state.filter, state.h))

    def _smoothed(self, records: kalman.Records, end: kalman.KalmanState, h: float) -> Array:
        """The rows of the records; `end` is the filter after them, or later."""
        # A filter that ends behind a glitch is not steady, as most rows before it were.
        if not end.settled and records.steady.any():
            end = settled(self.method, h)
        return kalman.smoothed(records, end)

    def _columns(self, rows: Array) -> tuple[Array, ...]:
        return tuple(np.ascontiguousarray(rows.T[slice(*self.outputs)]))


@dataclass(frozen=True)
class MatchedSmoothing(Smoothing, MatchedForm):
    """The smoothed position with its derivatives, and torques smoothed alike."""

    @property
    def torque_filter(self) -> Smoothing:
        return Smoothing(self.method.ungated(), POSITION)


@lru_cache(maxsize=64)  # for every joint, its torque, and every part of the record
def rows_ahead(method: KalmanMethod, h: float) -> int:
    """How many rows after a row matter for its smoothed state; sampled every h [s]."""
    steady = settled(method, h)
    F, gain = steady.model.F, steady.gain
    loop = F - np.outer(F @ gain, np.eye(len(F))[0])
    slowest = float(np.max(np.abs(np.linalg.eigvals(loop))))
    return ceil(AHEAD / -log(slowest))
