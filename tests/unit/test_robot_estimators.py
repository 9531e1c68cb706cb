"""Estimators that know the robot: Stribeck friction, instruments, the Kalman filter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.integrate
import scipy.signal
from unit.regressions import estimated
from unit.slow_motions import THETA, P, smooth

from scarid_cli.algorithms.estimators import ekf, iv, separable, wls
from scarid_cli.algorithms.estimators.ekf import forward
from scarid_cli.algorithms.estimators.ls import Estimator as LeastSquares
from scarid_cli.algorithms.regression.decimation import decimated
from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation
from scarid_cli.algorithms.regression.information import NotIdentifiableError
from scarid_cli.algorithms.regression.rows import Rows, plain, rows_of
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

H = 0.005
SCARA = load("scara2")
T = np.arange(8000) * H
RATES = ((1.1, 0.37), (1.7, 0.53))


def exact() -> Array:
    """Position, velocity and acceleration (3, joints, samples) of sines."""
    sines = [
        [np.sin(a * T) + 0.6 * np.sin(b * T + 1.0) for a, b in RATES],
        [a * np.cos(a * T) + 0.6 * b * np.cos(b * T + 1.0) for a, b in RATES],
        [-a * a * np.sin(a * T) - 0.6 * b * b * np.sin(b * T + 1.0) for a, b in RATES],
    ]
    return np.array(sines)


def with_torques(extra: Array, noise: float = 0.02, seed: int = 0) -> Rows:
    """The exact motion with the torques of the SCARA, more friction and noise."""
    motion = exact()
    tau = SCARA.torques(SCARA.regressor(*motion), SCARA.apriori) + extra
    tau = tau + noise * np.random.default_rng(seed).standard_normal(tau.shape)
    return rows_of(SCARA, np.concatenate((motion, tau[None])), np.arange(len(T)), H)


def found(estimator: BaseEstimator, rows: Rows, initial: Array | None = None) -> Estimation:
    return estimated(estimator.for_robot(SCARA), rows, initial)


# Stribeck friction

STRIBECK = {"Fst1": 0.8, "Fst2": 0.2, "vs1": 0.15, "vs2": 0.3}


def stribeck(dq: Array) -> Array:
    peaks, velocities = np.array([[0.8], [0.2]]), np.array([[0.15], [0.3]])
    friction: Array = peaks * np.sign(dq) * np.exp(-((dq / velocities) ** 2))
    return friction


def test_separable_recovers_a_stribeck_curve_and_halves_the_error_of_linear_friction() -> None:
    rows = with_torques(stribeck(exact()[1]))
    estimation = found(separable.Estimator(), rows)
    fit = estimation.fit
    assert estimation.scores is not None
    own = estimation.scores.rows
    assert own is not None
    truth = np.concatenate((SCARA.apriori, list(STRIBECK.values())))
    assert [name for name, _ in estimation.added] == list(STRIBECK)
    errors = fit.standard_errors()
    assert np.all(np.abs(fit.estimates - truth) < 4.0 * errors)
    np.testing.assert_allclose(fit.estimates[8:], truth[8:], rtol=0.03)
    linear = found(LeastSquares(), rows).fit
    residuals = [rows.y - rows.W @ linear.estimates, own.y - own.W @ fit.estimates]
    linear_error, own_error = (np.sqrt((r**2).mean(axis=0)) for r in residuals)
    assert np.all(own_error < 0.5 * linear_error)
    np.testing.assert_allclose(own_error, 0.02, rtol=0.02)


def test_the_robot_with_stribeck_friction_predicts_what_was_fitted() -> None:
    rows = with_torques(stribeck(exact()[1]), noise=0.0)
    robot = SCARA.with_stribeck({1: 0.15, 2: 0.3})
    theta = np.concatenate((SCARA.apriori, [0.8, 0.2]))
    q, dq, ddq, tau = rows.motion
    np.testing.assert_allclose(robot.torques(robot.regressor(q, dq, ddq), theta), tau, atol=1e-12)


def test_separable_without_dry_friction_is_refused() -> None:
    smooth = replace(SCARA, parameters=SCARA.parameters[:1])
    with pytest.raises(UsageFault, match="no joint with Coulomb friction"):
        separable.Estimator().for_robot(smooth)


# Instruments


def test_instruments_are_not_attenuated_and_the_hausman_test_rejects() -> None:
    """With noise in the regressor but none in the instruments, only least squares is biased."""
    rng = np.random.default_rng(4)
    W = smooth(8000, P, rng)[:, None, :]
    y = W @ THETA + rng.standard_normal((8000, 1))
    spoilt = plain(W + rng.standard_normal(W.shape) * W.std(), y, H)
    least = estimated(wls.Estimator(), spoilt)
    instrumental = iv.solved(spoilt, W, least)
    off = np.abs(instrumental.fit.estimates - THETA)
    assert np.all(off < 5.0 * instrumental.fit.standard_errors())
    assert np.abs(least.fit.estimates - THETA).max() > 0.5
    assert iv.hausman(spoilt, least, instrumental)[1] < 1e-6
    clean = plain(W, y, H)
    right = estimated(wls.Estimator(), clean)
    other = iv.solved(clean, W + rng.standard_normal(W.shape) * W.std(), right)
    assert iv.hausman(clean, right, other)[1] > 0.01


def test_parameters_without_an_instrument_are_named() -> None:
    """Two of them here; the others have instruments, and are not named."""
    rng = np.random.default_rng(4)
    W = smooth(500, P, rng)[:, None, :]
    rows = plain(W, W @ THETA + 0.1 * rng.standard_normal((500, 1)), H)
    instruments = W.copy()
    instruments[:, :, [0, 2]] = 0.0
    with pytest.raises(NotIdentifiableError) as error:
        iv.solved(rows, instruments, estimated(wls.Estimator(), rows))
    assert np.flatnonzero(error.value.direction).tolist() == [0, 2]


def test_iv_without_a_reference_is_refused() -> None:
    solver = iv.Estimator().for_robot(SCARA)
    with pytest.raises(UsageFault, match="q1_ref"):
        solver.step(solver.init(np.zeros(8)), with_torques(np.zeros((2, len(T)))))


def test_iv_of_estimates_that_no_robot_can_have_is_refused() -> None:
    """With opposite torques least squares estimates negative inertias."""
    motion = exact()
    tau = -SCARA.torques(SCARA.regressor(*motion), SCARA.apriori)
    rows = rows_of(
        SCARA, np.concatenate((motion, tau[None])), np.arange(8000), H, reference=motion[:2]
    )
    solver = iv.Estimator().for_robot(SCARA)
    with pytest.raises(UsageFault, match="not positive definite"):
        solver.fit(solver.step(solver.init(np.zeros(8)), rows)[0])


# Kalman filter


def test_the_forward_model_is_the_plant_s() -> None:
    """Accelerations from the regressor against the closed form of the two-link arm."""
    rng = np.random.default_rng(0)
    q, dq, tau = rng.standard_normal((3, 2, 50))
    names = ("ZZ1R", "ZZ2", "L1MX2", "L1MY2", "Fv1", "Fv2", "Fs1", "Fs2")
    value = dict(zip(SCARA.names, SCARA.apriori, strict=True))
    zz1r, zz2, mx, my, fv1, fv2, fs1, fs2 = (value[name] for name in names)
    c, s = np.cos(q[1]), np.sin(q[1])
    m12 = zz2 + mx * c - my * s
    m11 = zz1r + zz2 + 2.0 * (mx * c - my * s)
    h = mx * s + my * c
    rest1 = -h * dq[1] * (2.0 * dq[0] + dq[1]) + fv1 * dq[0] + fs1 * np.sign(dq[0])
    rest2 = h * dq[0] ** 2 + fv2 * dq[1] + fs2 * np.sign(dq[1])
    b1, b2 = tau[0, 0] - rest1, tau[1, 0] - rest2
    determinant = m11 * zz2 - m12**2
    expected = [(zz2 * b1 - m12 * b2) / determinant, (m11 * b2 - m12 * b1) / determinant]
    accelerations = forward(SCARA, q, dq, tau[:, 0], SCARA.apriori)
    np.testing.assert_allclose(accelerations, expected, rtol=1e-9)


def test_the_kalman_filter_predicts_the_motion_over_a_period() -> None:
    """The differential equation with constant torques, solved by scipy; its third order is left."""
    robot, h = SCARA.smoothed(0.05), 1e-3
    q, dq, tau = np.array([[0.3, -0.7], [0.8, -1.1], [40.0, -3.0]])

    def moved(_: float, x: Array) -> Array:
        ddq = forward(robot, x[:2, None], x[2:, None], tau, SCARA.apriori)[:, 0]
        return np.concatenate((x[2:], ddq))

    x = np.concatenate((q, dq))
    expected = scipy.integrate.solve_ivp(moved, (0.0, h), x, rtol=1e-10, atol=1e-14).y[:, -1]
    solver = ekf.Estimator().for_robot(SCARA)
    state = np.concatenate((x, SCARA.apriori))
    found, _ = solver._predicted(state, np.eye(len(state)), tau, h)
    turn = h * np.concatenate((dq, np.zeros(2)))
    np.testing.assert_allclose(found[:4] - x - turn, expected - x - turn, rtol=0.1)


def test_the_kalman_filter_comes_from_wrong_parameters_to_the_true_ones() -> None:
    """Friction of the filter's own, smooth kind; positions are exact, torques noisy."""
    smooth = SCARA.smoothed(0.05)
    motion = exact()[:, :, :4000]
    tau = smooth.torques(smooth.regressor(*motion), SCARA.apriori)
    tau = tau + 0.02 * np.random.default_rng(0).standard_normal(tau.shape)
    rows = rows_of(SCARA, np.concatenate((motion, tau[None])), np.arange(4000), H)
    start = SCARA.apriori * 1.3
    fit = found(ekf.Estimator(acceleration_noise=0.2), rows, start).fit
    inertias = [SCARA.names.index(name) for name in ("ZZ1R", "ZZ2", "L1MX2")]
    np.testing.assert_allclose(fit.estimates[inertias], SCARA.apriori[inertias], rtol=0.03)


def test_the_kalman_filter_needs_initial_parameters() -> None:
    with pytest.raises(UsageFault, match="--initial"):
        ekf.Estimator().for_robot(SCARA).init(np.zeros(8))


# Decimation


def test_decimation_is_that_of_scipy() -> None:
    """Where both keep the same samples; its padding differs, so the ends do."""
    x = np.random.default_rng(0).standard_normal(2001).cumsum()
    rows = decimated(plain(x[:, None, None], x[:, None]), 10)
    expected = scipy.signal.decimate(x, 10, n=8, ftype="iir", zero_phase=True)
    np.testing.assert_allclose(rows.W[80:-80, 0, 0], expected[80:-80], rtol=1e-6)
    np.testing.assert_array_equal(rows.W[:, 0, 0], rows.y[:, 0])


@pytest.mark.parametrize("samples", [200, 201, 207])
def test_decimation_keeps_the_last_sample(samples: int) -> None:
    rows = decimated(plain(np.ones((samples, 1, 1)), np.ones((samples, 1))), 10)
    kept = np.arange(samples)[(samples - 1) % 10 :: 10]
    assert kept[-1] == samples - 1
    assert rows.at.tolist() == (kept // 10).tolist()
