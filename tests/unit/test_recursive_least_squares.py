"""Recursive least squares against the recursion of the textbook and against its definition."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from unit.regressions import THETA, P, data, fitted

from scarid_cli.algorithms.estimators import ls, rls, wls
from scarid_cli.algorithms.regression.rows import plain
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault


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
    estimator = rls.Estimator(forgetting, p0=100.0, weights=0)
    state, trace = estimator.step(estimator.init(prior), plain(W, y), trace=True)
    expected, covariance = textbook(W, y, forgetting, prior, p0=100.0)
    fit = estimator.fit(state).fit
    # The textbook's form loses P0 times some eps; the first samples are the worst.
    np.testing.assert_allclose(trace, expected, rtol=1e-10, atol=1e-11)
    np.testing.assert_allclose(fit.estimates, trace[-1], rtol=1e-12)
    scale = np.abs(covariance).max()
    np.testing.assert_allclose(fit.unit_covariance, covariance, rtol=1e-9, atol=1e-11 * scale)


def test_rls_that_knows_and_forgets_nothing_is_ls() -> None:
    W, y = data(500)
    recursive = fitted(rls.Estimator(forgetting=1.0, p0=1e12, weights=0), W, y)
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
    covariance = estimator.fit(state).fit.unit_covariance
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
    fit = estimator.fit(state).fit
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
    covariance = estimator.fit(state).fit.unit_covariance
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
    fit = fitted(rls.Estimator(tuple(factors.tolist()), weights=0), W, y)
    np.testing.assert_allclose(fit.estimates, np.linalg.solve(information, moment), rtol=1e-9)
    covariance = np.linalg.inv(information)
    np.testing.assert_allclose(fit.unit_covariance, covariance, rtol=1e-8, atol=1e-12)


def test_rls_without_excitation_stays_bounded_for_two_million_updates() -> None:
    """Half of them exciting, then none: finite, symmetric, bounded, and the estimates stay."""
    W, y = data(20_000)
    estimator = rls.Estimator(forgetting=0.95)
    state = estimator.init(np.zeros(P))
    moving, still = plain(W, y), plain(np.zeros_like(W), np.zeros_like(y))
    for _ in range(50):
        state, _ = estimator.step(state, moving)
    before = estimator.fit(state).fit.estimates
    for _ in range(50):
        state, _ = estimator.step(state, still)
    fit = estimator.fit(state).fit
    np.testing.assert_allclose(fit.estimates, before, rtol=1e-9)
    np.testing.assert_array_equal(fit.unit_covariance, fit.unit_covariance.T)
    sizes = np.linalg.eigvalsh(fit.unit_covariance)
    assert 0.0 < sizes.min() <= sizes.max() <= 2.0 * estimator.p0 / rls.FADED


def test_forgetting_weights_the_residual_and_the_rows_alike() -> None:
    """Least squares with weights lambda^(age in samples), when nothing is known before."""
    rng = np.random.default_rng(0)
    W = rng.standard_normal((200, 2, P))
    y = W @ THETA + 0.1 * rng.standard_normal((200, 2))
    root = np.repeat(np.sqrt(0.98 ** np.arange(200)[::-1]), 2)
    A, b = W.reshape(-1, P) * root[:, None], y.ravel() * root
    theta, squares, *_ = np.linalg.lstsq(A, b, rcond=None)
    estimator = rls.Estimator(forgetting=0.98, p0=1e12, weights=0)
    fit = estimator.fit(
        estimator.step(estimator.init(np.zeros(P)), plain(W, y), trace=False)[0]
    ).fit
    np.testing.assert_allclose(fit.estimates, theta, rtol=1e-9)
    assert fit.variance == pytest.approx(squares[0] / (np.sum(root**2) - P), rel=1e-9)


def test_long_standstill_leaves_the_estimates_alone() -> None:
    """Five minutes at 200 Hz: what is forgotten must not become 0/0."""
    W, y = np.zeros((60_000, 1, P)), np.zeros((60_000, 1))
    estimator = rls.Estimator(forgetting=0.95)
    _, trace = estimator.step(estimator.init(THETA), plain(W, y), trace=True)
    np.testing.assert_allclose(trace[-1], THETA, rtol=1e-12)


def unequal(samples: int) -> tuple[Array, Array]:
    """Rows of two joints, of which the second has a hundredth of the torque and of the noise."""
    rng = np.random.default_rng(3)
    W = rng.standard_normal((samples, 2, P)) * np.array([1.0, 0.01])[:, None]
    W[:, 0, 2:] = 0.0  # these parameters act on the second joint only
    y = W @ THETA + 0.1 * rng.standard_normal((samples, 2)) * np.array([1.0, 0.01])
    return np.ascontiguousarray(W), np.ascontiguousarray(y)


@pytest.mark.parametrize("forgetting", [1.0, 0.98])
def test_rls_weights_joints_by_their_recursive_residuals(forgetting: float) -> None:
    """By definition, in the covariance form: e^2 / (1 + w' P w) of each row, in torque units."""
    W, y = unequal(300)
    apart = 0.5 / (10.0 * 0.01)  # rows within half a period of 10 Hz are one
    theta, covariance = np.zeros(P), 100.0 * np.eye(P)
    squares, rows, torques = (np.zeros(2) for _ in range(3))
    for w_sample, y_sample in zip(W, y, strict=True):
        covariance = covariance / forgetting
        weights = np.ones(2)
        if rows.min() >= apart:
            variances = (squares + (P * apart / rows) ** 2 * torques) / rows
            weights = variances.max() / variances
        for j, (w, tau) in enumerate(zip(w_sample, y_sample, strict=True)):
            spread = 1.0 / weights[j] + w @ covariance @ w
            gain, error = covariance @ w / spread, tau - w @ theta
            theta = theta + gain * error
            squares[j] = forgetting * squares[j] + error**2 / (weights[j] * spread)
            rows[j] = forgetting * rows[j] + 1.0
            torques[j] = forgetting * torques[j] + tau**2
            covariance = covariance - np.outer(gain, w @ covariance)
    estimator = rls.Estimator(forgetting, p0=100.0)
    fit = estimator.of_rows(plain(W, y, 0.01)).fit
    # A little information is given back when it forgets.
    np.testing.assert_allclose(fit.estimates, theta, rtol=1e-9 if forgetting == 1.0 else 1e-6)


def test_rls_comes_to_the_weights_of_wls() -> None:
    W, y = unequal(5000)
    weighted = fitted(rls.Estimator(p0=1e9), W, y)
    reference = fitted(wls.Estimator(), W, y)
    alike = fitted(rls.Estimator(p0=1e9, weights=0), W, y)
    errors = reference.standard_errors()
    assert np.abs(weighted.estimates - reference.estimates).max() < 0.3 * errors.max()
    assert np.abs(alike.estimates - reference.estimates).max() > 0.3 * errors.max()


def test_one_joint_is_not_weighted() -> None:
    W, y = data(300)
    W, y = W[:, :1], y[:, :1]
    assert fitted(rls.Estimator(), W, y).estimates.tolist() == (
        fitted(rls.Estimator(weights=0), W, y).estimates.tolist()
    )


def test_a_joint_that_comes_late_does_not_drown_out_the_others() -> None:
    """Its first torque is that of rest; it must not count for more than what follows."""
    W, y = unequal(2000)
    rows = replace(plain(W, y), scales=np.ones(y.shape))
    rows.scales[:1000, 1] = 0.0
    rows.y[1000:1100, 1] = 0.0
    estimator = rls.Estimator(p0=1e9)
    state, _ = estimator.step(estimator.init(np.zeros(P)), rows)
    found = estimator.fit(state).fit.estimates
    rows.scales[1000:1100, 1] = 0.0
    state, _ = estimator.step(estimator.init(np.zeros(P)), rows)
    assert found == pytest.approx(estimator.fit(state).fit.estimates, abs=1.5)


def test_a_joint_without_torque_does_not_drown_out_the_others() -> None:
    W, y = unequal(400)
    W[:, 1], y[:, 1] = 0.0, 0.0
    W[:, 0] = np.random.default_rng(0).standard_normal((400, P))
    y[:, 0] = W[:, 0] @ THETA
    np.testing.assert_allclose(fitted(rls.Estimator(p0=1e9), W, y).estimates, THETA, rtol=1e-6)
