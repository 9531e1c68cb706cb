"""A subsample of a record: all rows of a short one, evenly spread ones of a long one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, joined

MOST_SAMPLES = 16_384  # of a streamed record
MOST_NUMBERS = 2_000_000  # in the arrays of these samples, unless FEWEST_SAMPLES have more
MOST_HELD = 4_000_000  # numbers, before a record that is held is thinned
MOST_COVERED = 20_000_000  # numbers, before only some segments are kept
FEWEST_SAMPLES = 4096
MOST_SEGMENTS = 8
FIRST = 8  # below which the first thinning is: at least half of this, if the thinnest is
GATHERED = 512  # samples of a part, above which it stays as it is


@dataclass(frozen=True)
class Subsample:
    """Every `thin`-th sample of every `stride`-th segment of a record.

    At most `samples` are held, with at most so many `numbers`. As the record grows, the samples are
    thinned first, until every `thinnest`-th is left: fewer would not hold what their bandwidth
    passes. After that, segments are dropped; if `covers` is not 0, not before there are so many
    numbers. Bare rows will get W with so many `columns`. `total` is the number of samples of the
    record so far, and `counted` that of their rows whose scale is not 0.
    """

    parts: tuple[Rows, ...] = ()
    samples: int = MOST_SAMPLES
    numbers: int = MOST_NUMBERS
    thinnest: int = 1
    covers: int = 0
    columns: int = 0
    thin: int = 1
    stride: int = 1
    total: int = 0
    counted: int = 0

    @classmethod
    def held(cls, thinnest: int, columns: int, covers: int) -> Subsample:
        """No samples yet of a record that is held, of which every `thinnest`-th would do."""
        return cls((), MOST_HELD, MOST_HELD, thinnest, covers, columns)

    def add(self, rows: Rows) -> Subsample:
        """The subsample after the next samples of the record."""
        limit = min(self.samples, max(FEWEST_SAMPLES, self.numbers // self._size(rows)))
        parts, thin, stride = list(self.parts), self.thin, self.stride
        start = 0
        while start < rows.samples:
            segment = limit // MOST_SEGMENTS * thin
            number = int(rows.at[start]) // segment
            stop = start + int((rows.at[start:] < (number + 1) * segment).sum())
            if number % stride == 0:
                parts += _thinned([rows.part(slice(start, stop))], thin)
                _gather(parts, segment)
            while len({int(part.at[0]) // segment for part in parts}) > MOST_SEGMENTS:
                if thin < (coarser := _coarser(thin, self.thinnest)):
                    thin, segment = coarser, segment * coarser // thin
                    parts = _thinned(parts, thin)
                elif self.covers and not self._is_too_large(parts):
                    break
                else:
                    stride *= 2
                    parts = [part for part in parts if int(part.at[0]) // segment % stride == 0]
            start = stop
        return replace(
            self,
            parts=tuple(parts),
            thin=thin,
            stride=stride,
            total=self.total + rows.samples,
            counted=self.counted + int(np.count_nonzero(rows.scales)),
        )

    @property
    def complete(self) -> bool:
        """Whether the subsample has every sample of the record."""
        return self.thin == self.stride == 1

    @property
    def size(self) -> int:
        """How many numbers the arrays hold."""
        return self._held(self.parts)

    def packed(self) -> Subsample:
        """The same in one part, of which `rows` makes no copy, and to which nothing is added."""
        return replace(self, parts=(joined(self.parts),)) if self.parts else self

    def _is_too_large(self, parts: list[Rows]) -> bool:
        """Whether these parts have more numbers than a subsample that covers the record may."""
        return 0 < self.covers < self._held(parts)

    def _held(self, parts: Sequence[Rows]) -> int:
        """How many numbers these parts hold, of which each sample has as many."""
        return sum(part.samples for part in parts) * self._size(parts[0]) if parts else 0

    def _size(self, rows: Rows) -> int:
        """How many numbers the arrays hold for one sample."""
        arrays = (rows.W, rows.y, rows.scales, rows.motion)
        held = sum(array.size for array in arrays) // max(1, rows.samples)
        return max(1, int(held + self.columns * rows.y.shape[1]))

    def rows(self) -> Rows:
        """The rows of the subsample, with `at` and `h` those of the thinned record."""
        kept = joined(self.parts)
        return replace(kept, at=kept.at // self.thin, h=kept.h * self.thin)


def _coarser(thin: int, thinnest: int) -> int:
    """The next thinning: a multiple of this one, of which the last comes near the thinnest.

    Doublings from 1 would leave up to twice as many samples as are needed; the first step is such
    that those after it, each of which doubles, end less than a quarter below the thinnest.
    """
    first = thinnest
    while first >= FIRST:
        first //= 2
    coarser = first if thin == 1 else 2 * thin
    return coarser if coarser <= thinnest else thin


def _gather(parts: list[Rows], segment: int) -> None:
    """Join what arrived a few rows at a time, such that a row is copied a few times at most.

    Whoever looks at each part, for each row that arrives, then looks at few.
    """
    while len(parts) > 1:
        before, last = parts[-2:]
        apart = before.at[0] // segment != last.at[0] // segment
        if apart or last.samples < before.samples or before.samples >= GATHERED:
            break
        parts[-2:] = [joined((before, last))]


def _thinned(parts: list[Rows], thin: int) -> list[Rows]:
    """The samples whose number is a multiple of `thin`, copied so that the rest can be freed."""
    chosen = [(part, np.flatnonzero(part.at % thin == 0)) for part in parts]
    return [part.part(at) for part, at in chosen if len(at)]
