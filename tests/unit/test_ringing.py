"""The ringing of friction behind a low-pass, against filtering it by scipy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conftest import ROOT
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import butter, sosfiltfilt

from scarid_cli.algorithms.effects.ringing import with_ringing
from scarid_cli.algorithms.estimators import ls
from scarid_cli.algorithms.filters.two_sided import two_sided_bandwidth
from scarid_cli.algorithms.inference.alignment import aligned
from scarid_cli.algorithms.processes.bandwidth import bandwidth_of
from scarid_cli.algorithms.regression.low_pass import LowPass
from scarid_cli.algorithms.regression.rows import Rows, rows_of
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

AXIS = load("emps")
FRICTION = 2  # the index of its Coulomb friction
H = 0.001  # s
BANDWIDTH, ORDER = 8.0, 4  # Hz
CUTOFF = BANDWIDTH / two_sided_bandwidth(ORDER)
LATE = 0.004  # s


def lowpassed(x: Array) -> Array:
    return np.asarray(sosfiltfilt(butter(ORDER, CUTOFF, fs=1.0 / H, output="sos"), x))


def moved(t: Array) -> Array:
    """Position, velocity and acceleration (3, samples) of an axis that reverses often."""
    found = np.zeros((3, len(t)))
    for size, frequency, phase in ((0.08, 0.31, 0.0), (0.05, 0.83, 1.0), (0.01, 1.9, 2.0)):
        w = 2.0 * np.pi * frequency
        found[0] += size * np.sin(w * t + phase)
        found[1] += size * w * np.cos(w * t + phase)
        found[2] -= size * w * w * np.sin(w * t + phase)
    return found


def behind_the_low_pass(sticking: float = 0.0) -> Rows:
    """Rows of the axis, of which motion and torque have passed the same low-pass.

    The torques are those of LATE before. The friction changes its sign over a time `sticking` [s].
    """
    t = np.arange(-1.0, 13.0, H)
    M, Fv, Fs, offset = AXIS.apriori
    _, dq, ddq = moved(t - LATE)
    friction = np.sign(dq)
    if sticking:
        window = np.ones(round(sticking / H))
        friction = np.convolve(friction, window / window.sum(), "same")
    torque = M * ddq + Fv * dq + Fs * friction + offset
    motion = np.array([lowpassed(x) for x in (*moved(t), torque)])[:, None, 1000:-1000]
    rows = rows_of(AXIS, motion, np.arange(motion.shape[2]), H)
    turns = np.flatnonzero(np.diff(np.sign(motion[1, 0])))
    distance = np.min(np.abs(rows.at[:, None] - turns), axis=1)
    scales = rows.scales * (distance > 0.5 / BANDWIDTH / H)[:, None]
    return replace(rows, scales=scales, bandwidth=BANDWIDTH, order=ORDER)


def fitted(rows: Rows) -> tuple[float, Array]:
    """The delay [s], and the estimates."""
    solver = ls.Estimator()
    start = np.zeros(rows.W.shape[2] + 1)
    found = aligned(solver, start, rows, solver.of_rows(rows).fit.estimates, 4)
    return found.delay, found.found.fit.estimates


@given(at=st.integers(300, 700), cutoff=st.floats(0.005, 0.05), order=st.integers(2, 5))
def test_a_jump_behind_the_low_pass_is_that_of_scipy(at: int, cutoff: float, order: int) -> None:
    """Up to the distortion of frequencies by the bilinear transform, tan(x) for x."""
    jump = np.where(np.arange(4000) < 1500 + at, -1.0, 1.0)
    theirs = sosfiltfilt(butter(order, cutoff, fs=1.0, output="sos"), jump)
    distorted = (np.pi * cutoff) ** 2
    np.testing.assert_allclose(LowPass(cutoff, order).over(jump), theirs, atol=distorted + 1e-3)


def test_the_bandwidth_is_that_of_the_differentiator() -> None:
    from scarid_cli.algorithms.differentiators import rts, zero_phase

    method = zero_phase.Differentiator(cutoff=CUTOFF)
    assert method.two_sided_order == ORDER
    assert bandwidth_of(method, H) == pytest.approx(BANDWIDTH, rel=1e-3)
    assert rts.Differentiator(states=3).two_sided_order == 3
    assert rts.Differentiator(damping=1.0).two_sided_order is None


def test_friction_that_jumps_rings_and_biases_the_rest_unless_it_is_fitted() -> None:
    rows = behind_the_low_pass()
    (delay, plain), (mended, beside) = fitted(rows), fitted(with_ringing(rows, AXIS))
    true = AXIS.apriori
    assert abs(delay + LATE) > 2e-5
    assert mended == pytest.approx(-LATE, abs=2e-6)
    assert beside[4] == pytest.approx(true[FRICTION], rel=0.01)
    worst = [np.max(np.abs(x[:4] / true - 1.0)) for x in (plain, beside)]
    assert worst[0] > 0.005
    assert worst[1] < 2e-4


def test_friction_that_changes_slowly_rings_less() -> None:
    """Within rows that count, half a period away: even those of a change over a period."""
    sticking = [0.0, 0.5 / BANDWIDTH, 1.0 / BANDWIDTH]
    found = [fitted(with_ringing(behind_the_low_pass(x), AXIS))[1][4] for x in sticking]
    amounts = np.array(found) / AXIS.apriori[FRICTION]
    assert amounts[0] > 0.98
    assert 0.5 < amounts[1] < 0.9
    assert amounts[2] < 0.2


def columns(rows: Rows, robot: Robot = AXIS) -> int:
    return with_ringing(rows, robot).W.shape[2] - rows.W.shape[2]


def test_nothing_is_added_where_the_low_pass_is_unknown_or_reversals_are_few() -> None:
    rows = behind_the_low_pass()
    assert columns(rows) == 1
    assert columns(replace(rows, order=None)) == 0
    assert columns(replace(rows, bandwidth=None)) == 0
    for hertz in (1e-6, 0.5 / H, 1e9):  # of runs too short for it, and what passes everything
        assert columns(replace(rows, bandwidth=hertz)) == 0
    assert columns(replace(rows, scales=0.0 * rows.scales)) == 0
    near = rows.at < 4 / H / 12 * 3
    assert columns(replace(rows, scales=rows.scales * near[:, None])) == 0


def test_friction_that_never_reverses_does_not_ring() -> None:
    rows = behind_the_low_pass()
    W = rows.W.copy()
    W[:, :, FRICTION] = 0.1
    assert columns(replace(rows, W=W)) == 0


def test_what_lies_beyond_a_gap_does_not_ring() -> None:
    rows = behind_the_low_pass()
    first = rows.at < 6000
    parts = [rows.part(np.flatnonzero(x)) for x in (first, ~first)]
    apart = with_ringing(replace(rows, at=rows.at + 50 * ~first), AXIS)
    each = [with_ringing(part, AXIS).W for part in parts]
    np.testing.assert_array_equal(apart.W, np.concatenate(each))


def test_friction_of_both_directions_rings_once() -> None:
    """At a reversal that of one direction begins where that of the other ends."""
    rows, robot = behind_the_low_pass(), load(str(ROOT / "samples" / "emps-asymmetric.toml"))
    own = rows_of(robot, rows.motion, rows.at, rows.h)
    own = replace(own, scales=rows.scales, bandwidth=rows.bandwidth, order=rows.order)
    assert columns(own, robot) == 1
    ringing = [with_ringing(x, y).W[..., -1] for x, y in ((rows, AXIS), (own, robot))]
    np.testing.assert_allclose(ringing[1], ringing[0], atol=1e-12)
