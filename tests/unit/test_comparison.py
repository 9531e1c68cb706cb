"""The comparison of estimates: known differences are found, and nothing else is."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from statsmodels.stats.multitest import multipletests

from scarid_cli.algorithms.uncertainty.comparison import (
    Estimate,
    comparison,
    freedom_of,
    holm,
    p_values,
    trend,
)
from scarid_cli.algorithms.uncertainty.jackknife import quantile
from scarid_cli.arrays import Array
from scarid_cli.stages.compare import _listed

P = 6
MIX = np.random.default_rng(5).standard_normal((P, P))
COVARIANCE = MIX @ MIX.T
FREEDOM = np.full(P, 39.0)


def estimate(values: Array, *, known: bool = True) -> Estimate:
    errors = np.sqrt(np.diag(COVARIANCE))
    return Estimate(values, errors, FREEDOM, COVARIANCE if known else None)


def test_holm_as_statsmodels_does_it() -> None:
    tails = np.random.default_rng(1).uniform(size=12) ** 3
    expected = multipletests(tails, method="holm")[1]
    assert holm(tails) == pytest.approx(expected)
    with_gap = holm(np.insert(tails, 4, np.nan))
    assert np.isnan(with_gap[4])
    assert np.delete(with_gap, 4) == pytest.approx(expected)


def test_p_values_are_those_of_students_t_and_unknown_without_an_error() -> None:
    differences, errors = np.array([1.0, -3.0, 1.0, 1.0]), np.array([0.5, 1.0, 0.0, np.nan])
    expected = [2.0 * stats.t.sf(2.0, 7.0), 2.0 * stats.t.sf(3.0, 7.0), np.nan, np.nan]
    assert p_values(differences, errors, np.full(4, 7.0)) == pytest.approx(expected, nan_ok=True)


def test_false_alarms_are_at_most_one_in_twenty() -> None:
    """With either covariance known; errors are exact here, so t and F are conservative."""
    rng = np.random.default_rng(2)
    draws = rng.multivariate_normal(np.zeros(P), COVARIANCE, (400, 2))
    for known in (True, False):
        alarms = [comparison(*(estimate(x, known=known) for x in pair)).differ for pair in draws]
        assert np.mean(alarms) <= 0.05


def test_a_difference_along_the_best_known_direction_is_found_by_the_joint_test() -> None:
    values, vectors = np.linalg.eigh(COVARIANCE)
    moved = comparison(estimate(np.zeros(P)), estimate(12.0 * np.sqrt(values[0]) * vectors[:, 0]))
    assert moved.joint
    assert moved.joint.p_value < 1e-4
    assert moved.joint.f == pytest.approx(144.0 / 2.0 / P)


def test_a_parameter_that_differs_is_named() -> None:
    moved = np.zeros(P)
    moved[3] = 10.0 * np.sqrt(COVARIANCE[3, 3])
    found = comparison(estimate(np.zeros(P), known=False), estimate(moved, known=False))
    assert found.differing == [3]
    assert found.counts[3] == pytest.approx(10.0 / np.sqrt(2.0))


@pytest.mark.parametrize("n", [1, 5, 39, 120])
def test_degrees_of_freedom_are_read_from_the_intervals(n: int) -> None:
    found = freedom_of(np.array([2.0]), np.array([2.0 * quantile(0.975, n)]))
    assert found == [n]


def test_a_trend_is_that_of_weighted_least_squares() -> None:
    rng = np.random.default_rng(3)
    errors = rng.uniform(0.5, 2.0, (5, P))
    values = rng.standard_normal((5, P))
    found = trend([Estimate(v, e, FREEDOM, None) for v, e in zip(values, errors, strict=True)])
    for i in range(P):
        line, covariance = np.polyfit(
            np.arange(5), values[:, i], 1, w=1.0 / errors[:, i], cov="unscaled"
        )
        assert found.difference[i] == pytest.approx(line[0])
        assert found.errors[i] == pytest.approx(np.sqrt(covariance[0, 0]))


def test_estimates_without_errors_are_not_compared() -> None:
    exact = Estimate(np.ones(P), np.zeros(P), FREEDOM, np.zeros((P, P)))
    assert comparison(exact, exact).joint is None
    for found in (comparison(exact, exact), trend([exact] * 3)):
        assert np.isnan(found.p_values).all()


@pytest.mark.parametrize("differing", [1, 5, 6])
def test_a_message_names_up_to_five_parameters_and_says_if_there_are_more(differing: int) -> None:
    """Each is ten errors apart, and the errors are uncorrelated."""
    names = [f"p{i}" for i in range(P)]
    plain = Estimate(np.zeros(P), np.ones(P), FREEDOM, np.eye(P))
    moved = np.where(np.arange(P) < differing, 20.0, 0.0)
    pair = comparison(plain, Estimate(moved, np.ones(P), FREEDOM, np.eye(P)))
    text = _listed(pair, names, ["kg"] * P)
    assert [name for name in names if f"{name} +20 kg" in text] == names[: min(differing, 5)]
    assert text.endswith(", ...") == (differing > 5)


def test_all_errors_of_a_log_have_the_freedom_of_its_widest_interval() -> None:
    """The others are narrower because they allow for slow noise, and unknown errors say nothing."""
    errors = np.array([2.0, 1.0, np.nan])
    half = errors * [quantile(0.975, 9.0), 1.96, 1.96]
    assert freedom_of(errors, half) == pytest.approx([9.0, 9.0, 9.0])
