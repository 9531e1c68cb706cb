"""Which rows count: those near a reversal or near standstill are left out.

There Coulomb friction is not what the model says: sign(dq) jumps where the low-pass of the soft
sensor has smoothed the torque, joints stick, and the sign of a velocity within its noise is
arbitrary.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, without_slow
from scarid_cli.arrays import Array, Marks, Numbers

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.coupled import CoupledTerm

# Chosen on simulated robots, see docs/design/estimation.md, "Rows that count".
SLOW = 0.02  # share of the root-mean-square velocity
NOISES = 3.0  # standard deviations of the noise of the velocity
REVERSAL = 0.5  # periods of the bandwidth, before and after a reversal

CUTOFF_OF_NYQUIST = 0.8  # the cut-off of a decimation, of the new Nyquist frequency

T = TypeVar("T")


@dataclass(frozen=True)
class Counting:
    """What is known of the motion whose rows are judged.

    `bandwidth` [Hz] is that of the soft sensor, None if it is not known; rows near a reversal are
    then kept. `velocity_noise` (joints, or none if not known) is the standard deviation of the
    noise of the velocity [rad/s or m/s]. `motors` are those that turn with two joints, whose
    reversals count for both.
    """

    bandwidth: float | None = None
    velocity_noise: tuple[float, ...] = ()
    motors: tuple[CoupledTerm, ...] = ()

    def window(self, h: float) -> int:
        """The number of samples left out before and after a reversal, sampled every h [s]."""
        return int(REVERSAL / self.bandwidth / h) if self.bandwidth else 0

    def decimated(self, h: float) -> Counting:
        """The same behind the low-pass of a decimation to the period h [s]."""
        highest = CUTOFF_OF_NYQUIST * 0.5 / h
        return replace(self, bandwidth=min(self.bandwidth or highest, highest))

    def floor(self, joints: int) -> Array:
        """The velocity (joints) [rad/s or m/s] above which it is not noise."""
        known = len(self.velocity_noise) == joints
        return NOISES * np.array(self.velocity_noise if known else np.zeros(joints))


@dataclass
class Speeds:
    """The mean square velocity of each joint so far, sample by sample from the start of the log."""

    sums: Array
    samples: int = 0

    @property
    def slow(self) -> Array:
        """The velocity (joints) [rad/s or m/s] up to which a joint is near standstill."""
        return np.asarray(SLOW * np.sqrt(self.sums / max(self.samples, 1)))

    def moving(self, dq: Array, floor: Array) -> Marks:
        """Whether each velocity of dq (joints, samples) is above both bounds, as known so far."""
        # One addition after the other, so that the bits do not depend on the batches.
        sums = np.cumsum(np.column_stack((self.sums, dq**2)), axis=1)[:, 1:]
        counts = self.samples + np.arange(1, dq.shape[1] + 1)
        self.sums, self.samples = sums[:, -1].copy(), int(counts[-1])
        bound = np.maximum(SLOW * np.sqrt(sums / counts), floor[:, None])
        return np.asarray(np.abs(dq) > bound)


@dataclass
class LeftOut:
    """How many rows were left out near a reversal, and of the others near standstill, of `rows`.

    `speeds` are those so far, None before the first row.
    """

    rows: int = 0
    reversal: int = 0
    standstill: int = 0
    speeds: Speeds | None = None

    @property
    def counts(self) -> dict[str, int]:
        """The three numbers, by name."""
        return {"rows": self.rows, "reversal": self.reversal, "standstill": self.standstill}

    def settled(self, rows: Rows) -> Rows:
        """Rows of a log that is known as a whole, of which no row near standstill counts.

        While a log begins at rest, its speeds so far say nothing about those that follow.
        """
        return without_slow(rows, self.speeds.slow) if self.speeds else rows

    @property
    def text(self) -> str:
        """Which shares of the rows were left out."""
        near = [(self.reversal, "near reversals"), (self.standstill, "near standstill")]
        shares = [(100.0 * n / max(self.rows, 1), why) for n, why in near]
        return " and ".join(
            f"{share:.1f} % of the rows {why}" for share, why in shares if share >= 0.05
        )

    def add(self, moving: Marks, away: Marks) -> None:
        """Count rows (joints, samples) that are `moving`, and those `away` from a reversal."""
        self.rows += away.size
        self.reversal += int(np.count_nonzero(~away))
        self.standstill += int(np.count_nonzero(away & ~moving))


def reversals(dq: Array, first: int, motors: Sequence[CoupledTerm] = ()) -> list[Numbers]:
    """For each joint the samples k such that the sign of dq (joints, samples) differs at k + 1.

    So do those of the `motors` that turn with it. first: the number of the first sample.
    """
    changes = np.diff(np.sign(dq), axis=1) != 0.0
    for motor in motors:
        changes[[motor.joint - 1, motor.other - 1]] |= np.diff(np.sign(motor.speed(dq))) != 0.0
    return [first + np.flatnonzero(row) for row in changes]


def away(turns: list[Numbers], at: Numbers, window: int) -> Marks:
    """Whether none of the reversals of a joint is within `window` samples of the samples `at`."""
    return np.array(
        [
            np.searchsorted(k, at + window - 1, "right") == np.searchsorted(k, at - window)
            for k in turns
        ]
    )


@dataclass
class Waiting(Generic[T]):
    """The parts of a run without a gap that wait for the samples that follow them."""

    window: int
    turns: list[Numbers]
    motors: tuple[CoupledTerm, ...] = ()
    parts: deque[tuple[T, Rows]] = field(default_factory=deque)
    last: tuple[int, Array] | None = None  # the last sample: its number, and dq (joints, 1)

    def add(self, item: T, rows: Rows) -> None:
        dq, first = rows.motion[1], int(rows.at[0])
        if self.last:
            dq, first = np.column_stack((self.last[1], dq)), first - 1
        new = reversals(dq, first, self.motors)
        self.turns = [np.concatenate(pair) for pair in zip(self.turns, new, strict=True)]
        self.last = int(rows.at[-1]), rows.motion[1][:, -1:]
        self.parts.append((item, rows))

    def taken(self, *, rest: bool = False) -> Iterator[tuple[T, Rows, Marks]]:
        """The parts whose following samples are known, or all, and which rows are away."""
        newest = self.last[0] if self.last else 0
        while self.parts and (rest or int(self.parts[0][1].at[-1]) + self.window <= newest):
            item, rows = self.parts.popleft()
            yield item, rows, away(self.turns, rows.at, self.window)
            past = int(rows.at[-1]) - self.window
            self.turns = [k[np.searchsorted(k, past) :] for k in self.turns]


def counted(
    parts: Iterable[tuple[T, Rows]], counting: Counting, left_out: LeftOut
) -> Iterator[tuple[T, Rows]]:
    """The parts of a record, with a scale of 0 where a row does not count.

    A part is returned once the samples after it show whether a reversal is near. A part has no gap.
    """
    for item, rows, far in _in_runs(parts, counting):
        dq = rows.motion[1]
        left_out.speeds = left_out.speeds or Speeds(np.zeros(len(dq)))
        moving = left_out.speeds.moving(dq, counting.floor(len(dq)))
        left_out.add(moving, far)
        counts = np.ascontiguousarray((moving & far).T)
        yield item, replace(rows, scales=rows.scales * counts)


def _in_runs(
    parts: Iterable[tuple[T, Rows]], counting: Counting
) -> Iterator[tuple[T, Rows, Marks]]:
    """The parts, and which of their rows are away from every reversal of the same run."""
    waiting: Waiting[T] | None = None
    for item, rows in parts:
        if not rows.samples:
            continue
        if waiting and waiting.last and int(rows.at[0]) != waiting.last[0] + 1:
            yield from waiting.taken(rest=True)
            waiting = None
        if waiting is None:
            none = np.empty(0, dtype=np.int64)
            turns = [none] * rows.y.shape[1]
            waiting = Waiting(counting.window(rows.h), turns, counting.motors)
        waiting.add(item, rows)
        yield from waiting.taken()
    if waiting:
        yield from waiting.taken(rest=True)
