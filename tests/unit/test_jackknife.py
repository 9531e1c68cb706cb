"""Errors that hold for autocorrelated residuals, and the residuals themselves."""

from __future__ import annotations

from itertools import accumulate

import numpy as np
import pytest
import scipy.stats
from conftest import seeds
from unit.regressions import estimated
from unit.slow_motions import THETA, H, P, least_squares, regression, smooth

from scarid_cli.algorithms.estimators import irls, ml, rls, tls, wls
from scarid_cli.algorithms.inference.diagnostics import Diagnosis
from scarid_cli.algorithms.regression.rows import faded, plain
from scarid_cli.algorithms.uncertainty.autocovariance import autocovariance_errors
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.algorithms.uncertainty.jackknife import (
    inflation,
    interval_quantiles,
    jackknife,
    quantile,
)
from scarid_cli.algorithms.uncertainty.residuals import residuals
from scarid_cli.arrays import Array


def test_leaving_blocks_out_is_a_refit_without_them() -> None:
    """The first-order formula is exact for least squares: against refits without each block."""
    rows = regression()
    found = least_squares(rows)
    covariance = jackknife(rows, found)
    blocks, refits = covariance.blocks, []
    for b in range(blocks):
        kept = np.arange(rows.samples) * blocks // rows.samples != b
        refit = least_squares(plain(rows.W[kept], rows.y[kept])).fit
        refits.append(refit.estimates - found.fit.estimates)
    expected = (blocks - 1) / blocks * np.array(refits).T @ np.array(refits)
    np.testing.assert_allclose(covariance.matrix, expected, rtol=1e-8)


def test_errors_of_autocorrelated_residuals_are_those_that_occur() -> None:
    """Over 300 experiments: the robust ones are right, those of white residuals far too small."""
    runs = []
    for seed in range(300):
        rows = regression(seed=seed)
        found = least_squares(rows)
        errors = jackknife(rows, found).errors
        runs.append((found.fit.estimates - THETA, errors, found.fit.standard_errors()))
    errors, robust, white = (np.array(x) for x in zip(*runs, strict=True))
    occurred = errors.std(axis=0)
    np.testing.assert_allclose(np.median(robust, axis=0), occurred, rtol=0.2)
    assert np.all(np.median(white, axis=0) < 0.4 * occurred)


def test_errors_of_white_residuals_are_the_classical_ones() -> None:
    rows = regression(20_000, coloured=False)
    found = least_squares(rows)
    errors = jackknife(rows, found).errors
    np.testing.assert_allclose(errors, found.fit.standard_errors(), rtol=0.25)


@pytest.mark.parametrize("estimator", [wls, ml, irls], ids=["wls", "ml", "irls"])
def test_robust_errors_follow_the_weights_of_the_estimator(estimator: object) -> None:
    """White noise: they are near the classical ones, for which the weights are as they are."""
    rng = np.random.default_rng(0)
    W = np.stack([smooth(8000, P, rng) for _ in range(2)], axis=1)
    rows = plain(W, W @ THETA + rng.standard_normal((8000, 2)) * [10.0, 0.1], H)
    found = estimated(estimator.Estimator(), rows)  # type: ignore[attr-defined]
    errors = jackknife(rows, found).errors
    np.testing.assert_allclose(errors, found.fit.standard_errors(), rtol=0.25)


def test_the_inflation_of_least_squares_is_that_of_its_errors() -> None:
    """From the products of blocks, against the rows themselves."""
    rows = regression()
    found = least_squares(rows)
    blocks, ratio = inflation(Blocks.every(H).add(rows).whole(), rows)
    robust = jackknife(rows, found)
    assert blocks == robust.blocks
    np.testing.assert_allclose(ratio, robust.errors / found.fit.standard_errors(), rtol=0.05)


