"""Blocks that are spread over a long record, which say what all of it would."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scarid_cli.algorithms.tuning.lowpassed import Segment
from scarid_cli.arrays import spread_starts

BLOCKS = 10
ROWS = 6000  # of a block, at least
PERIODS = 20.0  # of the lowest cut-off in a block, at least: each end loses one


def spread(segments: Sequence[Segment], h: float, lowest: float) -> tuple[list[Segment], float]:
    """Blocks of the segments, sampled every h [s], and the share of the rows that they have.

    `lowest` [Hz] is the lowest cut-off of a low-pass that they will pass. What is not twice as long
    as its blocks is taken as a whole.
    """
    length = max(ROWS, int(PERIODS / (lowest * h)))
    rows = sum(s.q.shape[1] for s in segments)
    if rows < 2 * BLOCKS * length:
        return list(segments), 1.0
    blocks = [block for s in segments for block in _blocks(s, length, rows)]
    return blocks, sum(s.q.shape[1] for s in blocks) / rows


def _blocks(segment: Segment, length: int, rows: int) -> list[Segment]:
    """As many blocks of a segment as belong to its share of all rows, spread evenly."""
    own = segment.q.shape[1]
    count = max(1, round(BLOCKS * own / rows))
    if own < 2 * count * length:
        return [segment]
    return [
        replace(
            segment,
            q=segment.q[:, start : start + length],
            tau=segment.tau[:, start : start + length],
        )
        for start in spread_starts(own, length, count).tolist()
    ]
