"""The motion of a record through one zero-phase low-pass, for all joints alike.

The low-pass is a Butterworth filter of order 4, run forwards and backwards. The two-sided pass of a
chain of four integrators is the same filter (docs/theory.md, section "One bandwidth").
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from scarid_cli.algorithms.filters.butterworth import Butterworth
from scarid_cli.algorithms.filters.two_sided import two_sided_bandwidth
from scarid_cli.algorithms.processes.bandwidth import velocity_noise
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.algorithms.regression.counting import (
    Counting,
    Speeds,
    away,
    reversals,
)
from scarid_cli.arrays import Array, Marks

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.coupled import CoupledTerm

ORDER = 4
TWO_SIDED = two_sided_bandwidth(ORDER)  # the bandwidth of both passes, over the cut-off
PADDING = 3.0  # periods of the cut-off by which a record is extended oddly at both ends
RATE, LEAST_RATE = 10.0, 4.0  # rows kept per period of the cut-off, of a short record and of any
MANY = 8192  # samples of a record, from which on fewer rows are kept
END = 1.0  # periods of the cut-off left out at both ends
# Central differences of order 6
FIRST = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
SECOND = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0
REACH = 3  # samples on each side that they need


@dataclass(frozen=True)
class Segment:
    """Positions [rad or m] and torques [N m or N] (joints, samples) of a record without a gap.

    `noise` (joints) is the standard deviation of the noise of the positions.
    """

    q: Array
    tau: Array
    noise: Array


@dataclass(frozen=True)
class Lowpassed:
    """Position, velocity, acceleration, torque and whether a row counts (joints, samples).

    The samples are `interval` [s] apart.
    """

    motion: tuple[Array, Array, Array, Array]
    counts: Marks
    interval: float


def lowpassed(
    segment: Segment, h: float, cutoff: float, motors: tuple[CoupledTerm, ...] = ()
) -> Lowpassed | None:
    """Every k-th sample of the segment behind the low-pass of a cut-off [Hz]; h [s].

    `motors` are those that turn with two joints. None if the segment is too short for the cut-off.
    """
    end = int(END / cutoff / h) + REACH
    if segment.q.shape[1] <= 2 * end + 1:
        return None
    lowpass, padding = Butterworth(cutoff, ORDER), _padding(segment, h, cutoff)
    q, tau = (_both_ways(x, lowpass, padding, h) for x in (segment.q, segment.tau))
    inner = slice(end, q.shape[1] - end)
    dq, ddq = (_differences(q, taps) for taps in (FIRST / h, SECOND / h**2))
    stride = _stride(q.shape[1], h, cutoff)
    every = slice(None, None, stride)
    counts = _counts(dq[:, inner], segment.noise, TWO_SIDED * cutoff, h, motors)
    motion = (np.ascontiguousarray(x[:, inner][:, every]) for x in (q, dq, ddq, tau))
    return Lowpassed(tuple(motion), counts[:, every], stride * h)  # type: ignore[arg-type]


def removed(segment: Segment, h: float, cutoff: float) -> Array:
    """The positions (joints, samples) less the low-passed ones: noise, vibration, resolution."""
    padding = _padding(segment, h, cutoff)
    return segment.q - _both_ways(segment.q, Butterworth(cutoff, ORDER), padding, h)


def _stride(samples: int, h: float, cutoff: float) -> int:
    """Every how many samples a row is kept."""
    rate = min(RATE * cutoff, max(LEAST_RATE * cutoff, MANY / (samples * h)))
    return max(1, int(1.0 / (rate * h)))


def _padding(segment: Segment, h: float, cutoff: float) -> int:
    rows = int(PADDING / cutoff / h)
    return min(len(segment.q[0]) - 1, rows)


def _counts(
    dq: Array, noise: Array, bandwidth: float, h: float, motors: tuple[CoupledTerm, ...]
) -> Marks:
    counting = Counting(bandwidth, tuple(velocity_noise(x, bandwidth, h) for x in noise.tolist()))
    at = np.arange(dq.shape[1])
    slow = np.maximum(Speeds(np.sum(dq**2, axis=1), dq.shape[1]).slow, counting.floor(len(dq)))
    moving = np.abs(dq) > slow[:, None]
    return np.asarray(moving & away(reversals(dq, 0, motors), at, counting.window(h)))


def _both_ways(x: Array, lowpass: Butterworth, padding: int, h: float) -> Array:
    """Each row of x forwards and backwards through the low-pass."""
    before = 2.0 * x[:, :1] - x[:, padding:0:-1]
    after = 2.0 * x[:, -1:] - x[:, -2 : -padding - 2 : -1]
    extended = np.concatenate((before, x, after), axis=1)
    out = np.empty_like(x)
    for row, smooth in zip(extended, out, strict=True):
        (forwards,) = over(lowpass, row, h)
        (back,) = over(lowpass, np.ascontiguousarray(forwards[::-1]), h)
        smooth[:] = back[::-1][padding : padding + len(smooth)]
    return out


def _differences(q: Array, taps: Array) -> Array:
    """The differences with these taps at each sample; not those of the ends."""
    return np.array([np.convolve(row, taps[::-1], "same") for row in q])
