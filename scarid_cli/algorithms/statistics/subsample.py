"""Rows of a record that stand for all of them: the whole of a short one, segments of a long one."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, joined

SAMPLES = 16_384  # held of a streamed record, at most
NUMBERS = 2_000_000  # that these have, unless that is too few
FEWEST = 4096  # samples
ALL = 10**15
SEGMENTS = 8  # that these are in, at most


@dataclass(frozen=True)
class Subsample:
    """Samples by their numbers: every `thin`-th one of every `stride`-th segment of a record.

    `samples` are held at most. First they are thinned, up to every `thinnest`-th; then segments are
    dropped. `total` counts the samples that went by, `counted` their rows that count.
    """

    parts: tuple[Rows, ...] = ()
    samples: int = SAMPLES
    thinnest: int = 1
    thin: int = 1
    stride: int = 1
    total: int = 0
    counted: int = 0

    def add(self, rows: Rows) -> Subsample:
        """Take in the next samples."""
        limit = self.samples
        if limit < ALL:
            limit = min(limit, max(FEWEST, NUMBERS // _size(rows)))
        parts, thin, stride = list(self.parts), self.thin, self.stride
        start = 0
        while start < rows.samples:
            segment = limit // SEGMENTS * thin
            number = int(rows.at[start]) // segment
            stop = start + int((rows.at[start:] < (number + 1) * segment).sum())
            if number % stride == 0:
                parts += _thinned([rows.part(slice(start, stop))], thin)
            while len({int(part.at[0]) // segment for part in parts}) > SEGMENTS:
                if 2 * thin <= self.thinnest:
                    thin, segment = 2 * thin, 2 * segment
                    parts = _thinned(parts, thin)
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
        """Whether it has every sample."""
        return self.thin == self.stride == 1

    def rows(self) -> Rows:
        """What was kept, as one, numbered by the samples that are as far apart."""
        kept = joined(self.parts)
        return replace(kept, at=kept.at // self.thin, h=kept.h * self.thin)


def _thinned(parts: list[Rows], thin: int) -> list[Rows]:
    """Every so many-th sample by its number, in copies that do not keep what they were cut from."""
    chosen = [(part, np.flatnonzero(part.at % thin == 0)) for part in parts]
    return [part.taken(at) for part, at in chosen if len(at)]


def _size(rows: Rows) -> int:
    """Numbers of one sample."""
    arrays = (rows.W, rows.y, rows.scales, rows.motion)
    return max(1, sum(array.size for array in arrays) // max(1, rows.samples))
