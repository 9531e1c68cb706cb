"""The clock of the log: when its rows are sampled, and what time they state."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.sensors.instants import LIMIT
from scarid_cli.algorithms.sensors.noise import Source
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class ClockState:
    """The random streams of the three jitters."""

    sampling: Source
    stamp: Source
    hidden: Source


@dataclass(frozen=True)
class Clock:
    """The clock of a log with a row every `period` [s].

    The row of the nominal time t is sampled at t + sampling + hidden and stamped t + sampling +
    stamp: normal numbers of these standard deviations [s], each limited to LIMIT periods.
    """

    period: float
    sampling: float = 0.0
    stamp: float = 0.0
    hidden: float = 0.0

    def init(self, seed: int) -> ClockState:
        names = ("sampling-jitter", "stamp-jitter", "hidden-jitter")
        return ClockState(*(Source.named(seed, name) for name in names))

    @property
    def late(self) -> float:
        """By how much a row may be sampled after its nominal time [s]."""
        return LIMIT * self.period * ((self.sampling > 0.0) + (self.hidden > 0.0))

    def step(self, state: ClockState, rows: int) -> tuple[ClockState, Array, Array]:
        """How much later than their nominal times so many rows are sampled and stamped [s]."""
        sampling, common = self._jitter(state.sampling, self.sampling, rows)
        stamp, stated = self._jitter(state.stamp, self.stamp, rows)
        hidden, unstated = self._jitter(state.hidden, self.hidden, rows)
        return ClockState(sampling, stamp, hidden), common + unstated, common + stated

    def _jitter(self, source: Source, deviation: float, rows: int) -> tuple[Source, Array]:
        source, normal = source.normal(rows)
        most = LIMIT * self.period
        return source, np.clip(deviation * normal, -most, most)
