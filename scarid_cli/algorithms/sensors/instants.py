"""When the signals in a row of the log were sampled: jitter, slower sensors, transport delays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.arrays import Array, Numbers

LIMIT = 0.24  # log periods: two jitters to either side keep the order of the rows
NEARLY = 1e-6  # ticks: an instant this close to a tick is the tick


@dataclass(frozen=True)
class Instants:
    """Ticks of the controller and the fractions of a period after them: (joints or 1, rows)."""

    tick: Numbers
    fraction: Array

    @classmethod
    def of(cls, ticks: Array, last: int) -> Instants:
        """From times in ticks; before the first and after the last tick they are those."""
        ticks = np.clip(ticks, 0.0, last)
        whole = np.floor(ticks + NEARLY)
        fraction = ticks - whole
        return cls(whole.astype(np.int64), np.where(fraction > NEARLY, fraction, 0.0))


@dataclass(frozen=True)
class Path:
    """How a signal comes into the log: its sensor's period, then a delay; each (joints), in ticks.

    The row at t has the signal of T floor((t - delay) / T), where T is the period of the sensor; 0
    stands for a sensor that is sampled with the row.
    """

    period: Array
    delay: Array

    @classmethod
    def sampled(cls, rate: Array, delay: Array, control_rate: float) -> Path:
        """From the rate of the sensor and of the controller [Hz], and the delay [s]."""
        known = rate > 0.0
        period = np.where(known, control_rate / np.where(known, rate, 1.0), 0.0)
        return cls(period, delay * control_rate)

    def instants(self, ticks: Array, last: int) -> Instants:
        """When the signal in the rows at these times, in ticks, was sampled."""
        then = ticks - self.delay[:, None]
        held = self.period[:, None] > 0.0
        period = np.where(held, self.period[:, None], 1.0)
        updates = np.floor(then / period + NEARLY) * period
        return Instants.of(np.where(held, updates, then), last)

    @property
    def reach(self) -> float:
        """By how many ticks a signal may be older than its row."""
        return float(np.max(self.period + self.delay))
