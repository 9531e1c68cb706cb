"""When a payload is picked up or put down, and what it weighs: block by block, as rows arrive.

What the residual torques of a bare robot's model say about the ten parameters of a payload is
summed over blocks of a quarter of a second. The record is a sequence of pieces with one payload. At
the end of each block, the last blocks of the piece are fitted by themselves, for some numbers of
them, and a change is suspected where mass and first moments differ from those before by more than
chance allows (the generalised likelihood ratio of Willsky and Jones, IEEE Trans. Autom. Control 21,
1976, with unknown values on both sides). A second later the likeliest place is sought, and the
change is one if the payloads on both sides still differ: a contact is over by then. Whatever the
model of the bare robot lacks is the same before and after, and does not count. Friction and offsets
are free to change with the load and with time, by VARIES of what they are (one standard deviation).

How noisy blocks are is found from what the piece so far leaves of one, four and sixteen of them, as
medians, which a pick-up does not move; longer ones have more where residuals are correlated in
time. A load makes friction and bending, and so the noise: it is found anew in each piece, and until
it is known, the difference must be large beside that of the last change.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.special import chdtri

from scarid_cli.arrays import Array

BLOCK = 0.25  # s
HOUR = 3600.0  # s
SIZES = np.array([*np.full(6, 0.2), *np.full(3, 2.0), 10.0])  # kg m2, kg m, kg: known beforehand
VARIES = 0.1  # of the friction
TESTED = [6, 7, 8, 9]  # first moments and mass; the inertia goes with them
ASIDE = 24  # blocks before a change, each of which is left out once
LATER = (1, 2, 3, 4, 6, 8, 12, 16, 24)  # blocks that are compared with those before
SHORTEST = 4  # blocks of a piece before the blocks that are compared with it
SECOND = 4  # blocks
PLACES = LATER[-1] + SECOND  # blocks before the end, at one of which a change is sought
KNOWN = {1: 32, 4: 8, 16: 4}  # of spans of so many blocks: values from which on the noise is known
LOST = 0.05  # of a load, which gears make friction of or not (2 to 10 %): no change of it
ARMS = np.array([0.1, 0.1, 0.1, 1.0])  # m, by which it seems to be elsewhere; and 1 for the mass
SHARE = 0.1  # of the last change: a standard deviation, until the noise is known again
MEMORY = 240  # blocks, of whose noise the median is taken, and with which later ones are compared
RANK = 1e-6  # of the largest eigenvalue


@dataclass(frozen=True)
class Sums:
    """What rows say: A'A and A'r of the payload's and the friction's columns, A'W of the robot's.

    Each joint is weighted by one over the variance of its residual. `sizes` (columns) are the
    standard deviations that the parameters have beforehand.
    """

    gram: Array
    score: Array
    bare: Array
    sizes: Array

    @classmethod
    def none(cls, sizes: Array, parameters: int) -> Sums:
        n = len(sizes)
        return cls(np.zeros((n, n)), np.zeros(n), np.zeros((n, parameters)), sizes)

    def with_rows(self, W: Array, B: Array, residual: Array, weights: Array) -> Sums:
        """From the robot's rows W (samples, joints, parameters), of which the columns are A = W B.

        residual, weights (samples, joints).
        """
        flat = W.reshape(-1, W.shape[2])
        own = flat @ B
        scaled = own * weights.reshape(-1, 1)
        new = own.T @ scaled, scaled.T @ residual.ravel(), scaled.T @ flat
        return self + Sums(*new, self.sizes)

    def __add__(self, other: Sums) -> Sums:
        return self._with(other, 1.0)

    def __sub__(self, other: Sums) -> Sums:
        return self._with(other, -1.0)

    def _with(self, other: Sums, times: float) -> Sums:
        return Sums(
            self.gram + times * other.gram,
            self.score + times * other.score,
            self.bare + times * other.bare,
            self.sizes,
        )

    def solved(self, noise: float) -> tuple[Array, Array]:
        """The parameters and their covariance, where rows are so many times as noisy."""
        covariance: Array = np.asarray(np.linalg.inv(self.gram / noise + np.diag(self.sizes**-2.0)))
        return covariance @ self.score / noise, covariance

    def explained(self, noise: float) -> float:
        """Twice by how much the parameters raise the log-likelihood."""
        return float(self.solved(noise)[0] @ self.score) / noise


@dataclass
class Piece:
    """So many `blocks` from `start` to `end` [s] with one payload, which was `found` at that time.

    `sums` has their sums up to each of the last blocks, from zero on if there are few. If this
    change was told before, it was `misplaced` at that time [s].
    """

    start: float
    end: float
    found: float
    blocks: int
    sums: list[Sums]
    misplaced: float | None = None

    @property
    def total(self) -> Sums:
        return self.sums[-1]

    def add(self, block: Sums, end: float) -> None:
        self.sums = [*self.sums[-MEMORY - LATER[-1] :], self.total + block]
        self.blocks, self.end = self.blocks + 1, end

    def parted(self, later: int) -> tuple[Sums, Sums]:
        """The sums of the last blocks, so many, and of up to MEMORY blocks before them."""
        at = self.sums[-1 - later]
        return at - self.sums[max(-1 - later - MEMORY, -len(self.sums))], self.total - at


@dataclass
class Noises:
    """How many times the variance of white noise blocks have: the `medians` of spans of them.

    If there is a piece `before`, its medians count until those of this one are known, which they
    are of the spans that are `new`.
    """

    before: bool = False
    medians: dict[int, float] = field(default_factory=dict)
    new: set[int] = field(default_factory=set)
    values: dict[int, deque[float]] = field(
        default_factory=lambda: {span: deque(maxlen=MEMORY // span) for span in KNOWN}
    )

    def add(self, span: int, value: float) -> None:
        self.values[span].append(value)
        if len(self.values[span]) >= KNOWN[span]:
            self.medians[span] = float(np.median(self.values[span]))
            self.new.add(span)

    @property
    def are_old(self) -> bool:
        """Whether the noise is that of the piece before."""
        return self.before and len(self.new) < 2

    def among(self, blocks: int) -> float:
        """Of so many blocks: the largest of spans that are no longer; 0 if one is not known."""
        spans = [span for span in KNOWN if span <= blocks]
        return max(self.medians[x] for x in spans) if self.medians.keys() >= {*spans} else 0.0

    def anew(self) -> Noises:
        """Those of the next piece."""
        return Noises(before=True, medians=dict(self.medians))


@dataclass
class Carrying:
    """The pieces so far; `none` are sums of no rows, `rate` the false changes allowed [1/h].

    `suspected` is the time [s] at which a change was suspected that is not yet one.
    """

    none: Sums
    rate: float
    pieces: list[Piece] = field(default_factory=list)
    suspected: float | None = None
    noises: Noises = field(default_factory=Noises)

    @property
    def threshold(self) -> float:
        """What the statistic of mass and moments passes by chance, at the rate for all tests."""
        tests = len(LATER) * HOUR / BLOCK
        return float(chdtri(len(TESTED), min(self.rate / tests, 0.5)))

    @property
    def noise(self) -> float:
        """How many times the variance of white noise pieces have; 1 before it is known."""
        return max(self.noises.medians.values(), default=0.0) or 1.0

    @property
    def last(self) -> Piece:
        return self.pieces[-1]

    def add(self, start: float, end: float, block: Sums) -> bool:
        """The block from `start` to `end` [s]; whether a new piece has begun by then."""
        if not self.pieces:
            self.pieces.append(Piece(start, end, start, 0, [self.none]))
        piece = self.last
        self._note(piece, block)
        piece.add(block, end)
        if self.suspected is None:
            self.suspected = end if self._differ(piece) else None
            return False
        if end < self.suspected + SECOND * BLOCK - 1e-9:
            return False
        suspected, self.suspected = self.suspected, None
        return self._divided(piece, suspected)

    def _note(self, piece: Piece, block: Sums) -> None:
        """What the piece leaves of the last blocks."""
        for span in KNOWN:
            if piece.blocks % span == span - 1 and piece.blocks + 1 >= span + SHORTEST:
                since, before = self.none, piece.total
                if span > 1:
                    since, before = piece.parted(span - 1)[1], piece.sums[-span]
                self.noises.add(span, _left(before, since + block))

    def _differ(self, piece: Piece) -> bool:
        """Whether the last blocks, for any number of them, differ from those before."""
        counts = [count for count in LATER if piece.blocks - count >= SHORTEST]
        return any(self._apart(*piece.parted(count), count) > self.threshold for count in counts)

    def _clear(self, piece: Piece, later: int) -> bool:
        """Whether both sides differ, whichever single block of either is left out.

        A contact, or a glitch of a sensor, is one block.
        """
        before, after = piece.parted(later)[0], piece.parted(later - 1)[1]
        ends = piece.sums[-later - ASIDE - 1 :]
        blocks = [b - a for a, b in pairwise(ends)]
        early, late = blocks[:-later], blocks[len(blocks) - later + 1 :]
        sides = [(before - block, after) for block in early]
        sides += [(before, after - block) for block in late]
        return all(self._apart(*pair, later - 1) > self.threshold for pair in sides)

    def _apart(self, before: Sums, after: Sums, count: int) -> float:
        """The square of the distance of mass and moments before and after, in standard deviations.

        `after` are so many blocks. 0 before the noise is known.
        """
        noise = self.noises.among(count)
        if not noise:
            return 0.0
        (early, one), (late, two) = before.solved(noise), after.solved(noise)
        off, spread = (late - early)[TESTED], (one + two)[np.ix_(TESTED, TESTED)]
        heavier = max(abs(early[9]), abs(late[9]))
        spread = spread + np.diag((LOST * heavier * ARMS) ** 2)
        if self.noises.are_old:
            spread = spread + SHARE**2 * np.outer(self.last_change, self.last_change)
        return float(off @ np.linalg.solve(spread, off))

    @property
    def last_change(self) -> Array:
        """By how much mass and moments have changed between the last two pieces."""
        early, late = (piece.total.solved(self.noise)[0] for piece in self.pieces[-2:])
        return np.asarray((late - early)[TESTED])

    def _divided(self, piece: Piece, suspected: float) -> bool:
        """Whether the piece is two, in whose place they then are.

        The first block of the new one, in which the payload changes, counts for neither.
        """
        noise = self.noise
        places = range(2, min(PLACES, piece.blocks - SHORTEST) + 1)
        gains = {k: sum(x.explained(noise) for x in piece.parted(k)) for k in places}
        later = max(gains, key=gains.__getitem__) if gains else 0
        if not later:
            return False
        if not self._clear(piece, later):
            return False
        start = piece.sums[-later]
        new = [sums - start for sums in piece.sums[-later:]]
        end, at = piece.end, piece.end - later * BLOCK
        piece.end, piece.blocks, piece.sums = at, piece.blocks - later, piece.sums[:-later]
        misplaced = self._undone()
        self.pieces.append(Piece(at, end, suspected, later - 1, new, misplaced))
        self.noises = self.noises.anew()
        return True

    def _undone(self) -> float | None:
        """Where the last change was placed [s], if without the blocks that are now cut it is none.

        It was this one, placed too early; its piece is then that before it.
        """
        if len(self.pieces) < 2:
            return None
        before, last = self.pieces[-2:]
        known = self.noises.among(last.blocks) > 0.0
        if not known or self._apart(before.total, last.total, last.blocks) > self.threshold:
            return None
        self.pieces.pop()
        before.sums += [before.total + sums for sums in last.sums[1:]]
        before.blocks, before.end = before.blocks + 1 + last.blocks, last.end
        return last.start


def _left(before: Sums, block: Sums) -> float:
    """The square of what a fit of the blocks before leaves of a block, over that of white noise."""
    phi, covariance = before.solved(1.0)
    rest = block.score - block.gram @ phi
    values, vectors = np.linalg.eigh(block.gram + block.gram @ covariance @ block.gram)
    kept = values > RANK * values[-1]
    along = vectors[:, kept].T @ rest
    rank = int(np.count_nonzero(kept))
    median = (1.0 - 2.0 / (9.0 * max(rank, 1))) ** 3  # of chi squared over its mean, nearly
    return float(np.sum(along**2 / values[kept]) / max(rank, 1) / median) if rank else 0.0
