"""Torque ripple: how many periods per rad or m the torque of each joint has beyond the model.

Cogging of a motor and errors of a gear make torques A sin(2 pi n q + phase). The low-pass behind
the rows leaves of it what it leaves of the frequency n |dq|, so that ripple shows in slow motion.
The n that explains most of what W leaves of the torque is searched for among all that such rows
have, with one Fourier transform over the positions for each of some intervals of speeds. Where it
explains much, the next one is searched for beside it, as a ripple has harmonics.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import zip_longest

import numpy as np

from scarid_cli.algorithms.filters.two_sided import two_sided_bandwidth, two_sided_gain
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.arrays import Array

PERIODS = 1.0  # over the range of a joint: what has fewer looks like a spring or gravity
SLOW = 0.1  # of the usual speed: motion that is to show the fastest ripple
SPEEDS = 16  # intervals of speed, of which each has one gain
FINER = 4  # steps of the search per independent number of periods
NEARER = 8  # steps between two of them
ORDER = 4  # of the low-pass, where it is not known
MOST = 3  # ripples of a joint
MUCH = 0.1  # of the squares that W leaves: a ripple beside which the next one is searched for


@dataclass(frozen=True)
class Ripples:
    """The periods per rad or m of the likeliest ripples of each joint, the largest one first.

    `cycles` (ripples, joints) is 0 where a joint has fewer. They are the best of so many that were
    `tried`, as a mean over the joints.
    """

    cycles: Array
    tried: float

    @classmethod
    def of(cls, rows: Rows) -> Ripples:
        """From the rows that count."""
        searches = [_Search.of(rows, joint) for joint in range(rows.y.shape[1])]
        found = [search.numbers() if search else [] for search in searches]
        tried = [search.tried if search else 0.0 for search in searches]
        cycles = np.array(list(zip_longest(*found, fillvalue=0.0))).reshape(-1, len(found))
        return cls(cycles, max(1.0, float(np.mean(tried))))


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
        return cls(rows, q - q.min(), np.abs(v), W, y, least, most).without(W)

    @property
    def tried(self) -> float:
        """How many independent numbers of periods there are."""
        return (self.most - self.least) * float(np.ptp(self.q))

    def numbers(self) -> list[float]:
        """The likeliest number, and further ones as long as all of them explain much."""
        found, search = list[float](), self
        while len(found) < MOST:
            explained, number = search.best()
            much = explained > MUCH * float(search.y @ search.y)
            if much or not found:
                found.append(number)
            if not much:
                break
            search = search.without(np.hstack((search.W, search._waves(number))))
        return found

    def best(self) -> tuple[float, float]:
        """The squares that the likeliest number explains, and this number."""
        numbers, explained = self._explained()
        first = float(numbers[int(np.argmax(explained))])
        step = float(numbers[1] - numbers[0])
        near = first + step * np.linspace(-1.0, 1.0, 2 * NEARER + 1)
        exactly = [(self._exactly(number), number) for number in near.tolist()]
        return max(exactly, key=lambda found: found[0])

    def _explained(self) -> tuple[Array, Array]:
        """All numbers of periods, and the squares that each explains.

        Sine and cosine are taken to be independent and equally large, which they nearly are over
        several periods.
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
        columns = self.left(self._waves(number))
        found, *_ = np.linalg.lstsq(columns, self.y, rcond=None)
        return float(self.y @ columns @ found)

    def _waves(self, number: float) -> Array:
        """The cosine and the sine with this number of periods (rows, 2)."""
        waves = gain(self.rows, number * self.v) * np.exp(2j * np.pi * number * self.q)
        return np.stack((waves.real, waves.imag), axis=1)

    def without(self, W: Array) -> _Search:
        """The search in what these columns W (rows, columns) leave of the torque."""
        search = replace(self, W=W)
        return replace(search, y=search.left(self.y))

    def left(self, x: Array) -> Array:
        """What W leaves of x (rows, ...)."""
        return np.asarray(x - self.W @ (self._inverse @ (self.W.T @ x)))

    @cached_property
    def _inverse(self) -> Array:
        """That of W'W, or its pseudo-inverse."""
        return np.asarray(np.linalg.pinv(self.W.T @ self.W, hermitian=True))
