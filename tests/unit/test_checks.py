"""The checks of a log on logs that no robot has made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from stages.tables import collected, table

from scarid_cli.algorithms.checks import clock, jumps, scale, values
from scarid_cli.algorithms.checks.clock import GAP
from scarid_cli.algorithms.checks.finding import FAILED, OK, STATUSES, WARNING, worst
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.checks.model import solved
from scarid_cli.algorithms.checks.motion import Motion
from scarid_cli.algorithms.checks.movement import repeated_after
from scarid_cli.algorithms.processes.holding import held_in
from scarid_cli.algorithms.processes.resampling import Clock
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.tuning.spectrum import bandwidth
from scarid_cli.stages.check import check
from scarid_cli.stages.resample import resample

SCARA = load("scara2")


def log_of(kind: str, rows: int, seed: int) -> Log:
    """Positions and torques that are constant, noise, sums of sines, or a mixture with nan."""
    rng = np.random.default_rng(seed)
    t = 0.01 * np.arange(rows)
    shape = (4, rows)
    signals = {
        "constant": np.full(shape, rng.standard_normal()),
        "noise": rng.standard_normal(shape),
        "steps": np.round(rng.standard_normal(shape)),
        "sines": np.sin(rng.uniform(0.5, 20.0, (4, 1)) * t),
        "holes": np.where(rng.random(shape) < 0.3, np.nan, np.sin(t)),
        "empty": np.full(shape, np.nan),
    }[kind]
    return Log(t, signals[:2], signals[2:])


@settings(max_examples=60)
@given(
    kind=st.sampled_from(["constant", "noise", "steps", "sines", "holes", "empty"]),
    rows=st.integers(0, 700),
    seed=st.integers(0, 1000),
    time=st.sampled_from([1.0, 0.0, -1.0, 1e3, 1e-6]),
)
def test_any_log_has_findings_with_advice_where_something_is_wrong(
    kind: str, rows: int, seed: int, time: float
) -> None:
    """No warning of numpy, which would be an error here, and no exception.

    None of these is a robot, but a few sines of positions and torques may look like one.
    """
    log = log_of(kind, rows, seed)
    found = list(check(replace(log, t=time * log.t), SCARA))
    assert kind == "sines" or worst(found) == FAILED
    assert all(f.status in STATUSES and bool(f.advice) == (f.status != "ok") for f in found)
    assert all("nan" not in f.figure for f in found)


@pytest.mark.parametrize(
    ("rate", "status", "advice"),
    [
        (0.2, FAILED, "the time seems to be in ms: `scarid convert --unit t=ms`"),
        (4.0, FAILED, "the time seems to be in ms: `scarid convert --unit t=ms`"),
        (10.0, WARNING, "record at 100 Hz or more"),
        (20.0, OK, ""),
        (1e6, FAILED, "the time seems to be in hours: `scarid convert --unit 't=3600 s'`"),
        (
            8.64e6,
            FAILED,
            "the time seems to be in days, as Excel counts them: "
            "`scarid convert --unit 't=86400 s'`",
        ),
        (1e13, FAILED, "the time is not in seconds: convert the unit of t"),
    ],
)
def test_a_rate_may_be_that_of_a_slow_log_or_of_a_time_in_another_unit(
    rate: float, status: str, advice: str
) -> None:
    """A robot's log of 1 to 10 Hz with the time in ms would have 1 to 10 kHz."""
    factors = {"ms": 1e-3, "hours": 3600.0, "days": 86400.0}
    finding, factor = clock.unit(clock.Clock.of(np.arange(100) / rate))
    assert (finding.status, finding.advice) == (status, advice)
    assert factor == next((x for unit, x in factors.items() if f"in {unit}" in advice), 1.0)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_limits_of_zero_are_unknown_ones(scale: float) -> None:
    joints = tuple(replace(j, velocity_limit=0.0, torque_limit=0.0) for j in SCARA.joints)
    log = log_of("sines", 600, 1)
    found = {f.name: f for f in check(log.scaled(q=scale), replace(SCARA, joints=joints))}
    assert "positions" in found


@pytest.mark.parametrize("lost", [0.0, 0.02])
def test_the_steps_of_an_encoder_that_is_read_often_are_no_motion(lost: float) -> None:
    """Those of 11 bits at 1 kHz, also where lost rows have been interpolated."""
    t, step = 1e-3 * np.arange(20000), 2.0 * np.pi / 2**11
    kept = np.random.default_rng(4).random(len(t)) >= lost
    readings = step * np.round(0.8 * np.sin(2.0 * np.pi * 0.3 * t) / step)
    x = np.interp(t, t[kept], readings[kept])
    assert bandwidth(x, 1e-3, 1) == pytest.approx(0.3, abs=0.1)


