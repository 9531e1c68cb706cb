"""Rows that count: away from reversals and standstill, however the rows arrive."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scarid_cli.algorithms.regression.counting import (
    REVERSAL,
    SLOW,
    Counting,
    LeftOut,
    counted,
)
from scarid_cli.algorithms.regression.rows import Rows, joined
from scarid_cli.algorithms.robots.coupled import CoupledCoulomb
from scarid_cli.arrays import Array, Numbers

H = 0.01
SIZES = st.lists(st.sampled_from([1, 2, 7, 64, 500]), min_size=1, max_size=4)


def rows_of(dq: Array, at: Numbers | None = None) -> Rows:
    joints, samples = dq.shape
    motion = np.zeros((4, joints, samples))
    motion[1] = dq
    numbers = np.arange(samples) if at is None else at
    shape = (samples, joints)
    return Rows(np.zeros((*shape, 1)), np.zeros(shape), np.ones(shape), numbers, H, motion)


def parts(rows: Rows, sizes: Sequence[int]) -> Iterator[tuple[int, Rows]]:
    """The rows cut into parts, none of which has a gap."""
    start = turn = 0
    while start < rows.samples:
        stop = min(start + sizes[turn % len(sizes)], rows.samples)
        gap = np.flatnonzero(np.diff(rows.at[start:stop]) != 1)
        stop = start + int(gap[0]) + 1 if len(gap) else stop
        yield turn, rows.part(slice(start, stop))
        start, turn = stop, turn + 1


def scales(rows: Rows, counting: Counting, sizes: Sequence[int] = (10_000,)) -> Array:
    found = list(counted(parts(rows, sizes), counting, LeftOut()))
    assert [turn for turn, _ in found] == sorted(turn for turn, _ in found)
    return joined([part for _, part in found]).scales


def by_definition(rows: Rows, counting: Counting) -> Array:
    """Row by row, looking at every other row."""
    dq, at = rows.motion[1], rows.at
    window = counting.window(H)
    found = np.ones(rows.scales.shape)
    for j, v in enumerate(dq):
        for k in range(rows.samples):
            rms = np.sqrt(np.mean(v[: k + 1] ** 2))
            slow = not abs(v[k]) > max(SLOW * rms, counting.floor(len(dq))[j])
            near = any(
                at[i + 1] == at[i] + 1
                and np.sign(v[i]) != np.sign(v[i + 1])
                and at[k] - window <= at[i] <= at[k] + window - 1
                and abs(at[k] - at[i]) == abs(k - i)
                for i in range(max(k - window, 0), min(k + window, rows.samples - 1))
            )
            found[k, j] = not (slow or near)
    return found


def velocities(samples: int = 300) -> Array:
    rng = np.random.default_rng(0)
    t = np.arange(samples) * H
    still = np.where((t > 1.0) & (t < 1.4), 1e-3, 1.0)
    return np.array([np.sin(5.0 * t), still * np.cos(3.0 * t)]) + 1e-4 * rng.standard_normal(
        (2, samples)
    )


COUNTINGS = [
    Counting(),
    Counting(bandwidth=10.0),
    Counting(bandwidth=4.0, velocity_noise=(0.1, 0.0)),
    Counting(bandwidth=1000.0),
]


@pytest.mark.parametrize("counting", COUNTINGS, ids=str)
def test_rows_near_reversals_and_standstill_are_left_out(counting: Counting) -> None:
    rows = rows_of(velocities())
    assert scales(rows, counting).tolist() == by_definition(rows, counting).tolist()


def test_a_log_that_is_known_as_a_whole_does_not_count_the_creeping_before_its_motion() -> None:
    """Its speeds so far let it pass: at first nothing is faster."""
    t = np.arange(300) * H
    dq = np.array([np.where(t < 1.0, 1e-3 * (1.0 + t), 2.0 + np.sin(5.0 * t))])
    left_out = LeftOut()
    ((_, rows),) = counted([(0, rows_of(dq))], Counting(bandwidth=10.0), left_out)
    assert rows.scales[:100].all()
    assert not left_out.settled(rows).scales[:100].any()
    assert left_out.settled(rows).scales[100:].all()
    assert LeftOut().settled(rows) is rows  # where all rows count


@pytest.mark.parametrize("counting", COUNTINGS, ids=str)
def test_a_reversal_does_not_reach_across_a_gap(counting: Counting) -> None:
    at = np.concatenate((np.arange(120), 130 + np.arange(180)))
    rows = rows_of(velocities(), at)
    assert scales(rows, counting).tolist() == by_definition(rows, counting).tolist()


@given(sizes=SIZES)
@settings(max_examples=20, deadline=None)
def test_the_same_rows_count_however_they_arrive(sizes: list[int]) -> None:
    at = np.concatenate((np.arange(120), 130 + np.arange(180)))
    for counting in COUNTINGS:
        rows = rows_of(velocities(), at)
        assert scales(rows, counting, sizes).tolist() == scales(rows, counting).tolist()


def test_a_joint_that_stands_still_does_not_count() -> None:
    assert not scales(rows_of(np.zeros((1, 50))), Counting()).any()


def test_what_was_left_out_is_counted() -> None:
    left_out = LeftOut()
    counting = Counting(bandwidth=10.0)
    rows = rows_of(velocities())
    found = [part for _, part in counted(parts(rows, (64,)), counting, left_out)]
    zeros = int((joined(found).scales == 0.0).sum())
    assert left_out.rows == 600
    assert left_out.reversal + left_out.standstill == zeros > 0
    assert "near reversals and" in left_out.text
    assert LeftOut(10).text == ""


def test_the_window_is_half_a_period_of_the_bandwidth() -> None:
    assert Counting(bandwidth=4.0).window(H) == int(REVERSAL / 4.0 / H) == 12
    assert Counting().window(H) == 0
    assert Counting(bandwidth=100.0).decimated(0.05).bandwidth == pytest.approx(8.0)


@given(sizes=SIZES)
@settings(max_examples=10, deadline=None)
def test_rows_near_a_reversal_of_a_motor_that_turns_with_two_joints_are_left_out_of_both(
    sizes: list[int],
) -> None:
    """As if each of the joints had reversed with the motor; the third joint has nothing to do."""
    t = H * np.arange(600)
    dq = np.stack((1.0 + 0.3 * np.sin(5.0 * t), -0.9 + 0.4 * np.cos(3.0 * t), 1.0 + 0.0 * t))
    motor = CoupledCoulomb(joint=1, other=2, ratio=1.0)
    found = scales(rows_of(dq), Counting(2.0, motors=(motor,)), sizes)
    alone = scales(rows_of(motor.speed(dq)[None] + 0.0), Counting(2.0))[:, 0]
    turned = np.flatnonzero(np.diff(np.sign(motor.speed(dq))))
    assert len(turned) > 1
    near = np.min(np.abs(np.arange(600)[:, None] - turned - 0.5), axis=1) < Counting(2.0).window(H)
    np.testing.assert_array_equal(found[:, :2] == 0.0, np.column_stack((near, near)))
    assert np.all(found[:, 2] == 1.0)
    assert np.all(alone[near] == 0.0)
