"""Essential parameters."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.stats
from unit.slow_motions import P, least_squares, regression

from scarid_cli.algorithms.inference.essential import RATIO, Noise, essential, without
from scarid_cli.algorithms.regression.information import Fit
from scarid_cli.algorithms.regression.rows import Rows, plain

WHITE = Noise(rows=5000.0, inflation=1.0, blocks=50)


def noisy(truth: list[float]) -> tuple[Rows, Fit]:
    """Rows with white noise, and their fit."""
    rng = np.random.default_rng(1)
    W = rng.standard_normal((5000, 1, P))
    rows = plain(W, W @ np.array(truth) + 0.1 * rng.standard_normal((5000, 1)))
    return rows, least_squares(rows).fit


def test_without_a_parameter_is_a_refit_without_its_column() -> None:
    rows = regression()
    fit = least_squares(rows).fit
    theta, covariance = without(fit.estimates, fit.unit_covariance, 1)
    refit = least_squares(plain(rows.W[:, :, [0, 2]], rows.y)).fit
    np.testing.assert_allclose(theta[[0, 2]], refit.estimates, rtol=1e-9)
    np.testing.assert_allclose(covariance[np.ix_([0, 2], [0, 2])], refit.unit_covariance, rtol=1e-9)


def test_what_is_not_known_is_dropped_and_the_rest_is_a_fit_of_its_own() -> None:
    rows, fit = noisy([5.0, 1e-5, 1.0])
    found = essential(fit, WHITE, P)
    assert (found.kept, found.dropped) == ([0, 2], (1,))
    refit = least_squares(plain(rows.W[:, :, [0, 2]], rows.y)).fit
    np.testing.assert_allclose(found.fit.estimates, refit.estimates, rtol=1e-9)
    for number in ("variance", "sample_variance", "condition"):
        assert getattr(found.fit, number) == pytest.approx(getattr(refit, number), rel=1e-9)
    cost = np.sqrt(refit.variance * 4998 / (fit.variance * 4997)) - 1.0
    assert found.cost == pytest.approx(cost, rel=1e-6)
    relative = found.fit.standard_errors() / np.abs(refit.estimates)
    assert relative.max() < RATIO * relative.min()


def test_what_is_known_is_kept_however_well_others_are_known() -> None:
    """A deviation of 10 %, but 700 times that of the best: the ratio alone would drop it."""
    _, fit = noisy([100.0, 0.014, 1.0])
    relative = fit.standard_errors() / np.abs(fit.estimates)
    assert relative[1] < 0.12
    assert relative[1] > RATIO * relative[0]
    assert essential(fit, WHITE, P).dropped == ()


def test_the_residual_may_grow_by_what_the_noise_explains() -> None:
    """The bound is that of the F test, which the same estimate passes where it is less certain."""
    _, fit = noisy([100.0, 0.005, 100.0])
    squares = fit.estimates[1] ** 2 / fit.unit_covariance[1, 1]
    point = scipy.stats.f.ppf(0.95, 1, WHITE.blocks - 1)
    needed = squares / (point * fit.variance)
    assert needed > 1.0
    for inflation, dropped in ((0.99 * needed, ()), (1.01 * needed, (1,))):
        found = essential(fit, Noise(5000.0, inflation, WHITE.blocks), P)
        assert found.dropped == dropped
        assert found.cost <= found.allowed


@pytest.mark.parametrize("inflation", [float("inf"), float("nan")])
def test_nothing_is_dropped_if_the_uncertainty_is_unknown(inflation: float) -> None:
    _, fit = noisy([5.0, 1e-5, 1.0])
    assert essential(fit, Noise(5000.0, inflation, WHITE.blocks), P).dropped == ()
