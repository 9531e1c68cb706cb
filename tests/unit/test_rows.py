"""Rows of a record: gaps, slow joints, subsamples and blocks of long records."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from unit.slow_motions import H, regression

from scarid_cli.algorithms.regression.rows import (
    SPREAD,
    Rows,
    joined,
    plain,
    rows_of,
    runs,
    spread,
)
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.algorithms.uncertainty.subsample import Subsample


def test_rows_of_slow_joints_are_left_out_joint_by_joint() -> None:
    motion = np.ones((4, 2, 3))
    motion[1] = [[0.05, -0.05, 0.2], [1.0, -1.0, 0.0]]
    rows = rows_of(load("scara2"), motion, np.arange(3), H, slow=np.array([0.1, 0.1]))
    assert rows.scales.tolist() == [[0.0, 1.0], [0.0, 1.0], [1.0, 0.0]]


def test_runs_end_at_gaps() -> None:
    at = np.array([0, 1, 2, 5, 6, 9])
    assert [at[run].tolist() for run in runs(at)] == [[0, 1, 2], [5, 6], [9]]


def test_joined_parts_are_the_whole() -> None:
    rows = regression(100)
    again = joined([rows.part(slice(0, 30)), rows.part(slice(30, 100))])
    np.testing.assert_array_equal(again.W, rows.W)
    np.testing.assert_array_equal(again.at, rows.at)
    assert again.h == rows.h


def test_a_short_record_is_represented_by_itself() -> None:
    rows = regression(100)
    assert spread(rows, rows.W.size) is rows


@pytest.mark.parametrize("numbers", [200, 1000, 4000])
def test_a_long_record_is_represented_by_parts_from_all_of_it(numbers: int) -> None:
    rows = regression(10_000)
    few = spread(rows, numbers)
    assert 0.4 * numbers < few.W.size <= numbers + rows.W[:SPREAD].size  # parts differ by a row
    assert len(list(runs(few.at))) == SPREAD
    longest = max(np.diff(few.at))
    assert longest < 1.5 * rows.samples / SPREAD
    np.testing.assert_array_equal(few.W, rows.W[few.at])


SIZES = [(1000,), (7, 300), (8192,)]


def fed(state: Subsample | Blocks, rows: Rows, sizes: tuple[int, ...]) -> Subsample | Blocks:
    """After rows in batches of these sizes, over and over."""
    start = turn = 0
    while start < rows.samples:
        size = sizes[turn % len(sizes)]
        state = state.add(rows.part(slice(start, start + size)))
        start, turn = start + size, turn + 1
    return state


@pytest.mark.parametrize("sizes", SIZES)
@pytest.mark.parametrize("thinnest", [1, 5])
def test_a_subsample_is_the_same_however_rows_arrive_and_stays_small(
    sizes: tuple[int, ...], thinnest: int
) -> None:
    W = np.arange(60_000.0).reshape(-1, 1, 1)
    rows = plain(W, W[:, :, 0])
    empty = Subsample(samples=5_000, thinnest=thinnest)
    subsample = fed(empty, rows, sizes)
    assert isinstance(subsample, Subsample)
    kept = subsample.rows()
    assert subsample.total == subsample.counted == rows.samples
    assert not subsample.complete
    assert 1_250 <= kept.samples <= 5_000
    assert subsample.thin == thinnest
    assert kept.h == subsample.thin * rows.h
    np.testing.assert_array_equal(kept.W[:, 0, 0], kept.at * subsample.thin)
    np.testing.assert_array_equal(kept.at, empty.add(rows).rows().at)


def test_a_subsample_is_thinned_before_segments_are_dropped() -> None:
    """So that it covers the whole of a record at a high rate."""
    W = np.arange(18_000.0).reshape(-1, 1, 1)
    subsample = Subsample(samples=5_000, thinnest=5).add(plain(W, W[:, :, 0]))
    kept = subsample.rows()
    assert (subsample.thin, subsample.stride) == (5, 1)
    np.testing.assert_array_equal(kept.at, np.arange(18_000 // 5))


@pytest.mark.parametrize("thinnest", range(1, 200))
def test_a_long_record_keeps_less_than_a_quarter_more_than_its_bandwidth_needs(
    thinnest: int,
) -> None:
    W = np.arange(2_000.0).reshape(-1, 1, 1)
    empty = Subsample(samples=8, numbers=1, thinnest=thinnest, covers=10**9)
    found = empty.add(plain(W, W[:, :, 0]))
    assert found.thin <= thinnest < 1.25 * found.thin


@pytest.mark.parametrize("sizes", SIZES)
@pytest.mark.parametrize("thinnest", [1, 5])
def test_a_subsample_may_cover_the_whole_record(sizes: tuple[int, ...], thinnest: int) -> None:
    W = np.arange(60_000.0).reshape(-1, 1, 1)
    empty = Subsample(samples=5_000, thinnest=thinnest, covers=10**9)
    kept = fed(empty, plain(W, W[:, :, 0]), sizes)
    assert isinstance(kept, Subsample)
    np.testing.assert_array_equal(kept.rows().W[:, 0, 0], np.arange(0.0, 60_000.0, thinnest))
    np.testing.assert_array_equal(kept.packed().rows().W, kept.rows().W)


@pytest.mark.parametrize("sizes", SIZES)
def test_a_subsample_that_covers_drops_segments_where_it_would_be_too_large(
    sizes: tuple[int, ...],
) -> None:
    """Samples that are thinned further would not hold what their bandwidth passes."""
    W = np.arange(60_000.0).reshape(-1, 1, 1)
    numbers_a_sample = 1 + 1 + 1 + plain(W, W[:, :, 0]).motion.shape[0]
    empty = Subsample(samples=5_000, thinnest=4, covers=10_000 * numbers_a_sample)
    kept = fed(empty, plain(W, W[:, :, 0]), sizes)
    assert isinstance(kept, Subsample)
    segment = 4 * 5_000 // 8
    every = np.arange(0.0, 60_000.0, 4)
    np.testing.assert_array_equal(kept.rows().W[:, 0, 0], every[every // segment % 2 == 0])
    assert (kept.thin, kept.stride) == (4, 2)


@pytest.mark.parametrize("sizes", SIZES)
def test_blocks_have_the_same_bits_however_rows_arrive(sizes: tuple[int, ...]) -> None:
    rows = regression(60_000)
    gapped = rows.part(np.flatnonzero((rows.at < 20_000) | (rows.at > 31_234)))
    whole, cut = (fed(Blocks.every(H), gapped, s).whole() for s in ((10**6,), sizes))
    assert isinstance(cut, Blocks)
    assert isinstance(whole, Blocks)
    assert (cut.numbers, cut.length) == (whole.numbers, whole.length)
    np.testing.assert_array_equal(cut.products, whole.products)
    assert len(cut.numbers) <= 128


def test_blocks_hold_the_products_of_all_rows_that_count() -> None:
    rows = regression(5_000)
    rows = replace(rows, scales=np.where(np.arange(5_000)[:, None] % 3 == 0, 0.0, 2.0))
    ones = np.ones((*rows.y.shape, 1))
    both = np.concatenate((rows.W, rows.y[:, :, None], ones), axis=2) * rows.scales[:, :, None]
    for joint, products in enumerate(Blocks.every(H).add(rows).whole().total):
        np.testing.assert_allclose(products, both[:, joint].T @ both[:, joint], rtol=1e-10)


def test_columns_of_blocks_are_blocks_of_the_columns() -> None:
    rows = regression(5_000)
    few = replace(rows, W=np.ascontiguousarray(rows.W[:, :, [0, 2]]))
    found, expected = (Blocks.every(H).add(x).whole() for x in (rows, few))
    for one, other in zip(found.columns([0, 2]).products, expected.products, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12)
