"""The rows of the regression tau = W theta (paper eq. 25), and operations on them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array, Numbers

INTERVAL = 0.005  # s: rows are thinned to intervals of at most this length
SPREAD = 16  # parts that a long record is represented by
RATE = 4.0  # of a bandwidth: a row in each of so many parts of its period holds all that it passes


@dataclass(frozen=True)
class Rows:
    """Rows of the regression: W (samples, joints, parameters), torques y (samples, joints).

    Each row is multiplied by its entry in `scales` (samples, joints); 0 leaves it out. `at`
    (samples) are the numbers of the samples in the record, which are `h` [s] apart; where the
    numbers jump, the record has a gap. `motion` (4, joints, samples) has the position, velocity,
    acceleration and torque that the rows were computed from, and `reference` (2, joints, samples)
    the reference position and velocity, if the log has them. `bandwidth` [Hz] is that of the soft
    sensor behind them, None if it is not known, and `order` that of the Butterworth filter which
    this is, run forwards and backwards, None if it is another. `noise` (joints, or none if it is
    not known) is the standard deviation of that of the velocities [rad/s or m/s].
    """

    W: Array
    y: Array
    scales: Array
    at: Numbers
    h: float
    motion: Array
    reference: Array | None = None
    bandwidth: float | None = None
    order: int | None = None
    noise: tuple[float, ...] = ()

    @property
    def samples(self) -> int:
        return len(self.W)

    def part(self, chosen: slice | Numbers) -> Rows:
        """The rows of some samples: of a slice, or copies of those at these indices."""
        return Rows(
            np.ascontiguousarray(self.W[chosen]),
            np.ascontiguousarray(self.y[chosen]),
            np.ascontiguousarray(self.scales[chosen]),
            self.at[chosen],
            self.h,
            np.ascontiguousarray(self.motion[:, :, chosen]),
            None if self.reference is None else self.reference[:, :, chosen],
            self.bandwidth,
            self.order,
            self.noise,
        )


def plain(W: Array, y: Array, h: float = 1.0) -> Rows:
    """Rows of equal weight, h [s] apart, that were not computed from a motion."""
    samples, joints, _ = W.shape
    motion = np.zeros((4, joints, samples))
    motion[3] = y.T
    W, y = np.ascontiguousarray(W), np.ascontiguousarray(y)
    return Rows(W, y, np.ones((samples, joints)), np.arange(samples), h, motion)


def rows_of(
    robot: Robot,
    motion: Array,
    at: Numbers,
    h: float,
    *,
    slow: Array | None = None,
    reference: Array | None = None,
) -> Rows:
    """The rows of a motion (4, joints, samples): position, velocity, acceleration and torque.

    Rows of a joint that is slower than `slow` (joints) [rad/s or m/s] are left out, because Coulomb
    friction near rest is not sign(dq).
    """
    rows = regressed(bare(motion, at, h, reference), robot)
    return rows if slow is None else without_slow(rows, slow)


def bare(motion: Array, at: Numbers, h: float, reference: Array | None = None) -> Rows:
    """The rows of a motion as `rows_of` has them, but with a W that has no columns yet."""
    y = np.ascontiguousarray(motion[3].T)
    return Rows(np.empty((*y.shape, 0)), y, np.ones(y.shape), at, h, motion, reference)


def regressed(rows: Rows, robot: Robot) -> Rows:
    """The rows with the regressor of the robot as W, if they are bare."""
    return rows if rows.W.shape[2] else replace(rows, W=robot.regressor(*rows.motion[:3]))


def without_slow(rows: Rows, slow: Array) -> Rows:
    """The rows without those of joints that are slower than `slow` (joints) [rad/s or m/s]."""
    return replace(rows, scales=rows.scales * (np.abs(rows.motion[1].T) >= slow))


def faded(rows: Rows, factor: float) -> Rows:
    """The rows as an estimator weights them that forgets by this factor per sample."""
    ages = (rows.at[-1] - rows.at).astype(np.float64)
    return replace(rows, scales=rows.scales * np.exp(0.5 * ages * np.log(factor))[:, None])


def thinning(h: float, bandwidth: float | None = None) -> int:
    """Every how many-th of samples h [s] apart are kept.

    They are then RATE per period of the bandwidth [Hz], or at most 5 ms apart if that is not known.
    """
    interval = 1.0 / (RATE * bandwidth) if bandwidth else INTERVAL
    return max(1, int(interval / h + 1e-9)) if h > 0.0 else 1


def thinned(rows: Rows) -> Rows:
    """Every n-th sample, such that they are at most 5 ms apart if the record allows."""
    step = thinning(rows.h)
    if step == 1:
        return rows
    part = rows.part(np.flatnonzero(rows.at % step == 0))
    return replace(part, at=part.at // step, h=rows.h * step)


def spread(rows: Rows, numbers: int) -> Rows:
    """Parts of a long record, as far apart, with about so many numbers in their W, or fewer."""
    share = -(-rows.W.size // numbers)
    if share <= 1:
        return rows
    pieces = np.array_split(np.arange(rows.samples), SPREAD * share)
    return rows.part(np.concatenate(pieces[::share]))


def joined(parts: Sequence[Rows]) -> Rows:
    """Several parts of a record as one."""
    if len(parts) == 1:
        return parts[0]
    references = [part.reference for part in parts if part.reference is not None]
    return Rows(
        np.concatenate([part.W for part in parts]),
        np.concatenate([part.y for part in parts]),
        np.concatenate([part.scales for part in parts]),
        np.concatenate([part.at for part in parts]),
        parts[0].h,
        np.concatenate([part.motion for part in parts], axis=2),
        np.concatenate(references, axis=2) if len(references) == len(parts) else None,
        parts[0].bandwidth,
        parts[0].order,
        parts[0].noise,
    )


def runs(at: Numbers) -> Iterator[slice]:
    """The parts of a record between its gaps."""
    breaks = np.flatnonzero(np.diff(at) != 1) + 1
    edges = [0, *breaks.tolist(), len(at)]
    for start, end in pairwise(edges):
        yield slice(start, end)


def predicted(rows: Rows, theta: Array) -> Array:
    """The torques (samples, joints) of the first columns of W, whose parameters are theta."""
    return np.asarray(rows.W[:, :, : len(theta)] @ theta)


def with_delay(rows: Rows, theta: Array) -> Rows:
    """The rows with one more column, whose parameter is the time [s] by which the torques lead.

    theta: the estimates of the first columns of W, whose torques the delay moves.
    """
    column = delay_column(rows, predicted(rows, theta))
    return replace(rows, W=np.ascontiguousarray(np.concatenate((rows.W, column[:, :, None]), 2)))


def delay_column(rows: Rows, predicted: Array) -> Array:
    """The time derivative of the predicted torques (samples, joints).

    The measured torques lead the motion by a delay: tau(t) = W(t + delay) theta, so to first order
    this derivative is the column of W whose parameter is the delay [s]. It is 0 where a joint
    reverses, because Coulomb friction jumps there.
    """
    return _derivative(rows, predicted, 1)


def curvature(rows: Rows, predicted: Array) -> Array:
    """The second time derivative of the predicted torques, 0 where a joint reverses."""
    return _derivative(rows, predicted, 2)


def slope(rows: Rows, x: Array) -> Array:
    """The time derivative of a signal (samples, ...), run by run; 0 in a run of one sample."""
    found = np.zeros_like(x)
    for run in runs(rows.at):
        if run.stop - run.start > 1:
            found[run] = np.gradient(x[run], rows.h, axis=0)
    return found


def _derivative(rows: Rows, predicted: Array, order: int) -> Array:
    found = predicted
    for _ in range(order):
        found = slope(rows, found)
    for run in runs(rows.at):
        direction = np.sign(rows.motion[1][:, run].T)
        turns = np.zeros(direction.shape, dtype=bool)
        turns[1:] |= direction[1:] != direction[:-1]
        turns[:-1] |= turns[1:]
        found[run] = np.where(turns, 0.0, found[run])
    return found