@given(frequency=st.floats(0.5, 8.0), rows=st.integers(2000, 6000))
@example(frequency=0.8, rows=4064)  # two equal rows at every peak
def test_the_bandwidth_of_a_sine_is_its_frequency(frequency: float, rows: int) -> None:
    x = np.sin(2.0 * np.pi * frequency * 0.005 * np.arange(rows))
    resolution = 1.0 / (0.005 * rows)
    assert bandwidth(x, 0.005, 1) == pytest.approx(frequency, abs=3.0 * resolution)


@pytest.mark.parametrize("frequency", [0.1, 0.5])
def test_the_bandwidth_of_a_motion_is_not_that_of_the_steps_of_its_encoder(
    frequency: float,
) -> None:
    """11 bits, read at 1 kHz: a hundred steps per second or more."""
    step = 2.0 * np.pi / 2048
    x = step * np.round(np.sin(2.0 * np.pi * frequency * 0.001 * np.arange(20_000)) / step)
    assert bandwidth(x, 0.001, 1) == pytest.approx(frequency, abs=0.15)


@pytest.mark.parametrize(("periods", "segments"), [(GAP, 1), (GAP + 0.25, 2)])
def test_a_motion_is_split_at_intervals_beyond_the_longest_one(
    periods: float, segments: int
) -> None:
    """Times are exact in binary, and so is their difference."""
    t = 0.25 * np.arange(200.0)
    t[100:] += 0.25 * (periods - 1.0)
    found = Motion.of(Log(t, np.sin([t]), np.cos([t])), 0.25)
    assert found
    assert len(found.segments) == segments


@pytest.mark.parametrize("rows", [-3, 0, 3])
def test_a_delayed_motion_has_the_torques_of_later_rows(rows: int) -> None:
    k = np.arange(100.0)
    found = Motion.of(Log(0.01 * k, np.sin([k]), np.array([k])), 0.01)
    assert found
    (before,), (after,) = found.segments, found.delayed(rows).segments
    positions = dict(zip(before.q[0], before.tau[0], strict=True))
    assert after.q.shape == after.tau.shape == (1, 100 - abs(rows))
    assert [positions[q] + rows for q in after.q[0]] == after.tau[0].tolist()


@pytest.mark.parametrize("period", [150, 400])
def test_a_motion_that_repeats_has_its_period(period: int) -> None:
    rng = np.random.default_rng(5)
    one = np.cumsum(rng.standard_normal((2, period)), axis=1)
    one -= np.linspace(one[:, 0], one[:, -1], period).T
    assert repeated_after(np.tile(one, 4)) == period
    assert repeated_after(np.cumsum(rng.standard_normal((2, 4 * period)), axis=1)) == 0


def test_a_sine_and_noise_are_not_clipped_and_a_limited_one_is() -> None:
    rng = np.random.default_rng(6)
    x = np.sin(0.01 * np.arange(5000))
    for clean in (x, np.round(200 * x), x + 0.01 * rng.standard_normal(5000)):
        assert values.clipped(clean) == 0
    limited = np.clip(x, -0.9, np.inf)
    assert values.clipped(limited) == np.count_nonzero(x <= -0.9)


def test_a_log_is_checked_for_held_samples_by_the_rule_of_resample() -> None:
    """The rows that `resample` leaves out, and no others: not the rest of a robot."""
    t, x = 0.01 * np.arange(1000.0), np.sin(0.05 * np.arange(1000.0))
    x[100:104] = x[100]
    x[500:600] = x[500]  # a second at rest
    log = Log(t, x[None, :], np.cos(x)[None, :])
    held, period = log.held
    assert np.flatnonzero(held).tolist() == [101, 102, 103]
    assert period == pytest.approx(0.01)
    clocks: list[Clock] = []
    collected(resample(table({"t": t, "q1": x, "tau1": np.cos(x)}), 100.0, report=clocks.append))
    assert clocks[0].held == 3


