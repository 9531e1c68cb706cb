"""The cut-off of an axis whose torques are of another instant than its positions."""

from __future__ import annotations

import numpy as np
import pytest

from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.tuning.lead import without_lead
from scarid_cli.algorithms.tuning.lowpassed import Segment
from scarid_cli.arrays import Array
from scarid_cli.stages.procedure.bandwidth import bandwidth
from scarid_cli.stages.records.record import Record

AXIS = load("emps")
FINE = 1e-3  # s, of the simulation
H = 8e-3  # s, of the log
CUTOFF = 5.0  # Hz


def moves(seconds: float = 25.0) -> Array:
    """Position, velocity, acceleration (3, 1, samples) of moves with trapezoids of velocity."""
    rng = np.random.default_rng(1)
    pieces, at = [np.zeros(300)], 0.0
    while sum(map(len, pieces)) * FINE < seconds + 1.0:
        size, ramp, cruise = 3.0, int(rng.integers(60, 160)), int(rng.integers(50, 500))
        distance = size * ramp * (ramp + cruise) * FINE**2
        way = -1.0 if at + distance > 0.4 else 1.0
        at += way * distance
        up, rest = np.full(ramp, way * size), np.zeros(int(rng.integers(50, 400)))
        pieces.append(np.concatenate((up, np.zeros(cruise), -up, rest)))
    ddq = np.concatenate(pieces)
    dq = FINE * np.cumsum(ddq)
    return np.stack((FINE * np.cumsum(dq), dq, ddq))[:, None]


def axis(delay: float, seconds: float = 25.0) -> Segment:
    """A log of the axis, whose torques are late by a delay of whole steps of the simulation."""
    true = moves(seconds)
    torque = AXIS.torques(AXIS.regressor(*true), AXIS.apriori)
    every = np.arange(200, int(seconds / FINE), round(H / FINE))
    rng = np.random.default_rng(2)
    q = true[0][:, every] + 2e-6 * rng.standard_normal((1, len(every)))
    tau = torque[:, every - round(delay / FINE)] + 3.0 * rng.standard_normal((1, len(every)))
    return Segment(np.ascontiguousarray(q), np.ascontiguousarray(tau), np.full(1, 2e-6))


def chosen(segment: Segment) -> float:
    return bandwidth(Record((np.vstack((segment.q, segment.tau)),), 1, H), AXIS).choice.cutoff


@pytest.mark.parametrize("delay", [0.004, 0.008, 0.02, -0.008])
def test_a_delay_does_not_lower_the_cutoff(delay: float) -> None:
    """With the torques as they are, it is a quarter to half an octave lower."""
    assert chosen(axis(delay)) == pytest.approx(chosen(axis(0.0)), rel=0.02)


@pytest.mark.parametrize("delay", [0.008, 0.024, -0.016])
def test_torques_are_brought_in_step(delay: float) -> None:
    """They are those of a log without a delay, but for noise and the rest of the delay."""
    late, true = axis(delay), axis(0.0)
    (steady,) = without_lead(AXIS, [late], H, CUTOFF)
    first = int(np.flatnonzero(true.q[0] == steady.q[0, 0])[0])
    same = slice(first, first + steady.q.shape[1])
    np.testing.assert_array_equal(steady.q, true.q[:, same])
    off, before = (np.std((x - true.tau)[:, 5:-5]) for x in (padded(steady, true, same), late.tau))
    assert off < 0.25 * before


def padded(steady: Segment, like: Segment, same: slice) -> Array:
    """The torques of a segment at their places, and those of the other elsewhere."""
    tau = like.tau.copy()
    tau[:, same] = steady.tau
    return tau


def test_torques_in_step_remain_as_they_are() -> None:
    assert without_lead(AXIS, [axis(0.0)], H, CUTOFF) == []


@pytest.mark.parametrize("rows", [101, 103, 110])
def test_segments_of_hardly_a_row_behind_the_lowpass_are_left_out(rows: int) -> None:
    """Between a low-pass's period at either end, a short segment has one row or none."""
    late = axis(0.024)
    short = Segment(late.q[:, :rows].copy(), late.tau[:, :rows].copy(), late.noise)
    assert without_lead(AXIS, [short], H, 2.5) == []
    assert without_lead(AXIS, [late, short], H, 2.5)
