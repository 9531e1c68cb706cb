"""Estimators against numpy.linalg and the textbook's recursion."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize
import statsmodels.api as sm
from hypothesis import given, settings
from hypothesis import strategies as st
from unit.support import cuts

from scarid_cli.algorithms.choices.registry import ESTIMATORS
from scarid_cli.algorithms.estimators import irls, ls, ml, rls, tls, wls
from scarid_cli.algorithms.regression.information import Fit, NotIdentifiableError
from scarid_cli.algorithms.regression.rows import plain
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

THETA = np.array([3.0, -2.0, 0.5, 10.0])
P = len(THETA)


def data(samples: int, joints: int = 2, noise: float = 0.1, seed: int = 0) -> tuple[Array, Array]:
    """Rows of a regression with known parameters: W (samples, joints, P) and y."""
    rng = np.random.default_rng(seed)
    W = rng.standard_normal((samples, joints, P))
    return W, W @ THETA + noise * rng.standard_normal((samples, joints))


def fitted(estimator: Any, W: Array, y: Array, prior: Array | None = None) -> Fit:
    start = np.zeros(W.shape[2]) if prior is None else prior
    state, _ = estimator.step(estimator.init(start), plain(W, y), trace=False)
    return estimator.fit(state)


# Least squares


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


# Recursive least squares


def textbook(W: Array, y: Array, forgetting: float, prior: Array, p0: float) -> tuple[Array, Array]:
    """The covariance form of section 2.3: estimates after each sample, and the last covariance."""
    theta, covariance = prior.copy(), p0 * np.eye(len(prior))
    trace = []
    for rows, torques in zip(W, y, strict=True):
        covariance = covariance / forgetting  # once a sample, however many joints it has
        for w, torque in zip(rows, torques, strict=True):
            gain = covariance @ w / (1.0 + w @ covariance @ w)
            theta = theta + gain * (torque - w @ theta)
            covariance = covariance - np.outer(gain, w @ covariance)
        trace.append(theta)
    return np.array(trace), covariance


@pytest.mark.parametrize("forgetting", [1.0, 0.98])
@pytest.mark.parametrize("joints", [1, 2])
def test_rls_is_the_recursion_of_the_textbook(joints: int, forgetting: float) -> None:
    W, y = data(300, joints)
    prior = np.array([1.0, 0.0, -1.0, 2.0])
    estimator = rls.Estimator(forgetting, p0=100.0)
    state, trace = estimator.step(estimator.init(prior), plain(W, y), trace=True)
    expected, covariance = textbook(W, y, forgetting, prior, p0=100.0)
    fit = estimator.fit(state)
    # The textbook's form loses P0 times some eps; the first samples are the worst.
    np.testing.assert_allclose(trace, expected, rtol=1e-10, atol=1e-11)
    np.testing.assert_allclose(fit.estimates, trace[-1], rtol=1e-12)
    scale = np.abs(covariance).max()
    np.testing.assert_allclose(fit.unit_covariance, covariance, rtol=1e-9, atol=1e-11 * scale)


def test_rls_that_knows_and_forgets_nothing_is_ls() -> None:
    W, y = data(500)
    recursive = fitted(rls.Estimator(forgetting=1.0, p0=1e12), W, y)
    plain = fitted(ls.Estimator(), W, y)
    np.testing.assert_allclose(recursive.estimates, plain.estimates, rtol=1e-9)
    np.testing.assert_allclose(recursive.unit_covariance, plain.unit_covariance, rtol=1e-9)
    assert recursive.variance == pytest.approx(plain.variance, rel=1e-9)


@pytest.mark.parametrize("forgetting", [1.0, 0.98])
def test_rls_keeps_its_initial_parameters_without_excitation(forgetting: float) -> None:
    prior = np.array([1.0, -2.0, 3.0, 0.0])
    estimator = rls.Estimator(forgetting, p0=4.0)
    W, y = np.zeros((50, 2, P)), np.zeros((50, 2))
    state, trace = estimator.step(estimator.init(prior), plain(W, y), trace=True)
    np.testing.assert_allclose(trace, np.tile(prior, (50, 1)), rtol=1e-14)
    # Forgetting is forgetting all the same, but for the little that is given back.
    covariance = estimator.fit(state).unit_covariance
    np.testing.assert_allclose(covariance, 4.0 / forgetting**50 * np.eye(P), rtol=1e-8)


@pytest.mark.parametrize(
    "row",
    [[0.0, 0.0], [1.0, 1.0], [1.0, 1000.0], [1000.0, 1.0]],
    ids=["none", "both", "mostly the second", "mostly the first"],
)
def test_rls_forgets_no_more_than_it_has_to(row: list[float]) -> None:
    """Without excitation, or with excitation in one direction alone, for a long time.

    Where 0.95^50000 is nothing at all, the estimates stay finite and explain the torque, and the
    covariance stays bounded in every direction.
    """
    samples, estimator, truth = 50_000, rls.Estimator(forgetting=0.95, p0=100.0), [3.0, 2.0]
    W = np.tile(row, (samples, 1, 1))
    state, trace = estimator.step(estimator.init(np.zeros(2)), plain(W, W @ truth), trace=True)
    fit = estimator.fit(state)
    assert np.isfinite(trace).all()
    np.testing.assert_allclose(W[-1] @ fit.estimates, W[-1] @ truth, rtol=1e-6)
    assert np.linalg.eigvalsh(fit.unit_covariance).max() <= 2.0 * estimator.p0 / rls.FADED


def test_rls_follows_a_parameter_that_changes_if_it_forgets() -> None:
    W, _ = data(2000)
    y = W @ THETA
    y[1000:] *= 2.0
    last = {f: fitted(rls.Estimator(f), W, y).estimates for f in (1.0, 0.98)}
    np.testing.assert_allclose(last[0.98], 2.0 * THETA, rtol=1e-6)
    # What never forgets finds the mean of before and after.
    np.testing.assert_allclose(last[1.0], 1.5 * THETA, rtol=0.0, atol=0.5)


def test_rls_covariance_stays_positive_definite() -> None:
    """With forgetting, and a column that is hardly ever excited, where the plain form gives up."""
    W, y = data(100_000, joints=1)
    W[1000:, :, 3] *= 1e-3
    estimator = rls.Estimator(forgetting=0.95)
    state, _ = estimator.step(estimator.init(np.zeros(P)), plain(W, y), trace=False)
    covariance = estimator.fit(state).unit_covariance
    np.testing.assert_array_equal(covariance, covariance.T)
    assert np.all(np.linalg.eigvalsh(covariance) > 0.0)


@pytest.mark.parametrize(
    ("settings", "complaint"),
    [
        ({"forgetting": 0.0}, "forgetting must be positive"),
        ({"forgetting": -0.5}, "forgetting must be positive"),
        ({"forgetting": 1.01}, "forgetting must not exceed 1"),
        ({"forgetting": np.nan}, "forgetting must"),
        ({"p0": 0.0}, "p0 must be positive"),
        ({"p0": np.inf}, "p0 must be positive"),
    ],
)
def test_setting_without_sense_is_refused(settings: dict[str, float], complaint: str) -> None:
    with pytest.raises(UsageFault, match=complaint):
        rls.Estimator(**settings)


# All of them that know no robot

ROWS = 40
PLAIN = [name for name in ESTIMATORS.names if not hasattr(ESTIMATORS.load(name), "for_robot")]

every_estimator = pytest.mark.parametrize(
    "estimator",
    [
        *(ESTIMATORS.load(name)() for name in PLAIN),
        rls.Estimator(forgetting=0.97),
        rls.Estimator(forgetting=(0.97, 1.0, 0.9, 0.99)),
    ],
    ids=lambda estimator: f"{type(estimator).__module__.rpartition('.')[2]} {estimator}",
)


def bits(fit: Fit) -> list[Any]:
    return [fit.estimates.tolist(), fit.unit_covariance.tolist(), fit.variance]


@every_estimator
@given(chunks=cuts(ROWS), trace=st.booleans())
@settings(max_examples=30, deadline=None)
def test_chunks_do_not_change_a_bit(estimator: Any, chunks: list[slice], *, trace: bool) -> None:
    W, y = data(ROWS)
    trace = trace and estimator.RECURSIVE
    whole, expected = estimator.step(estimator.init(THETA), plain(W, y), trace=trace)
    state, traces = estimator.init(THETA), []
    for chunk in chunks:
        state, part = estimator.step(state, plain(W[chunk], y[chunk]), trace=trace)
        traces.append(part)
    assert bits(estimator.fit(state)) == bits(estimator.fit(whole))
    np.testing.assert_array_equal(np.concatenate(traces), expected)


@every_estimator
def test_step_leaves_its_state_alone(estimator: Any) -> None:
    W, y = data(ROWS)
    state, _ = estimator.step(estimator.init(THETA), plain(W, y))
    more = (estimator.step(state, plain(W, 2.0 * y))[0] for _ in range(2))
    first, second = (estimator.fit(found) for found in more)
    assert bits(first) == bits(second)


@every_estimator
def test_estimates_come_near_the_truth(estimator: Any) -> None:
    W, y = data(5000)
    fit = fitted(estimator, W, y)
    assert np.all(np.abs(fit.estimates - THETA) < 5.0 * fit.standard_errors())


@every_estimator
def test_rows_that_are_left_out_have_no_say(estimator: Any) -> None:
    W, y = data(ROWS)
    spoilt = y.copy()
    spoilt[::4] = 1e3
    rows = plain(W, spoilt)
    rows.scales[::4] = 0.0
    found = estimator.fit(estimator.step(estimator.init(THETA), rows)[0])
    if getattr(estimator, "factors", (1.0,)) != (1.0,):
        # Forgetting counts samples, whether they are left out or not.
        assert np.all(np.abs(found.estimates - THETA) < 1.0)
        return
    kept = np.arange(ROWS) % 4 != 0
    state, _ = estimator.step(estimator.init(THETA), plain(W[kept], y[kept]))
    np.testing.assert_allclose(found.estimates, estimator.fit(state).estimates, rtol=1e-9)


# Each against something independent


def uneven(samples: int = 400, seed: int = 3) -> tuple[Array, Array]:
    """Two joints whose torques differ in size and in noise, and are correlated."""
    W, _ = data(samples, seed=seed)
    rng = np.random.default_rng(seed + 1)
    noise = rng.standard_normal((samples, 2)) @ np.array([[2.0, 0.04], [0.0, 0.05]])
    return W, W @ THETA + noise


def test_wls_is_weighted_least_squares_of_statsmodels() -> None:
    """With the residual variances of each joint's own fit, which it takes for its weights."""
    W, y = uneven()
    variances = [sm.OLS(y[:, j], W[:, j]).fit().mse_resid for j in range(2)]
    weights = np.tile(1.0 / np.array(variances), len(W))
    expected = sm.WLS(y.ravel(), W.reshape(-1, P), weights=weights).fit()
    fit = fitted(wls.Estimator(), W, y)
    np.testing.assert_allclose(fit.estimates, expected.params, rtol=1e-10)
    np.testing.assert_allclose(fit.standard_errors(), expected.bse, rtol=1e-9)


