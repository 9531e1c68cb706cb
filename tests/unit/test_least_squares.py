"""Streaming least squares against numpy.linalg, and what it says where data say too little."""

from __future__ import annotations

import numpy as np
import pytest
from unit.regressions import THETA, P, data, fitted

from scarid_cli.algorithms.estimators import ls
from scarid_cli.algorithms.regression.information import NotIdentifiableError
from scarid_cli.algorithms.regression.rows import plain
from scarid_cli.arrays import Array


@pytest.mark.parametrize(("samples", "joints"), [(2, 2), (50, 1), (500, 3)])
def test_ls_agrees_with_lstsq(samples: int, joints: int) -> None:
    """Estimates, residual variance, covariance s^2 (W'W)^-1 and condition number."""
    W, y = data(samples, joints)
    fit = fitted(ls.Estimator(), W, y)
    flat = W.reshape(-1, P)
    expected, _, _, singular = np.linalg.lstsq(flat, y.ravel())
    np.testing.assert_allclose(fit.estimates, expected, rtol=1e-11)
    np.testing.assert_allclose(fit.unit_covariance, np.linalg.inv(flat.T @ flat), rtol=1e-8)
    assert fit.condition == pytest.approx(singular[0] / singular[-1], rel=1e-11)
    freedom = samples * joints - P
    if freedom == 0:
        assert np.isnan(fit.variance)
        return
    residual = y.ravel() - flat @ expected
    assert fit.variance == pytest.approx(residual @ residual / freedom, rel=1e-11)
    errors = np.sqrt(fit.variance * np.diag(np.linalg.inv(flat.T @ flat)))
    np.testing.assert_allclose(fit.standard_errors(), errors, rtol=1e-9)
    unit = fit.standard_errors("unit")
    np.testing.assert_allclose(unit, errors / np.sqrt(fit.variance), rtol=1e-9)


def test_ls_keeps_the_digits_that_normal_equations_lose() -> None:
    """At a condition number of 1e7: eps times it is 2e-9, eps times its square is 2 %."""
    rng = np.random.default_rng(0)
    left, right = (np.linalg.qr(rng.standard_normal(shape))[0] for shape in ((2000, P), (P, P)))
    W = left * np.logspace(0, -7, P) @ right.T
    y = W @ THETA
    fit = fitted(ls.Estimator(), W[:, None, :], y[:, None])
    normal = np.linalg.solve(W.T @ W, W.T @ y)
    assert fit.condition == pytest.approx(1e7, rel=1e-7)
    np.testing.assert_allclose(fit.estimates, THETA, rtol=1e-7)
    assert np.abs(normal / THETA - 1.0).max() > 1e-5, "not a test: normal equations do as well"


def test_ls_cares_for_no_prior() -> None:
    W, y = data(50)
    far = fitted(ls.Estimator(), W, y, prior=1e6 * np.ones(P))
    np.testing.assert_array_equal(far.estimates, fitted(ls.Estimator(), W, y).estimates)


# Identifiability


@pytest.mark.parametrize("samples", [20, 1000, 100_000])
@pytest.mark.parametrize("seed", range(5))
def test_direction_that_the_data_leave_free_is_named(samples: int, seed: int) -> None:
    """Column 3 is 2 times column 0 less column 1: theta may move along (2, -1, 0, -1)."""
    W, _ = data(samples, seed=seed)
    W[:, :, 3] = 2.0 * W[:, :, 0] - W[:, :, 1]
    with pytest.raises(NotIdentifiableError) as refused:
        fitted(ls.Estimator(), W, W @ THETA)
    direction = refused.value.direction
    expected = np.array([2.0, -1.0, 0.0, -1.0]) / np.sqrt(6.0)
    np.testing.assert_allclose(direction * np.sign(direction[0]), expected, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("W", "direction"),
    [
        (np.zeros((10, 1, 2)), None),
        (np.ones((1, 1, 2)), [1.0, -1.0]),
        (np.tile([1.0, 0.0], (10, 1, 1)), [0.0, 1.0]),
    ],
    ids=["no motion", "too few rows", "a parameter without effect"],
)
def test_data_that_say_too_little_are_not_solved(W: Array, direction: list[float] | None) -> None:
    with pytest.raises(NotIdentifiableError) as refused:
        fitted(ls.Estimator(), W, np.ones(W.shape[:2]))
    assert np.linalg.norm(refused.value.direction) == pytest.approx(1.0)
    if direction is not None:
        free = np.array(direction) / np.linalg.norm(direction)
        assert abs(free @ refused.value.direction) == pytest.approx(1.0)


@pytest.mark.parametrize("unit", [1e-18, 1e12])
def test_units_of_a_parameter_do_not_matter(unit: float) -> None:
    """Neither for what is identifiable, nor for the estimates."""
    W, y = data(500)
    scale = np.array([1.0, unit, 1.0, 1.0])
    scaled, plain = fitted(ls.Estimator(), W * scale, y), fitted(ls.Estimator(), W, y)
    np.testing.assert_allclose(scaled.estimates * scale, plain.estimates, rtol=1e-11)
    errors = scaled.standard_errors() * scale
    np.testing.assert_allclose(errors, plain.standard_errors(), rtol=1e-11)


@pytest.mark.parametrize("tiny", [1e-100, 1e-170, 1e-310])
def test_tiny_regressor_does_no_harm(tiny: float) -> None:
    """What a filter leaves of a velocity at standstill: its square underflows to nothing."""
    W, y = data(50)
    W[0] = tiny
    y[0] = 0.0
    found, expected = fitted(ls.Estimator(), W, y), fitted(ls.Estimator(), W[1:], y[1:])
    np.testing.assert_allclose(found.estimates, expected.estimates, rtol=1e-12)


def conditioned(samples: int = 100) -> Array:
    """A regressor of two joints with condition number 1e7."""
    rng = np.random.default_rng(3)
    U, V = (np.linalg.qr(rng.standard_normal(s))[0] for s in ((2 * samples, P), (P, P)))
    return np.reshape(U * np.geomspace(1.0, 1e-7, P) @ V.T, (samples, 2, P))


def test_badly_conditioned_statistics_agree_with_the_singular_values() -> None:
    W = conditioned()
    y = W @ THETA + 0.1 * np.random.default_rng(4).standard_normal(W.shape[:2])
    A, b = W.reshape(-1, P), y.ravel()
    _, singular, V = np.linalg.svd(A, full_matrices=False)
    estimator = ls.Estimator()
    fit = estimator.fit(
        estimator.step(estimator.init(np.zeros(P)), plain(W, y), trace=False)[0]
    ).fit
    # (W'W)^-1 = V S^-2 V': its error is twice that of the smallest singular value, 1e7 eps.
    covariance = (V.T / singular**2) @ V
    np.testing.assert_allclose(fit.unit_covariance, covariance, atol=1e-7 * covariance.max())
    residual = b - A @ np.linalg.lstsq(A, b, rcond=None)[0]
    assert fit.variance == pytest.approx(residual @ residual / (len(b) - P), rel=1e-9)