def test_an_estimator_without_scores_is_examined_all_the_same() -> None:
    """Its residual is there, and its errors are not taken for those of white noise."""
    rows = regression(4000)
    found = estimated(tls.Estimator(), rows)
    judged = Diagnosis(rows, found, P).diagnostics
    assert judged.covariance is None
    left = (rows.y - rows.W @ found.fit.estimates)[:, 0]
    about = np.sum((rows.y - rows.y.mean()) ** 2)
    assert judged.joints[0].r2 == pytest.approx(1.0 - left @ left / about)
    assert judged.effects
    assert np.all(judged.errors > 2.0 * found.fit.standard_errors())


def test_errors_of_an_estimate_that_forgets_are_those_that_occur() -> None:
    """Over 200 experiments, with a memory of two seconds: four effective blocks and more."""
    forgetful = rls.Estimator(forgetting=0.9975, p0=1e6)
    runs = []
    for seed in range(200):
        rows = regression(2000, seed=seed)
        found = estimated(forgetful, rows)
        covariance = jackknife(faded(rows, 0.9975), found)
        runs.append((found.fit.estimates - THETA, covariance.errors))
    assert 5.0 < covariance.effective < 10.0
    errors, stated = (np.array(x) for x in zip(*runs, strict=True))
    np.testing.assert_allclose(np.median(stated, axis=0), errors.std(axis=0), rtol=0.4)


def lasting(samples: int, time: float, rng: np.random.Generator) -> Array:
    """A first-order Gauss-Markov process of variance 1 with this correlation time [s]."""
    keep = np.exp(-H / time)
    noise = np.sqrt(1.0 - keep**2) * rng.standard_normal(samples)
    noise[0] = rng.standard_normal()
    return np.array(list(accumulate(noise.tolist(), lambda x, shock: keep * x + shock)))


@pytest.mark.parametrize("unit", [1e-9, 1e-4, 1e5, 1e10])
def test_errors_of_disturbances_that_last_have_the_unit_of_their_parameters(unit: float) -> None:
    """A column in another unit, as that of a delay beside torques in mN m, changes no other."""
    rng = np.random.default_rng(3)
    W = np.column_stack([np.ones(2000), smooth(2000, 2, rng, reach=100)])
    y = W @ [1.0, 2.0, 3.0] + lasting(2000, 2.0, rng)
    errors = []
    for factor in (1.0, unit):
        rows = plain((W * [1.0, factor, 1.0])[:, None, :], y[:, None], H)
        estimates = least_squares(rows).fit.estimates
        errors.append(autocovariance_errors(rows, estimates, np.ones(1)) * [1.0, factor, 1.0])
    np.testing.assert_allclose(errors[1], errors[0], rtol=1e-6)


def test_errors_of_disturbances_that_last_are_those_that_occur() -> None:
    """Disturbances of two seconds in blocks of half a second, on columns that are as slow."""
    runs = []
    for seed in seeds(50, 100):
        rng = np.random.default_rng(seed)
        W = np.column_stack([np.ones(8000), smooth(8000, 1, rng, reach=400)])
        y = W @ [1.0, 2.0] + lasting(8000, 2.0, rng)
        rows = plain(W[:, None, :], y[:, None], H)
        found = least_squares(rows)
        long = autocovariance_errors(rows, found.fit.estimates, np.ones(1))
        runs.append((found.fit.estimates - [1.0, 2.0], long, jackknife(rows, found).errors))
    occurred, long, short = (np.array(x) for x in zip(*runs, strict=True))
    ratio = np.median(long, axis=0) / occurred.std(axis=0)
    assert np.all(ratio > 0.75)
    assert np.all(np.median(short, axis=0) < 0.8 * np.median(long, axis=0))


