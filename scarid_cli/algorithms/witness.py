"""Rows of a record that stand for all of them: the whole of a short one, segments of a long one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.regression import Rows, joined

SAMPLES = 16_384  # held of a streamed record, at most
NUMBERS = 2_000_000  # that these have, unless that is too few
FEWEST = 4096  # samples
ALL = 10**15
SEGMENTS = 8  # that these are in, at most


@dataclass(frozen=True)
class Witness:
    """Every `stride`-th segment of a record, by the numbers of its samples.

    `samples` are held at most. `total` counts the samples that went by, `counted` their rows that
    count.
    """

    parts: tuple[Rows, ...] = ()
    samples: int = SAMPLES
    stride: int = 1
    total: int = 0
    counted: int = 0

    def add(self, rows: Rows) -> Witness:
        """Take in the next samples."""
        limit = self.samples
        if limit < ALL:
            limit = min(limit, max(FEWEST, NUMBERS // _size(rows)))
        segment = limit // SEGMENTS
        parts, stride = list(self.parts), self.stride
        start = 0
        while start < rows.samples:
            number = int(rows.at[start]) // segment
            stop = start + int((rows.at[start:] < (number + 1) * segment).sum())
            if number % stride == 0:
                parts.append(_copied(rows.part(slice(start, stop))))
            while len({int(part.at[0]) // segment for part in parts}) > SEGMENTS:
                stride *= 2
                parts = [part for part in parts if int(part.at[0]) // segment % stride == 0]
            start = stop
        total = self.total + rows.samples
        counted = self.counted + int(np.count_nonzero(rows.scales))
        return Witness(tuple(parts), self.samples, stride, total, counted)

    def rows(self) -> Rows:
        """What was kept, as one."""
        return joined(self.parts)


def _size(rows: Rows) -> int:
    """Numbers of one sample."""
    arrays = (rows.W, rows.y, rows.scales, rows.motion)
    return max(1, sum(array.size for array in arrays) // max(1, rows.samples))


def _copied(rows: Rows) -> Rows:
    """A part that does not keep the whole it was cut from."""
    return Rows(
        rows.W.copy(),
        rows.y.copy(),
        rows.scales.copy(),
        rows.at.copy(),
        rows.motion.copy(),
        None if rows.reference is None else rows.reference.copy(),
    )
