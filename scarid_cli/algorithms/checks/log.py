"""A log as it was recorded: it may have gaps, repeated times and missing values."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from scarid_cli.algorithms.processes.holding import held_in
from scarid_cli.algorithms.processes.in_turn import in_turn, interpolated
from scarid_cli.algorithms.processes.rates import resampling_rate
from scarid_cli.arrays import Array, Marks, Numbers
from scarid_cli.runs import period_of, run_starts

SELDOM = 0.1  # of the intervals: between rows in any order, half go back


@dataclass(frozen=True)
class Log:
    """Time t (rows) [s], positions q and torques tau (joints, rows) [rad or m, N m or N].

    Values that are missing are nan. `others` (columns, rows) are further values that sensors fill,
    if there are any. `dq` (joints, rows) are the measured velocities, if every joint has one.
    `segment` (rows) numbers parts between which a gap is known, if there are any.
    """

    t: Array
    q: Array
    tau: Array
    others: Array | None = None
    dq: Array | None = None
    segment: Array | None = None

    @property
    def rows(self) -> int:
        return len(self.t)

    @property
    def joints(self) -> int:
        return len(self.q)

    @property
    def signals(self) -> Array:
        """Positions and torques (2 joints, rows)."""
        return np.concatenate((self.q, self.tau))

    @property
    def sensed(self) -> Array:
        """All values that sensors fill (columns, rows)."""
        return self.signals if self.others is None else np.concatenate((self.signals, self.others))

    @cached_property
    def held(self) -> tuple[Marks, float]:
        """Which rows are held samples (rows), and the period of the sensors [s]."""
        return held_in(self.t, self.sensed)

    def resampling(self, *words: str) -> str:
        """The command with these words that puts the log on a constant rate, that of its sensors.

        Without a rate if time never increases.
        """
        rate = resampling_rate(self.t, self.held[0])
        given = ("--rate", rate) if rate else ()
        return f"`{' '.join(('scarid resample', *given, *words))}`"

    @property
    def names(self) -> list[str]:
        """The columns of the signals."""
        return [f"{name}{i}" for name in ("q", "tau") for i in range(1, self.joints + 1)]

    def counted(self, rate: float) -> Log:
        """The log with the times of rows that come at this rate [Hz]."""
        return replace(self, t=np.arange(self.rows) / rate)

    def part(self, rows: Numbers | Marks) -> Log:
        """These rows only (indices, or whether each row is kept)."""
        others = None if self.others is None else self.others[:, rows]
        dq = None if self.dq is None else self.dq[:, rows]
        segment = None if self.segment is None else self.segment[rows]
        return Log(self.t[rows], self.q[:, rows], self.tau[:, rows], others, dq, segment)

    @cached_property
    def run_starts(self) -> list[int]:
        """The rows (from 0) in which the clock begins again, as of another run."""
        starts = run_starts(self.t, period_of(self.t))
        return starts if len(starts) <= SELDOM * self.rows else []

    def in_order(self) -> Log:
        """The log with its rows sorted by time, those without one last, if they are in no order.

        Where time seldom goes back, the order is kept; of runs that follow each other, each with a
        clock that begins again, the longest one is.
        """
        if starts := self.run_starts:
            edges = [0, *starts, self.rows]
            longest = int(np.argmax(np.diff(edges)))
            return self.part(np.arange(edges[longest], edges[longest + 1]))
        steps = np.diff(self.t[np.isfinite(self.t)])
        if np.count_nonzero(steps < 0.0) <= SELDOM * len(steps):
            return self
        return self.part(np.argsort(self.t, kind="stable"))

    @property
    def in_turn(self) -> bool:
        """Whether most rows have the values of one source only."""
        return in_turn(self.signals)

    def filled(self) -> Log:
        """The log in the rows of the first position, the other values interpolated there."""
        every = self.signals if self.dq is None else np.concatenate((self.signals, self.dq))
        rows, found = interpolated(self.t, every)
        dq = None if self.dq is None else found[2 * self.joints :]
        whole = replace(self.part(rows), q=found[: self.joints], dq=dq, others=None)
        return replace(whole, tau=found[self.joints : 2 * self.joints])

    def scaled(self, *, t: float = 1.0, q: Array | float = 1.0) -> Log:
        """The log with time and positions multiplied by factors (positions by one per joint)."""
        factors = np.broadcast_to(np.asarray(q, dtype=np.float64), (self.joints,))
        return replace(self, t=t * self.t, q=factors[:, None] * self.q)
