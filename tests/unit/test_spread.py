"""Blocks that are spread over a long record."""

from __future__ import annotations

import numpy as np
import pytest

from scarid_cli.algorithms.tuning import spread
from scarid_cli.algorithms.tuning.lowpassed import Segment


def record(*rows: int) -> list[Segment]:
    """Segments whose positions are the numbers of their rows."""
    noise = np.zeros(1)
    return [Segment(x := np.arange(float(n))[None], x, noise) for n in rows]


def test_a_record_that_is_not_long_is_taken_as_a_whole() -> None:
    segments = record(119_999)
    assert spread.spread(segments, 1e-3, 10.0) == (segments, 1.0)


@pytest.mark.parametrize("rows", [(120_000,), (1_000_000,), (500_000, 500_000), (990_000, 10_000)])
def test_blocks_lie_evenly_from_the_first_row_to_the_last(rows: tuple[int, ...]) -> None:
    blocks, share = spread.spread(record(*rows), 1e-3, 10.0)
    assert share == sum(b.q.shape[1] for b in blocks) / sum(rows)
    assert 50_000 <= sum(b.q.shape[1] for b in blocks) <= 80_000
    assert blocks[0].q[0, 0] == 0.0
    assert blocks[-1].q[0, -1] == rows[-1] - 1
    assert all(b.q.shape == b.tau.shape for b in blocks)
    if len(rows) == 1:
        starts = np.diff([b.q[0, 0] for b in blocks])
        assert starts.max() - starts.min() <= 1.0


def test_blocks_last_twenty_periods_of_the_lowest_cutoff() -> None:
    blocks, _ = spread.spread(record(1_000_000), 1e-3, 1.0)
    assert {b.q.shape[1] for b in blocks} == {20_000}
