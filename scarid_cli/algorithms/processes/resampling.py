"""Resampling of a log with a jittered clock to a regular clock.

Values between samples are interpolated linearly. Where the rate is lowered, the log is first
interpolated at a multiple of the new rate, and then decimated by a low-pass without delay. Gaps are
never interpolated.
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
    """Statistics of a log's clock: the number of intervals, their sums and the longest [s].

    `held` counts the rows left out because they repeat all measured values, `repeated` those whose
    time repeats. `filled` are the groups of signals of a slower sensor, each with the interval
    between its readings [s] and the number of rows that were interpolated. `gaps` counts the
    intervals that split the record and `missing` is their sum [s]; the other numbers are without
    them.
    """

    intervals: int = 0
    total: float = 0.0
    squares: float = 0.0
    longest: float = 0.0
    repeated: int = 0
    gaps: int = 0
    missing: float = 0.0
    held: int = 0
    filled: tuple[tuple[str, float, int], ...] = ()

    def after(self, steps: Array) -> Clock:
        """The statistics after more intervals [s]; an interval of 0 s repeats a row."""
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
            longest=max(self.longest, float(steps.max())),
        )

    def after_gap(self, length: float) -> Clock:
        """The statistics after an interval [s] that splits the record."""
        return replace(self, gaps=self.gaps + 1, missing=self.missing + length)

    @property
    def mean(self) -> float:
        """The mean interval [s]; nan without any."""
        return self.total / self.intervals if self.intervals else np.nan

    @property
    def jitter(self) -> float:
        """The standard deviation of the intervals [s]; 0 where it is lost in rounding."""
        if not self.intervals:
            return np.nan
        variance = self.squares / self.intervals - self.mean**2
        return float(np.sqrt(variance)) if variance > ROUNDING * self.mean**2 else 0.0


@dataclass(frozen=True)
class ResamplerState:
    """The samples that the next rows lie between: times [s] and values (columns, samples).

    `row` is the number of the next row, `start` the time [s] of row 0.
    """

    t: Array
    x: Array
    start: float
    row: int = 0


@dataclass(frozen=True)
class Resampler:
    """Makes rows every `period` [s] by linear interpolation between the samples."""

    period: float

    def init(self, t: float, x: Array, before: ResamplerState | None = None) -> ResamplerState:
        """The state at the first sample of a segment: its time [s] and values (columns).

        Rows keep the times that they would have had without the gap after the state `before`.
        """
        start, row = (before.start, before.row) if before else (t, 0)
        row = max(row, int(np.ceil((t - start) / self.period - 1e-9)))
        return ResamplerState(np.array([t]), x[:, None], start, row)

    def step(
        self, state: ResamplerState, t: Array, x: Array
    ) -> tuple[ResamplerState, Array, Array]:
        """Take in later samples; return the rows that can be made of them, as times and values."""
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
WINDOWS, VALUES = 256, 1 << 22  # computed at once


@dataclass(frozen=True)
class DecimatorState:
    """The samples of a segment (columns, samples) that the next rows need, from number `at` on.

    `row` is the number of the next row. `padded` says whether the samples have been extended before
    the first one.
    """

    x: Array
    at: int
    row: int
    padded: bool = False


@dataclass(frozen=True)
class Decimator:
    """Keeps every `factor`-th sample by its number, low-passed against aliasing without delay.

    The low-pass is a sinc in a Kaiser window. At both ends a segment is extended oddly, as
    scipy.signal.sosfiltfilt does.
    """

    factor: int

    @cached_property
    def taps(self) -> Array:
        """The taps of the low-pass, of unit sum."""
        half = REACH * self.factor
        places = np.arange(-half, half + 1)
        taps = np.sinc(2.0 * CUTOFF / self.factor * places) * np.kaiser(2 * half + 1, BETA)
        normed: Array = taps / taps.sum()
        return normed

    def init(self, number: int, columns: int) -> DecimatorState:
        """The state before the sample of this number."""
        return DecimatorState(np.empty((columns, 0)), number, -(-number // self.factor))

    def step(self, state: DecimatorState, x: Array) -> tuple[DecimatorState, Numbers, Array]:
        """Take in samples; return the rows that can be made of them, as numbers and values."""
        half = REACH * self.factor
        state = replace(state, x=np.concatenate((state.x, x), axis=1))
        if not state.padded and state.x.shape[1] > half:
            state = replace(state, x=_turned(state.x, half, 0), at=state.at - half, padded=True)
        return self._rows(state) if state.padded else (state, np.empty(0, int), x[:, :0])

    def finish(self, state: DecimatorState) -> tuple[Numbers, Array]:
        """The remaining rows at the end of a segment, as numbers and values."""
        half = REACH * self.factor
        if not state.x.shape[1]:
            return np.empty(0, int), state.x
        before = 0 if state.padded else half
        whole = replace(state, x=_turned(state.x, before, half), at=state.at - before, padded=True)
        _, numbers, rows = self._rows(whole)
        return numbers, rows

    def _rows(self, state: DecimatorState) -> tuple[DecimatorState, Numbers, Array]:
        half = REACH * self.factor
        first = state.row * self.factor - half - state.at  # the first sample of the next window
        room = state.x.shape[1] - (2 * half + 1) - first
        count = room // self.factor + 1 if room >= 0 else 0
        rows = np.empty((len(state.x), count))
        taps = self.taps
        together = max(1, min(WINDOWS, VALUES // len(taps)))
        for start in range(0, count, together):
            part = slice(start, min(start + together, count))
            for out, x in zip(rows, state.x, strict=True):
                windows = sliding_window_view(x, len(taps))[first :: self.factor][part]
                # Not a matrix product: it would round differently with the number of rows.
                out[part] = (windows * taps).sum(axis=1)
        numbers = np.arange(state.row, state.row + count)
        kept = max(first + count * self.factor, 0)
        after = replace(state, x=state.x[:, kept:], at=state.at + kept, row=state.row + count)
        return after, numbers, rows


def _turned(x: Array, before: int, after: int) -> Array:
    """The samples, extended oddly about the first and the last one."""
    return np.pad(x, ((0, 0), (before, after)), mode="reflect", reflect_type="odd")