def test_irls_is_the_robust_regression_of_statsmodels() -> None:
    """Huber's weights with the median absolute deviation, one joint, a tenth of it outliers."""
    W, y = data(400, joints=1)
    y[::10] += 5.0
    fit = fitted(irls.Estimator(), W, y)
    norm = sm.robust.norms.HuberT(t=1.345)
    expected = sm.RLM(y[:, 0], W[:, 0], M=norm).fit(maxiter=200, tol=1e-12, conv="coefs")
    np.testing.assert_allclose(fit.estimates, expected.params, rtol=1e-7)
    plain_error = np.abs(fitted(ls.Estimator(), W, y).estimates - THETA).max()
    assert np.abs(fit.estimates - THETA).max() < 0.5 * plain_error


def test_tls_is_the_smallest_singular_vector_of_scipy() -> None:
    W, y = data(300)
    both = np.column_stack((W.reshape(-1, P), y.ravel()))
    norms = np.linalg.norm(both, axis=0)
    last = scipy.linalg.svd(both / norms)[2][-1]
    expected = -last[:P] / last[P] * norms[P] / norms[:P]
    np.testing.assert_allclose(fitted(tls.Estimator(), W, y).estimates, expected, rtol=1e-10)


def test_tls_is_not_attenuated_by_noise_in_the_regressor() -> None:
    rng = np.random.default_rng(1)
    W, _ = data(20_000, joints=1)
    norms = np.sqrt((W**2).mean(axis=(0, 1)))
    y = W @ THETA
    spoilt = W + 0.3 * norms * rng.standard_normal(W.shape)
    y = y + 0.3 * np.sqrt(np.mean(y**2)) * rng.standard_normal(y.shape)
    fit = fitted(tls.Estimator(), spoilt, y)
    assert np.all(np.abs(fit.estimates - THETA) < 5.0 * fit.standard_errors())
    attenuated = fitted(ls.Estimator(), spoilt, y).estimates
    np.testing.assert_allclose(attenuated, THETA / 1.09, rtol=0.0, atol=0.3)


