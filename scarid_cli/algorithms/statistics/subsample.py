"""A subsample of a record: all rows of a short one, evenly spread ones of a long one."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, joined

MOST_SAMPLES = 16_384  # of a streamed record
MOST_NUMBERS = 2_000_000  # in the arrays of these samples, unless FEWEST_SAMPLES have more
MOST_HELD = 20_000_000  # numbers, before a record that is held is thinned
FEWEST_SAMPLES = 4096
MOST_SEGMENTS = 8


@dataclass(frozen=True)
class Subsample:
    """Every `thin`-th sample of every `stride`-th segment of a record.

    At most `samples` are held, with at most so many `numbers`. As the record grows, the samples are
    thinned first, until every `thinnest`-th is left; after that, segments are dropped, unless the
    subsample `covers` the whole record. `total` is the number of samples of the record so far, and
    `counted` the number of their rows whose scale is not zero.
    """

    parts: tuple[Rows, ...] = ()
    samples: int = MOST_SAMPLES
    numbers: int = MOST_NUMBERS
    thinnest: int = 1
    covers: bool = False
    thin: int = 1
    stride: int = 1
    total: int = 0
    counted: int = 0

    def add(self, rows: Rows) -> Subsample:
        """The subsample after the next samples of the record."""
        limit = min(self.samples, max(FEWEST_SAMPLES, self.numbers // _size(rows)))
        parts, thin, stride = list(self.parts), self.thin, self.stride
        start = 0
        while start < rows.samples:
            segment = limit // MOST_SEGMENTS * thin
            number = int(rows.at[start]) // segment
            stop = start + int((rows.at[start:] < (number + 1) * segment).sum())
            if number % stride == 0:
                parts += _thinned([rows.part(slice(start, stop))], thin)
            while len({int(part.at[0]) // segment for part in parts}) > MOST_SEGMENTS:
                if 2 * thin <= self.thinnest:
                    thin, segment = 2 * thin, 2 * segment
                    parts = _thinned(parts, thin)
                elif self.covers:
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

    def packed(self) -> Subsample:
        """The same in one part, of which `rows` makes no copy, and to which nothing is added."""
        return replace(self, parts=(joined(self.parts),)) if self.parts else self

    def rows(self) -> Rows:
        """The rows of the subsample, with `at` and `h` those of the thinned record."""
        kept = joined(self.parts)
        return replace(kept, at=kept.at // self.thin, h=kept.h * self.thin)


def _thinned(parts: list[Rows], thin: int) -> list[Rows]:
    """The samples whose number is a multiple of `thin`, copied so that the rest can be freed."""
    chosen = [(part, np.flatnonzero(part.at % thin == 0)) for part in parts]
    return [part.part(at) for part, at in chosen if len(at)]


def _size(rows: Rows) -> int:
    """How many numbers the arrays hold for one sample."""
    arrays = (rows.W, rows.y, rows.scales, rows.motion)
    return max(1, sum(array.size for array in arrays) // max(1, rows.samples))
