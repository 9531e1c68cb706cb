"""Torque ripple: how many periods per rad or m the torque of each joint has beyond the model.

Cogging of a motor and errors of a gear make torques A sin(2 pi n q + phase). The low-pass behind
the rows leaves of it what it leaves of the frequency n |dq|, so that ripple shows in slow motion.
The n that explains most of what W leaves of the torque is searched for among all that such rows
have, with one Fourier transform over the positions for each of some intervals of speeds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from scarid_cli.algorithms.filters.two_sided import two_sided_bandwidth, two_sided_gain
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.arrays import Array

PERIODS = 2.0  # over the range of a joint: what has fewer is a spring or gravity
SLOW = 0.1  # of the usual speed: motion that is to show the fastest ripple
SPEEDS = 16  # intervals of speed, of which each has one gain
FINER = 4  # steps of the search per independent number of periods
NEARER = 8  # steps between two of them
ORDER = 4  # of the low-pass, where it is not known


@dataclass(frozen=True)
class Ripples:
    """The periods per rad or m of the likeliest ripple of each joint.

    `cycles` (joints) is 0 where the rows could show none. They are the best of so many that were
    `tried`, as a mean over the joints.
    """

    cycles: Array
    tried: float

    @classmethod
    def of(cls, rows: Rows) -> Ripples:
        """From the rows that count."""
        searches = [_Search.of(rows, joint) for joint in range(rows.y.shape[1])]
        cycles = [search.best() if search else 0.0 for search in searches]
        tried = [search.tried if search else 0.0 for search in searches]
        return cls(np.array(cycles), max(1.0, float(np.mean(tried))))


def gain(rows: Rows, frequency: Array) -> Array:
    """What the low-pass behind the rows leaves of a frequency [Hz]; all if it is not known."""
    if not rows.bandwidth:
        return np.ones_like(frequency)
    order = rows.order or ORDER
    return two_sided_gain(frequency * two_sided_bandwidth(order) / rows.bandwidth, order)


@dataclass(frozen=True)
class _Search:
    """Periods per rad or m between `least` and `most`, for the torque of one joint.

    `q` and `v` are its positions from the lowest one and its speeds, of the rows that count, W
    those of the regressor with columns of unit length, and y what they leave of the torque.
    """

    rows: Rows
    q: Array
    v: Array
    W: Array
    y: Array
    least: float
    most: float

    @classmethod
    def of(cls, rows: Rows, joint: int) -> _Search | None:
        """None if no number of periods can be seen."""
        counts = rows.scales[:, joint] > 0.0
        q, v = rows.motion[:2, joint][:, counts]
        if not len(q) or not np.ptp(q) > 0.0 or not np.any(v) or not rows.h > 0.0:
            return None
        width, slow = float(np.ptp(q)), SLOW * float(np.sqrt(np.mean(v**2)))
        highest = rows.bandwidth or 0.5 / rows.h
        least, most = PERIODS / width, min(highest / slow, len(q) / width)
        if not (most - least) * width >= 1.0:
            return None
        W, y = rows.W[counts, joint], rows.y[counts, joint]
        sizes = np.sqrt(np.sum(W**2, axis=0))
        W = W[:, sizes > 0.0] / sizes[sizes > 0.0]
        search = cls(rows, q - q.min(), np.abs(v), W, y, least, most)
        return replace(search, y=search._left(y))

    @property
    def tried(self) -> float:
        """How many independent numbers of periods there are."""
        return (self.most - self.least) * float(np.ptp(self.q))

    def best(self) -> float:
        """The number that explains most."""
        numbers, explained = self._explained()
        first = float(numbers[int(np.argmax(explained))])
        step = float(numbers[1] - numbers[0])
        near = first + step * np.linspace(-1.0, 1.0, 2 * NEARER + 1)
        return float(near[int(np.argmax([self._exactly(n) for n in near.tolist()]))])

    def _explained(self) -> tuple[Array, Array]:
        """All numbers of periods, and the squares that each explains.

        Sine and cosine are taken to be independent and equally large, which they are nearly over
        two periods and more.
        """
        places = (self.q * 4.0 * self.most).astype(np.int64)  # a quarter of the shortest period
        length = 1 << (FINER * int(places.max() + 1)).bit_length()
        edges = np.quantile(self.v, np.linspace(0.0, 1.0, SPEEDS + 1)[1:-1])
        group = np.searchsorted(edges, self.v)
        numbers = np.arange(length // 2 + 1) * 4.0 * self.most / length
        sums, powers = np.zeros(len(numbers), dtype=complex), np.zeros(len(numbers))
        for k in range(SPEEDS):
            inside = group == k
            if not inside.any():
                continue
            left = gain(self.rows, numbers * float(np.median(self.v[inside])))
            parts = np.bincount(places[inside], self.y[inside], length)
            sums += left * np.fft.rfft(parts)
            powers += 0.5 * left**2 * np.count_nonzero(inside)
        chosen = (numbers >= self.least) & (numbers <= self.most)
        return numbers[chosen], np.abs(sums[chosen]) ** 2 / powers[chosen]

    def _exactly(self, number: float) -> float:
        """The squares that this number of periods explains."""
        waves = gain(self.rows, number * self.v) * np.exp(2j * np.pi * number * self.q)
        columns = np.stack((waves.real, waves.imag), axis=1)
        columns = self._left(columns)
        found, *_ = np.linalg.lstsq(columns, self.y, rcond=None)
        return float(self.y @ columns @ found)

    def _left(self, x: Array) -> Array:
        """What W leaves of x (rows, ...)."""
        return np.asarray(x - self.W @ (self._inverse @ (self.W.T @ x)))

    @cached_property
    def _inverse(self) -> Array:
        """That of W'W, or its pseudo-inverse."""
        return np.asarray(np.linalg.pinv(self.W.T @ self.W, hermitian=True))