def test_ml_maximises_the_likelihood() -> None:
    """Found by scipy's optimiser over the parameters and the covariance's square root."""
    W, y = uneven(150)

    def loss(x: Array) -> float:
        residual = y - W @ x[:P]
        root = np.array([[np.exp(x[P]), 0.0], [x[P + 1], np.exp(x[P + 2])]])
        white = np.linalg.solve(root, residual.T)
        return float(0.5 * np.sum(white**2) + len(y) * (x[P] + x[P + 2]))

    start = np.concatenate((THETA, np.zeros(3)))
    found = scipy.optimize.minimize(loss, start, method="BFGS", options={"gtol": 1e-6})
    fit = fitted(ml.Estimator(), W, y)
    np.testing.assert_allclose(fit.estimates, found.x[:P], rtol=1e-5)
    root = np.array([[np.exp(found.x[P]), 0.0], [found.x[P + 1], np.exp(found.x[P + 2])]])
    np.testing.assert_allclose(fit.extra["noise_covariance"], root @ root.T, rtol=1e-4)


def test_rls_forgets_each_parameter_at_its_own_rate() -> None:
    """By definition: the information P^-1, times the roots of the factors on both sides."""
    W, y = data(200)
    factors = np.array([0.9, 1.0, 0.97, 0.99])
    information, moment = np.eye(P) / 100.0, np.zeros(P)
    root = np.sqrt(factors)
    for rows, torques in zip(W, y, strict=True):
        theta = np.linalg.solve(information, moment)
        information = root[:, None] * information * root
        moment = information @ theta
        information += rows.T @ rows
        moment += rows.T @ torques
    fit = fitted(rls.Estimator(tuple(factors.tolist())), W, y)
    np.testing.assert_allclose(fit.estimates, np.linalg.solve(information, moment), rtol=1e-9)
    covariance = np.linalg.inv(information)
    np.testing.assert_allclose(fit.unit_covariance, covariance, rtol=1e-8, atol=1e-12)


