"""All estimators that know no robot: laws they share, and each against something independent."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize
import statsmodels.api as sm
from hypothesis import given, settings
from hypothesis import strategies as st
from unit.regressions import THETA, P, data, estimated, fitted
from unit.support import cuts

from scarid_cli.algorithms.choices.registry import ESTIMATORS
from scarid_cli.algorithms.estimators import irls, ls, ml, rls, tls, wls
from scarid_cli.algorithms.regression import information
from scarid_cli.algorithms.regression.estimation import BaseEstimator
from scarid_cli.algorithms.regression.information import Fit
from scarid_cli.algorithms.regression.rows import plain
from scarid_cli.arrays import Array

ROWS = 40
PLAIN = [n for n in ESTIMATORS.names if ESTIMATORS.load(n).for_robot is BaseEstimator.for_robot]

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
    rows = plain(W, y)
    whole, expected = estimator.step(estimator.init(THETA), rows, trace=trace)
    state, traces = estimator.init(THETA), []
    for chunk in chunks:
        state, part = estimator.step(state, rows.part(chunk), trace=trace)
        traces.append(part)
    assert bits(estimator.fit(state).fit) == bits(estimator.fit(whole).fit)
    np.testing.assert_array_equal(np.concatenate(traces), expected)


@given(
    shape=st.tuples(st.integers(1, 60), st.integers(1, 8)),
    zeros=st.integers(0, 255),
    seed=st.integers(0, 1000),
    size=st.sampled_from([1e-8, 1.0, 1e8]),
)
@settings(max_examples=60, deadline=None)
def test_rows_condensed_at_once_have_the_information_of_row_by_row(
    shape: tuple[int, int], zeros: int, seed: int, size: float
) -> None:
    rng = np.random.default_rng(seed)
    W = size * rng.standard_normal(shape)
    W[:, [bool(zeros >> k & 1) for k in range(shape[1])]] = 0.0
    y, scales = rng.standard_normal(shape[0]), rng.integers(0, 3, shape[0]).astype(float)
    found = information.condensed(W, y, scales)
    start = information.empty(shape[1])
    expected, _ = information.absorb(start, W[:, None], y[:, None], scales[:, None])
    assert (found.weight, found.count) == (expected.weight, expected.count)
    products = [x.triangle.T @ x.triangle for x in (found, expected)]
    units = np.sqrt(np.diag(products[1])) + 1e-300
    np.testing.assert_allclose(*(x / units / units[:, None] for x in products), atol=1e-12)
    squares = np.sum((scales * y) ** 2)
    assert found.residual == pytest.approx(expected.residual, abs=1e-12 * squares + 1e-300)


@every_estimator
def test_step_leaves_its_state_alone(estimator: Any) -> None:
    W, y = data(ROWS)
    state, _ = estimator.step(estimator.init(THETA), plain(W, y))
    more = (estimator.step(state, plain(W, 2.0 * y))[0] for _ in range(2))
    first, second = (estimator.fit(found).fit for found in more)
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
    found = estimator.fit(estimator.step(estimator.init(THETA), rows)[0]).fit
    if getattr(estimator, "factors", (1.0,)) != (1.0,):
        # Forgetting counts samples, whether they are left out or not.
        assert np.all(np.abs(found.estimates - THETA) < 1.0)
        return
    kept = np.arange(ROWS) % 4 != 0
    state, _ = estimator.step(estimator.init(THETA), plain(W[kept], y[kept]))
    np.testing.assert_allclose(found.estimates, estimator.fit(state).fit.estimates, rtol=1e-9)


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
    estimation = estimated(ml.Estimator(), plain(W, y))
    np.testing.assert_allclose(estimation.fit.estimates, found.x[:P], rtol=1e-5)
    root = np.array([[np.exp(found.x[P]), 0.0], [found.x[P + 1], np.exp(found.x[P + 2])]])
    np.testing.assert_allclose(estimation.extra["noise_covariance"], root @ root.T, rtol=1e-4)


@pytest.mark.parametrize("silent", [[1], [0, 1]], ids=["one joint", "both joints"])
def test_ml_takes_joints_that_are_fitted_exactly(silent: list[int]) -> None:
    """Their residual has no variance, so that the covariance of the noise is singular."""
    W, y = data(300, noise=0.0)
    W[:, silent], y[:, silent] = np.round(4.0 * W[:, silent]), 0.0
    if len(silent) == 1:
        W[:, silent] = 0.0
    found = estimated(ml.Estimator(), plain(W, y))
    truth = np.zeros(P) if len(silent) == 2 else THETA
    np.testing.assert_allclose(found.fit.estimates, truth, atol=1e-9)
    assert np.linalg.eigvalsh(found.extra["noise_covariance"]).min() > 0.0
