"""The motion in a log: on a constant rate, with its bandwidth, behind one zero-phase low-pass.

What is missing, repeated or held is interpolated, and the log is split at its gaps, so that the
checks of the robot's model can be made of a log that `identify` would refuse.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from scarid_cli.algorithms.checks.clock import GAP, JITTER
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.filters.likelihood import noise_of
from scarid_cli.algorithms.tuning.lowpassed import Lowpassed, Segment, lowpassed
from scarid_cli.algorithms.tuning.scatter import HIGHEST, LOWEST
from scarid_cli.algorithms.tuning.spectrum import bandwidths
from scarid_cli.arrays import Array, Marks

FEWEST = 64  # rows of a segment from which a spectrum has a few points in each octave
HARMONICS = 8.0  # times that bandwidth: its products and their derivatives, and reversals, pass


@dataclass(frozen=True)
class Motion:
    """Segments without a gap, sampled every h [s]; bandwidths (joints) [Hz].

    `bandwidths` are those of the velocities, `torques` those of the torques. `cutoff` [Hz] is that
    of the low-pass behind which the model is fitted.
    """

    segments: tuple[Segment, ...]
    h: float
    bandwidths: Array
    torques: Array
    cutoff: float

    @classmethod
    def of(cls, log: Log, period: float) -> Motion | None:
        """The motion of a log with this period [s]; None if no part of it is long enough.

        Where the log holds the samples of slower sensors, the period is theirs.
        """
        held, slower = log.held
        period = slower if held.any() else period
        segments = tuple(_segments(log.part(usable(log, held)), period))
        if not segments:
            return None
        velocities, torques = bandwidths(segments, period)
        cutoff = min(max(HARMONICS * velocities.max(), LOWEST), HIGHEST / period)
        return cls(segments, period, velocities, torques, cutoff)

    def parts(self) -> list[Lowpassed]:
        """The segments behind the low-pass, of which some rows are kept."""
        found = (lowpassed(segment, self.h, self.cutoff) for segment in self.segments)
        return [part for part in found if part]

    def scaled(self, factors: Array) -> Motion:
        """The motion with the positions of each joint multiplied by a factor (joints)."""
        scaled = (Segment(factors[:, None] * s.q, s.tau, factors * s.noise) for s in self.segments)
        return replace(self, segments=tuple(scaled))

    def mounted(self, signs: Array, turns: Array) -> Motion:
        """The motion of axes (joints) with other signs and other zeros [rad]."""
        moved = (
            replace(s, q=signs[:, None] * s.q + turns[:, None], tau=signs[:, None] * s.tau)
            for s in self.segments
        )
        return replace(self, segments=tuple(moved))

    def delayed(self, rows: int) -> Motion:
        """The motion with the torques of so many rows later."""
        return replace(self, segments=tuple(_delayed(s, rows) for s in self.segments))


def _delayed(segment: Segment, rows: int) -> Segment:
    q, tau, count = segment.q, segment.tau, segment.q.shape[1]
    first, last = max(0, -rows), min(count, count - rows)
    return replace(segment, q=q[:, first:last], tau=tau[:, first + rows : last + rows])


def usable(log: Log, held: Marks) -> Marks:
    """Whether a row is complete, not `held`, and later than all rows before it (rows)."""
    whole = np.isfinite(log.t) & np.all(np.isfinite(log.signals), axis=0) & ~held
    latest = np.maximum.accumulate(np.where(whole, log.t, -np.inf))
    whole[1:] &= log.t[1:] > latest[:-1]
    return np.asarray(whole)


def _segments(kept: Log, period: float) -> list[Segment]:
    apart = np.diff(kept.t) > GAP * period
    if kept.segment is not None:
        apart |= np.diff(kept.segment) != 0.0
    gaps = (np.flatnonzero(apart) + 1).tolist()
    found = []
    for start, end in pairwise([0, *gaps, kept.rows]):
        t, signals = kept.t[start:end], kept.signals[:, start:end]
        if len(t) >= FEWEST:
            signals = _regular(t, signals, period)
            q, tau = signals[: kept.joints], signals[kept.joints :]
            found.append(Segment(q, tau, np.array([noise_of(x) for x in q])))
    return found


def _regular(t: Array, signals: Array, period: float) -> Array:
    """The signals (signals, rows) on a constant rate, by linear interpolation where necessary."""
    if np.all(np.abs(np.diff(t) - period) <= JITTER * period):
        return np.ascontiguousarray(signals)
    grid = t[0] + period * np.arange(int((t[-1] - t[0]) / period) + 1)
    return np.array([np.interp(grid, t, x) for x in signals])
