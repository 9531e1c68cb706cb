"""A jittered log on a regular clock.

Values between samples lie on straight lines. Where the rate is lowered they are means over one new
period of these lines, against aliasing. A row needs the samples up to it, or half a period beyond.
Nothing is laid across a gap.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.arrays import Array

ROUNDING = 1e-12


@dataclass(frozen=True)
class Clock:
    """What a log's clock did: intervals in all, their sum and extremes [s], rows left out.

    `gaps` split the record, `missing` is their time [s]; the intervals are without them.
    """

    intervals: int = 0
    total: float = 0.0
    squares: float = 0.0
    shortest: float = np.inf
    longest: float = 0.0
    repeated: int = 0
    gaps: int = 0
    missing: float = 0.0

    def after(self, steps: Array) -> Clock:
        """The clock after more intervals; one of 0 s repeats a row."""
        steps, repeated = steps[steps > 0.0], int((steps == 0.0).sum())
        counted = replace(self, repeated=self.repeated + repeated)
        if not len(steps):
            return counted
        return replace(
            counted,
            intervals=self.intervals + len(steps),
            # Summed one by one, so that batches do not change a bit.
            total=float(np.cumsum(np.append(self.total, steps))[-1]),
            squares=float(np.cumsum(np.append(self.squares, steps * steps))[-1]),
            shortest=min(self.shortest, float(steps.min())),
            longest=max(self.longest, float(steps.max())),
        )

    def after_gap(self, length: float) -> Clock:
        """The clock after an interval [s] that splits the record."""
        return replace(self, gaps=self.gaps + 1, missing=self.missing + length)

    @property
    def mean(self) -> float:
        return self.total / self.intervals if self.intervals else np.nan

    @property
    def jitter(self) -> float:
        """Standard deviation of the intervals [s]; 0 where it is lost in rounding."""
        if not self.intervals:
            return np.nan
        variance = self.squares / self.intervals - self.mean**2
        return float(np.sqrt(variance)) if variance > ROUNDING * self.mean**2 else 0.0


@dataclass(frozen=True)
class State:
    """The samples from which the next rows are made: times, values (columns, samples), integrals.

    `row` is the number of the next row, `start` the time of row 0.
    """

    t: Array
    x: Array
    integral: Array
    start: float
    row: int = 0


@dataclass(frozen=True)
class Resampler:
    """Rows every `period` [s]; `smooth` where that is longer than the log's own."""

    period: float
    smooth: bool

    def init(self, t: float, x: Array) -> State:
        """At the first sample: its time [s] and values (columns)."""
        return State(np.array([t]), x[:, None], np.zeros((len(x), 1)), t)

    def after_gap(self, state: State, t: float, x: Array) -> State:
        """At the first sample after a gap; rows go on at the times they would have had."""
        row = max(state.row, int(np.ceil((t - state.start) / self.period - 1e-9)))
        begun = self.init(t, x)
        return replace(begun, start=state.start, row=row)

    def step(self, state: State, t: Array, x: Array) -> tuple[State, Array, Array]:
        """Take samples in, later ones than before; the rows that they settle: times and values."""
        times = np.concatenate((state.t, t))
        values = np.concatenate((state.x, x), axis=1)
        areas = 0.5 * (values[:, 1:] + values[:, :-1]) * np.diff(times)
        known = state.integral.shape[1]
        sums = np.concatenate((state.integral[:, -1:], areas[:, known - 1 :]), axis=1)
        integral = np.concatenate((state.integral[:, :-1], np.cumsum(sums, axis=1)), axis=1)
        reach = 0.5 * self.period if self.smooth else 0.0
        last = int(np.floor((times[-1] - reach - state.start) / self.period + 1e-9))
        numbers = np.arange(state.row, max(state.row, last + 1), dtype=np.float64)
        at: Array = state.start + numbers * self.period
        rows = self._rows(at, times, values, integral, reach)
        # What the next row needs stays.
        following = state.start + (state.row + len(at)) * self.period - reach
        kept = max(int(np.searchsorted(times, following, side="right")) - 1, 0)
        kept = min(kept, len(times) - 1)
        moved = replace(
            state,
            t=times[kept:],
            x=values[:, kept:],
            integral=integral[:, kept:],
            row=state.row + len(at),
        )
        return moved, at, rows

    def _rows(self, at: Array, t: Array, x: Array, integral: Array, reach: float) -> Array:
        if not reach:
            return np.array([np.interp(at, t, row) for row in x]).reshape(len(x), len(at))
        ends = [_integral(at + side, t, x, integral) for side in (-reach, reach)]
        # At the start there is less than a period to take the mean of.
        width = at + reach - np.maximum(at - reach, t[0])
        means: Array = (ends[1] - ends[0]) / width
        return means


def _integral(at: Array, t: Array, x: Array, integral: Array) -> Array:
    """Of the lines between samples, up to times within the samples (columns, times)."""
    at = np.maximum(at, t[0])
    left = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
    width = t[left + 1] - t[left]
    part = at - t[left]
    slope = (x[:, left + 1] - x[:, left]) / width
    found: Array = integral[:, left] + part * (x[:, left] + 0.5 * slope * part)
    return found