def test_rls_without_excitation_stays_bounded_for_ten_million_updates() -> None:
    """Half of them exciting, then none: finite, symmetric, bounded, and the estimates stay."""
    W, y = data(20_000)
    estimator = rls.Estimator(forgetting=0.95)
    state = estimator.init(np.zeros(P))
    moving, still = plain(W, y), plain(np.zeros_like(W), np.zeros_like(y))
    for _ in range(250):
        state, _ = estimator.step(state, moving)
    before = estimator.fit(state).estimates
    for _ in range(250):
        state, _ = estimator.step(state, still)
    fit = estimator.fit(state)
    np.testing.assert_allclose(fit.estimates, before, rtol=1e-9)
    np.testing.assert_array_equal(fit.unit_covariance, fit.unit_covariance.T)
    sizes = np.linalg.eigvalsh(fit.unit_covariance)
    assert 0.0 < sizes.min() <= sizes.max() <= 2.0 * estimator.p0 / rls.FADED


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
    fit = estimator.fit(estimator.step(estimator.init(np.zeros(P)), plain(W, y), trace=False)[0])
    # (W'W)^-1 = V S^-2 V': its error is twice that of the smallest singular value, 1e7 eps.
    covariance = (V.T / singular**2) @ V
    np.testing.assert_allclose(fit.unit_covariance, covariance, atol=1e-7 * covariance.max())
    residual = b - A @ np.linalg.lstsq(A, b, rcond=None)[0]
    assert fit.variance == pytest.approx(residual @ residual / (len(b) - P), rel=1e-9)


def test_forgetting_weights_the_residual_and_the_rows_alike() -> None:
    """Least squares with weights lambda^(age in samples), when nothing is known before."""
    rng = np.random.default_rng(0)
    W = rng.standard_normal((200, 2, P))
    y = W @ THETA + 0.1 * rng.standard_normal((200, 2))
    root = np.repeat(np.sqrt(0.98 ** np.arange(200)[::-1]), 2)
    A, b = W.reshape(-1, P) * root[:, None], y.ravel() * root
    theta, squares, *_ = np.linalg.lstsq(A, b, rcond=None)
    estimator = rls.Estimator(forgetting=0.98, p0=1e12)
    fit = estimator.fit(estimator.step(estimator.init(np.zeros(P)), plain(W, y), trace=False)[0])
    np.testing.assert_allclose(fit.estimates, theta, rtol=1e-9)
    assert fit.variance == pytest.approx(squares[0] / (np.sum(root**2) - P), rel=1e-9)


def test_long_standstill_leaves_the_estimates_alone() -> None:
    """Five minutes at 200 Hz: what is forgotten must not become 0/0."""
    W, y = np.zeros((60_000, 1, P)), np.zeros((60_000, 1))
    estimator = rls.Estimator(forgetting=0.95)
    _, trace = estimator.step(estimator.init(THETA), plain(W, y), trace=True)
    np.testing.assert_allclose(trace[-1], THETA, rtol=1e-12)