@pytest.mark.parametrize("samples", [2000, 4000])
def test_errors_of_disturbances_that_a_short_record_shows_a_few_times(samples: int) -> None:
    """Of two joints over 200 records of five or ten correlation times; the first often show none.

    Errors of joints by themselves, with the variances as they seem, are exceeded 1.3 to 1.6 times.
    """
    truth, ratios = np.arange(1.0, 5.0), []
    for seed in seeds(70, 200):
        rng = np.random.default_rng(seed)
        W = np.zeros((samples, 2, 4))
        for joint in range(2):
            W[:, joint, 2 * joint] = 1.0
            W[:, joint, 2 * joint + 1] = smooth(samples, 1, rng, reach=40)[:, 0]
        noise = [lasting(samples, 2.0, rng) + rng.standard_normal(samples) for _ in range(2)]
        rows = plain(W, W @ truth + np.column_stack(noise), H)
        estimates = least_squares(rows).fit.estimates
        errors = autocovariance_errors(rows, estimates, np.ones(2))
        ratios.append((estimates - truth) / errors)
    sizes = np.sqrt(np.mean(np.square(ratios), axis=0))
    assert np.all((sizes > 0.75) & (sizes < 1.1))
    assert np.mean(np.abs(ratios) > 3.0) < 0.015


@pytest.mark.parametrize("freedom", [5, 9, 19, 39, 127])
def test_quantiles_of_student_are_those_of_scipy(freedom: int) -> None:
    assert quantile(0.975, freedom) == pytest.approx(scipy.stats.t.ppf(0.975, freedom), rel=2e-3)


def test_residual_facts_are_those_of_numpy() -> None:
    rows = regression()
    found = least_squares(rows)
    (joint,) = residuals(rows, found.fit.estimates)
    residual = (rows.y - rows.W @ found.fit.estimates)[:, 0]
    y = rows.y[:, 0]
    assert joint.rows == len(y)
    assert joint.r2 == pytest.approx(1.0 - residual.var() / y.var(), abs=1e-3)
    assert joint.deviation == pytest.approx(np.sqrt(np.mean(residual**2)))
    neighbours = np.corrcoef(residual[1:], residual[:-1])[0, 1]
    assert joint.autocorrelation == pytest.approx(neighbours, abs=0.01)
    assert joint.kurtosis == pytest.approx(scipy.stats.kurtosis(residual))


def test_the_residual_of_a_long_record_is_that_of_all_its_rows() -> None:
    """A subsample misses the half with more noise; the products of the blocks do not."""
    rows = regression(4000)
    rows.y[2000:] += 3.0 * smooth(2000, 1, np.random.default_rng(5))
    theta = least_squares(rows).fit.estimates
    record = Blocks.every(H).add(rows).whole()
    (whole,) = residuals(rows, theta)
    (found,) = residuals(rows.part(slice(0, 2000)), theta, record)
    for fact in ("rows", "r2", "deviation", "relative_error", "torque"):
        assert getattr(found, fact) == pytest.approx(getattr(whole, fact), rel=1e-9), fact


def test_errors_of_a_long_record_are_those_of_its_rows() -> None:
    """By blocks, and by the rows themselves: blocks end elsewhere, so to a tenth."""
    rows = regression(40_000)
    found = least_squares(rows)
    by_rows = Diagnosis(rows, found, P).diagnostics
    by_blocks = Diagnosis(rows, found, P, Blocks.every(H).add(rows).whole()).diagnostics
    np.testing.assert_allclose(by_blocks.errors, by_rows.errors, rtol=0.3)
    assert by_blocks.errors.mean() == pytest.approx(by_rows.errors.mean(), rel=0.1)


def test_intervals_allow_once_for_errors_that_are_not_well_known() -> None:
    """Student's t for those of ten blocks, 1.96 for larger ones, and no less than those of blocks.

    Errors of long disturbances allow for it themselves.
    """
    student, normal = scipy.stats.t.ppf(0.975, 9), scipy.stats.norm.ppf(0.975)
    found = interval_quantiles(10.0, np.array([1.0, 1.1, 1.5]))
    assert found == pytest.approx([student, student / 1.1, normal], rel=2e-3)
