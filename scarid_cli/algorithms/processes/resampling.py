"""A jittered log on a regular clock.

Values between samples lie on straight lines. Where the rate is lowered, these are taken at a
multiple of it and decimated by a low-pass without delay. Nothing is laid across a gap.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from scarid_cli.arrays import Array, Numbers

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
    """The samples from which the next rows are made: times and values (columns, samples).

    `row` is the number of the next row, `start` the time of row 0.
    """

    t: Array
    x: Array
    start: float
    row: int = 0


@dataclass(frozen=True)
class Resampler:
    """Rows every `period` [s], on straight lines between the samples."""

    period: float

    def init(self, t: float, x: Array) -> State:
        """At the first sample: its time [s] and values (columns)."""
        return State(np.array([t]), x[:, None], t)

    def after_gap(self, state: State, t: float, x: Array) -> State:
        """At the first sample after a gap; rows go on at the times they would have had."""
        row = max(state.row, int(np.ceil((t - state.start) / self.period - 1e-9)))
        return State(np.array([t]), x[:, None], state.start, row)

    def step(self, state: State, t: Array, x: Array) -> tuple[State, Array, Array]:
        """Take samples in, later ones than before; the rows that they settle: times and values."""
        times = np.concatenate((state.t, t))
        values = np.concatenate((state.x, x), axis=1)
        last = int(np.floor((times[-1] - state.start) / self.period + 1e-9))
        numbers = np.arange(state.row, max(state.row, last + 1), dtype=np.float64)
        at: Array = state.start + numbers * self.period
        rows = np.array([np.interp(at, times, row) for row in values]).reshape(len(x), len(at))
        # What the next row needs stays.
        following = state.start + (state.row + len(at)) * self.period
        kept = int(np.searchsorted(times, following, side="right")) - 1
        kept = min(max(kept, 0), len(times) - 1)
        moved = replace(state, t=times[kept:], x=values[:, kept:], row=state.row + len(at))
        return moved, at, rows


REACH = 8  # new periods on either side
ATTENUATION = 60.0  # dB from half the new rate on
# Kaiser's formulas: the transition is as wide as that takes, and ends at half the new rate.
BETA = 0.1102 * (ATTENUATION - 8.7)
CUTOFF = 0.5 - 0.5 * (ATTENUATION - 8.0) / (2.285 * 2.0 * np.pi * 2.0 * REACH)  # of the new rate
WINDOWS = 256  # computed at once


@dataclass(frozen=True)
class Run:
    """Samples of a segment (columns, samples) from number `at` on, from which the next rows are.

    `row` is the number of the next row. In the beginning nothing precedes the first sample.
    """

    x: Array
    at: int
    row: int
    begun: bool = False


@dataclass(frozen=True)
class Decimator:
    """Every `factor`-th sample by its number, low-passed against aliasing, without delay.

    A sinc in a Kaiser window. At the ends of a segment it goes on with its samples turned around
    the last one, as scipy's sosfiltfilt does.
    """

    factor: int

    @cached_property
    def taps(self) -> Array:
        half = REACH * self.factor
        places = np.arange(-half, half + 1)
        taps = np.sinc(2.0 * CUTOFF / self.factor * places) * np.kaiser(2 * half + 1, BETA)
        normed: Array = taps / taps.sum()
        return normed

    def init(self, number: int, columns: int) -> Run:
        """Before the sample of this number."""
        return Run(np.empty((columns, 0)), number, -(-number // self.factor))

    def step(self, state: Run, x: Array) -> tuple[Run, Numbers, Array]:
        """Take samples in; the rows that they settle: their numbers and values."""
        half = REACH * self.factor
        state = replace(state, x=np.concatenate((state.x, x), axis=1))
        if not state.begun and state.x.shape[1] > half:
            state = replace(state, x=_turned(state.x, half, 0), at=state.at - half, begun=True)
        return self._rows(state) if state.begun else (state, np.empty(0, int), x[:, :0])

    def finish(self, state: Run) -> tuple[Numbers, Array]:
        """The rows that are left at the end of a segment."""
        half = REACH * self.factor
        if not state.x.shape[1]:
            return np.empty(0, int), state.x
        before = 0 if state.begun else half
        whole = replace(state, x=_turned(state.x, before, half), at=state.at - before, begun=True)
        _, numbers, rows = self._rows(whole)
        return numbers, rows

    def _rows(self, state: Run) -> tuple[Run, Numbers, Array]:
        half = REACH * self.factor
        first = state.row * self.factor - half - state.at  # the first sample of the next window
        room = state.x.shape[1] - (2 * half + 1) - first
        count = room // self.factor + 1 if room >= 0 else 0
        rows = np.empty((len(state.x), count))
        taps = self.taps
        for start in range(0, count, WINDOWS):
            part = slice(start, min(start + WINDOWS, count))
            for out, x in zip(rows, state.x, strict=True):
                windows = sliding_window_view(x, len(taps))[first :: self.factor][part]
                # Not a matrix product: it would round differently with the number of rows.
                out[part] = (windows * taps).sum(axis=1)
        numbers = np.arange(state.row, state.row + count)
        kept = max(first + count * self.factor, 0)
        after = replace(state, x=state.x[:, kept:], at=state.at + kept, row=state.row + count)
        return after, numbers, rows


def _turned(x: Array, before: int, after: int) -> Array:
    """With samples before and after that are its own, turned around the first and the last."""
    return np.pad(x, ((0, 0), (before, after)), mode="reflect", reflect_type="odd")
