"""A clock that is coarser than the rows: many rows with one time and different values."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from scarid_cli.arrays import Array, median

MOST = 0.5  # of the rows: from here on a time belongs to several rows, and says which one of none
TICKS = 1000  # that are kept, and from which the rate is known
LONGER = 1.5  # times the usual tick
NEAR = 1e-3  # of a row: rounding of times since 1970
FEWEST = 3  # ticks of the clock of which the rows are known: the first and the last are not whole


@dataclass
class Ticks:
    """The first ticks of a clock as rows arrive: when each began [s], and how many rows it has.

    `unlike` counts the rows, of all `rows`, that have the time of the row before and other values.
    """

    times: list[float] = field(default_factory=list)
    counts: list[int] = field(default_factory=list)
    rows: int = 0
    unlike: int = 0
    _last: Array | None = None

    def after(self, t: Array, values: Array) -> None:
        """Count further rows: times (rows) [s] and measured values (columns, rows)."""
        if not len(t):
            return
        before = self._last if self._last is not None else np.full(1 + len(values), np.nan)
        rows = np.column_stack((before, np.vstack((t, values))))
        same = rows[0, 1:] == rows[0, :-1]
        differ = np.any(np.nan_to_num(np.diff(rows[1:], axis=1)) != 0.0, axis=0)
        self.unlike += int(np.count_nonzero(same & differ))
        self._last = rows[:, -1]
        begins = np.flatnonzero(~same)
        first = int(begins[0]) if len(begins) else len(t)
        self.rows += len(t)
        if len(self.counts) > TICKS:
            return
        if self.counts:
            self.counts[-1] += first
        self.times += t[begins].tolist()
        self.counts += np.diff(np.append(begins, len(t))).tolist()

    @property
    def coarse(self) -> bool:
        """Whether the clock is coarser than the rows."""
        return self.unlike > MOST * self.rows

    @property
    def rate(self) -> float | None:
        """Rows per second by the ticks that are whole; None if there are too few.

        Ticks may have rows by turns, as 2 and 3. Of numbers that one row more or less would give,
        it is the one with the fewest digits.
        """
        if len(self.times) < FEWEST:
            return None
        counts, lengths = np.array(self.counts[1:-1]), np.diff(self.times)[1:]
        usual = lengths <= LONGER * median(lengths)  # the others are gaps
        seconds = float(lengths[usual].sum())
        rate, apart = int(counts[usual].sum()) / seconds, np.ptp(counts[usual]) > 0
        digits = (float(f"{rate:.{k}g}") for k in range(1, 17))
        return next((x for x in digits if abs(x - rate) * seconds <= max(apart, NEAR)), rate)

    @property
    def counting(self) -> str:
        """The command that counts the rows instead."""
        rate = f"{self.rate:.6g}" if self.rate else "HZ"
        return f"`scarid convert --map stamp=t --rate {rate}`"
