"""The signals of a simulated robot with imperfections, beside what these are defined to be."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from stages.simulated import LOG_LEVEL, QUIET, log, signals


def test_imperfections_of_the_log_leave_the_truth_alone() -> None:
    clean, found = log(), log(values=LOG_LEVEL)
    for name in (column for column in clean if column.endswith("_true")):
        np.testing.assert_array_equal(found[name], clean[name])
    assert all((found[name] != clean[name]).any() for name in ("t", "q1", "q2", "tau1", "tau2"))


@pytest.mark.parametrize("name", ["q{i}", "tau{i}"])
@pytest.mark.parametrize("periods", [1, 4, 7])
def test_a_delay_of_whole_periods_shifts_the_signal_with_all_its_noise(
    name: str, periods: int
) -> None:
    delay = "position-delay" if name == "q{i}" else "torque-delay"
    early = {"coloured-torque-noise": [0.5], "torque-noise-time": [0.05], "position-noise": [1e-4]}
    clean = signals(log(1000.0, early), name)
    found = signals(log(1000.0, {**early, delay: [periods * 1e-3]}), name)
    np.testing.assert_array_equal(found[:, periods:], clean[:, :-periods])
    np.testing.assert_array_equal(found[:, :periods], clean[:, [0] * periods])


@pytest.mark.parametrize("part", [0.25, 0.6])
@pytest.mark.parametrize("i", [1, 2])
def test_a_delay_of_part_of_a_period_interpolates_the_position(part: float, i: int) -> None:
    """Beside scipy's cubic Hermite splines through the true positions and velocities.

    Where either joint stops, starts or turns within a period, Coulomb friction jumps, and neither
    polynomial is exact.
    """
    truth = log(1000.0, QUIET)
    spline = CubicHermiteSpline(truth["t"], truth[f"q{i}_true"], truth[f"dq{i}_true"])
    found = log(values={**QUIET, "position-delay": [(3.0 + part) * 1e-3]})
    then = found["t"][1:] - (3.0 + part) * 1e-3
    at = (then * 1000.0).astype(int)
    dq = signals(truth, "dq{i}_true")
    turns = (dq[:, at] * dq[:, at + 1] <= 0.0).any(axis=0)
    off = np.abs(found[f"q{i}"][1:] - spline(then))
    assert off[~turns].max() < 1e-9
    assert off.max() < 1e-7
    assert turns.mean() < 0.1


def test_a_delay_of_part_of_a_period_takes_the_torque_of_the_period_before() -> None:
    truth = signals(log(1000.0, QUIET), "tau{i}_true")
    found = signals(log(1000.0, {**QUIET, "torque-delay": [0.0024, 0.0]}), "tau{i}")
    np.testing.assert_array_equal(found[0, 3:], truth[0, :-3])
    np.testing.assert_array_equal(found[1], truth[1])


def test_a_slower_sensor_is_held() -> None:
    quick, slow = log(1000.0), log(1000.0, {"torque-rate": [40.0], "position-rate": [100.0, 0.0]})
    ticks = np.arange(len(quick["t"]))
    np.testing.assert_array_equal(
        signals(slow, "tau{i}"), signals(quick, "tau{i}")[:, ticks // 25 * 25]
    )
    np.testing.assert_array_equal(slow["q1"], quick["q1"][ticks // 10 * 10])
    np.testing.assert_array_equal(slow["q2"], quick["q2"])


def test_motor_constant_offset_and_resolution_of_the_torque() -> None:
    found = log(values={**QUIET, "torque-constant-error": [0.05, -0.1], "torque-offset": [0.3, 0]})
    truth = signals(found, "tau{i}_true")
    expected = truth * np.array([[1.05], [0.9]]) + np.array([[0.3], [0.0]])
    np.testing.assert_allclose(signals(found, "tau{i}"), expected, rtol=1e-14)
    steps = signals(log(values={"torque-resolution": [0.25]}), "tau{i}") / 0.25
    np.testing.assert_array_equal(steps, np.round(steps))


def test_the_controller_feels_an_eccentric_encoder() -> None:
    """It brings the reading to the reference, so the joint is off by the eccentricity."""
    clean = log(values=QUIET)
    values = {
        "encoder-eccentricity": [1e-3, 2e-3],
        "encoder-turns": [1, 50],
        "encoder-phase": [0.4],
    }
    found = log(values={**QUIET, **values})
    q = signals(found, "q{i}_true")
    expected = q + np.array([[1e-3], [2e-3]]) * np.sin(np.array([[1], [50]]) * q + 0.4)
    np.testing.assert_allclose(signals(found, "q{i}"), expected, rtol=0.0, atol=1e-15)
    moved = q - signals(clean, "q{i}_true")
    assert np.abs(moved[0, 100:] + 1e-3 * np.sin(q[0, 100:] + 0.4)).max() < 2e-4


def test_the_controller_feels_coloured_noise_of_the_position() -> None:
    values = {**QUIET, "coloured-position-noise": [1e-3], "position-noise-time": [0.1]}
    found, clean = log(values=values), log(values=QUIET)
    assert np.abs(found["q1_true"] - clean["q1_true"]).max() > 1e-4


def test_encoder_bits_are_those_of_each_joint() -> None:
    found = log(values={"encoder-bits": [12, 0]})
    counts = found["q1"] * 2**12 / (2.0 * np.pi)
    np.testing.assert_allclose(counts, np.round(counts), rtol=0.0, atol=1e-9)
    np.testing.assert_array_equal(found["q2"], found["q2_true"])


def test_sampling_jitter_is_true_to_its_stamps_and_the_others_are_not() -> None:
    truth = log(1000.0, QUIET)
    spline = CubicHermiteSpline(truth["t"], truth["q1_true"], truth["dq1_true"])
    nominal = log()["t"]
    inner = slice(1, -1)  # the signals are held at the ends of the record
    for name in ("sampling-jitter", "stamp-jitter", "hidden-jitter"):
        found = log(values={**QUIET, name: [3e-4]})
        sampled = found["t_true"]
        np.testing.assert_allclose(found["q1"][inner], spline(sampled)[inner], rtol=0.0, atol=1e-9)
        np.testing.assert_array_equal(found["q1"], found["q1_true"])
        assert (found["t"] != nominal).all() == (name != "hidden-jitter")
        assert (sampled != nominal).all() == (name != "stamp-jitter")
        assert (found["t"] != sampled).all() == (name != "sampling-jitter")
        error = np.concatenate((found["t"] - nominal, sampled - nominal))
        assert error[error != 0.0].std() == pytest.approx(3e-4, rel=0.12)


def test_velocity_and_acceleration_between_ticks_are_those_of_the_motion() -> None:
    found = log(values={**QUIET, "sampling-jitter": [3e-4]})
    truth = log(1000.0, QUIET)
    spline = CubicHermiteSpline(truth["t"], truth["q1_true"], truth["dq1_true"])
    inner = slice(1, -1)
    t = found["t_true"][inner]
    np.testing.assert_allclose(found["dq1_true"][inner], spline(t, 1), rtol=0.0, atol=1e-5)
    at = np.floor(t * 1000.0 + 1e-6).astype(int)
    np.testing.assert_allclose(found["ddq1_true"][inner], truth["ddq1_true"][at], atol=0.1)


def test_lost_rows_are_missing_and_the_others_are_as_before() -> None:
    clean, found = log(), log(values={"lost-rows": [0.2]})
    kept = np.isin(clean["t"], found["t"])
    assert 0.1 < 1.0 - kept.mean() < 0.3
    for name, column in clean.items():
        np.testing.assert_array_equal(found[name], column[kept])


def test_repeated_rows_have_their_own_time_and_truth() -> None:
    clean, found = log(), log(values={"repeated-rows": [0.3]})
    held = np.zeros(len(clean["t"]), dtype=int)
    for row in range(1, len(held)):
        held[row] = held[row - 1] if found["q1_ref"][row] != clean["q1_ref"][row] else row
    assert 0.2 < np.mean(held != np.arange(len(held))) < 0.4
    for name, column in clean.items():
        own = name == "t" or name.endswith("_true")
        np.testing.assert_array_equal(found[name], column if own else column[held])


def test_standstill_holds_the_robot_at_both_ends() -> None:
    clean, found = log(), log(values={"standstill-before": [0.5], "standstill-after": [6.0]})
    assert found["t"][0] == clean["t"][0]
    np.testing.assert_allclose(np.diff(found["t"]), 0.005)
    assert len(found["t"]) == len(clean["t"]) + 100 + 1200
    shifted = signals(found, "q{i}_ref")
    np.testing.assert_array_equal(shifted[:, 100:501], signals(clean, "q{i}_ref"))
    np.testing.assert_array_equal(shifted[:, :100], shifted[:, [100] * 100])
    np.testing.assert_array_equal(shifted[:, 501:], shifted[:, [500] * 1200])
    assert not signals(found, "dq{i}_ref")[:, [0, 99, 501, -1]].any()
    assert np.abs(signals(found, "dq{i}_true")[:, -1]).max() < 1e-6


def test_a_late_encoder_on_a_flexible_joint_reads_the_motor() -> None:
    values = {**QUIET, "flexibility": [15.0]}
    truth = log(1000.0, values)
    found = log(values={**values, "position-delay": [0.0034]})
    for i in (1, 2):
        motor = (truth[f"{name}{i}_motor_true"] for name in ("q", "dq"))
        expected = CubicHermiteSpline(truth["t"], *motor)(found["t"][1:] - 0.0034)
        np.testing.assert_allclose(found[f"q{i}"][1:], expected, rtol=0.0, atol=1e-12)
        assert np.abs(found[f"q{i}_motor_true"] - found[f"q{i}_true"]).max() > 1e-4


def test_true_torque_of_a_slow_drive_between_ticks_is_interpolated() -> None:
    values = {**QUIET, "drive-bandwidth": [30.0]}
    truth = log(1000.0, values)
    found = log(values={**values, "hidden-jitter": [3e-4]})
    expected = np.interp(found["t_true"], truth["t"], truth["tau1_true"])
    np.testing.assert_allclose(found["tau1_true"], expected, rtol=1e-9)
    assert (found["tau1"] != found["tau1_true"]).any()
