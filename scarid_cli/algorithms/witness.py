"""Rows of a record that stand for all of them: the whole of a short one, segments of a long one."""

from __future__ import annotations

from dataclasses import dataclass

from scarid_cli.algorithms.regression import Rows, joined

NUMBERS = 2_000_000  # held of a streamed record, 16 MB
ALL = 10**15
SEGMENTS = 8  # of the record, held at most


@dataclass(frozen=True)
class Witness:
    """Every `stride`-th segment of a record, by the numbers of its samples; memory is bounded.

    `numbers` are held at most. `total` counts the samples that went by.
    """

    parts: tuple[Rows, ...] = ()
    numbers: int = NUMBERS
    segment: int = 0
    stride: int = 1
    total: int = 0

    def add(self, rows: Rows) -> Witness:
        """Take in the next samples."""
        segment = self.segment or max(1, self.numbers // SEGMENTS // _size(rows))
        parts, stride = list(self.parts), self.stride
        start = 0
        while start < rows.samples:
            number = int(rows.at[start]) // segment
            stop = start + int((rows.at[start:] < (number + 1) * segment).sum())
            if number % stride == 0:
                parts.append(rows.part(slice(start, stop)))
            while len({int(part.at[0]) // segment for part in parts}) > SEGMENTS:
                stride *= 2
                parts = [part for part in parts if int(part.at[0]) // segment % stride == 0]
            start = stop
        return Witness(tuple(parts), self.numbers, segment, stride, self.total + rows.samples)

    def rows(self) -> Rows:
        """What was kept, as one."""
        return joined(self.parts)


def _size(rows: Rows) -> int:
    """Numbers of one sample."""
    arrays = (rows.W, rows.y, rows.scales, rows.motion)
    return sum(array.size for array in arrays) // rows.samples + 1