def test_sensors_without_noise_at_rest_are_no_slower_sensors() -> None:
    """Their values change by one step of resolution now and then, some of them together."""
    rng = np.random.default_rng(3)
    t = 0.005 * np.arange(4000.0)
    moving = np.maximum(t - 10.0, 0.0)
    q, tau = (np.array([f(moving), f(3.0 * moving)]) for f in (np.sin, np.cos))
    noise = 0.3 * rng.standard_normal((4, len(t)))
    q, tau = (1e-4 * np.round(1e4 * x + n) for x, n in ((q, noise[:2]), (tau, noise[2:])))
    rest = Log(t, q, tau)
    assert np.mean(rest.held[0]) > clock.HELD
    assert clock.held(rest).status == "ok"
    read = 10 * (np.arange(len(t)) // 10)  # every tenth row
    assert clock.held(Log(t, q[:, read], tau[:, read])).status == "warning"


@pytest.mark.parametrize("joints", [1, 5])
def test_encoders_that_step_one_after_another_are_not_held(joints: int) -> None:
    """Neither here nor in `resample`: fewer than half of the values change at the end of a run."""
    t = np.arange(4000) * 1e-3
    q = np.array([np.floor(t / 0.005 + i / 5.0) * 1e-4 for i in range(joints)])
    held, _ = held_in(t, q)
    assert not held.any()


def test_errors_of_a_first_fit_are_those_of_leaving_out_parts() -> None:
    """Of a log without a scale of its own: the weights of the joints stay as they are."""
    rng = np.random.default_rng(5)
    W, tau = rng.standard_normal((200, 2, 3)), rng.standard_normal((2, 200))
    found = solved(W, tau, np.ones((2, 200), dtype=bool))
    A, y = found.stacked, (found.weights * tau).ravel()
    part = np.tile(np.repeat(np.arange(10), 20), 2)
    without = [np.linalg.lstsq(A[part != k], y[part != k])[0] for k in range(10)]
    expected = np.sqrt(0.9 * np.sum((np.array(without) - found.theta) ** 2, axis=0))
    assert found.scatter(2) == pytest.approx(expected, rel=1e-6)


def swept(rows: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Times and the positions (2, rows) of a smooth motion, from an encoder."""
    rng = np.random.default_rng(seed)
    t = 0.005 * np.arange(rows)
    frequencies, phases = rng.uniform(0.1, 1.0, (2, 4, 1)), rng.uniform(0.0, 6.0, (2, 4, 1))
    q = np.sum(rng.uniform(0.2, 0.5, (2, 4, 1)) * np.sin(6.28 * frequencies * t + phases), axis=1)
    return t, np.round(q, 4)


@given(st.integers(100, 1000), st.integers(0, 1 << 16))
def test_a_smooth_motion_does_not_jump(rows: int, seed: int) -> None:
    t, q = swept(rows, seed)
    assert jumps.jumped(Log(t, q, np.zeros_like(q))) == []


@given(st.integers(20, 80), st.integers(10, 200), st.integers(0, 1 << 16))
def test_readings_that_were_lost_for_a_while_are_told(start: int, count: int, seed: int) -> None:
    t, q = swept(400, seed)
    q[1] += 5.0  # so that 0 is none of its positions
    q[1, start : start + count] = 0.0
    found = jumps.jumped(Log(t, q, np.zeros_like(q)))
    assert found == [jumps.Jump(1, start, start + count, 0.0)]
    (text,) = jumps.told(found, 2, 400)
    assert text == f"q2 is 0 in rows {start + 1} to {start + count}"
    mended = jumps.without(Log(t, q, np.zeros_like(q)), found)
    assert np.isnan(mended.q[1]).sum() == count


@given(st.integers(50, 350), st.integers(0, 1 << 16))
def test_two_logs_one_after_the_other_are_told_apart(start: int, seed: int) -> None:
    t, q = swept(400, seed)
    q[:, start:] += np.array([[3.0], [-4.0]])
    found = jumps.jumped(Log(t, q, np.zeros_like(q)))
    assert found == [jumps.Jump(j, start) for j in (0, 1)]
    told = jumps.told(found, 2, 400)
    assert list(told) == [f"all positions jump before row {start + 1}"]
    assert f"--rows 1:{start} and --rows {start + 1}:400" in "".join(told.values())


@pytest.mark.parametrize(
    ("factors", "unit"),
    [
        ([0.01, 0.011, 0.009], True),  # of the largest torque, say
        ([1e3, 1.1e3, 900.0], True),
        ([1.0, 1.1, 0.28], False),  # a load on the other side of an axis
        ([6.0, 5.0, 20.0], False),  # heavier than the arm
        ([1.0, 1.0, 1.0], False),
    ],
)
def test_a_load_is_no_unit(factors: list[float], *, unit: bool) -> None:
    """Of a loaded robot, all torques are in another unit or none is said to be."""
    found = scale.Scale(np.array(factors), 0.01 * np.array(factors), np.array([3.0, 2.0, 1.0]))
    assert found.of_a_unit == unit
