"""Rows whitened in time, against a Cholesky factor, statsmodels, and noise that is known."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
import scipy.signal
import statsmodels.api as sm
from scipy.integrate import quad
from unit.regressions import estimated

from scarid_cli.algorithms.effects.effects import Trial
from scarid_cli.algorithms.estimators import gls, wls
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.regression.whitening import ColouredNoise
from scarid_cli.algorithms.uncertainty.jackknife import jackknife
from scarid_cli.arrays import Array

H = 0.01  # s
BANDWIDTH = 12.5  # Hz: four rows per period of it are half of the rows
THETA = np.array([2.0, -1.0, 0.5])


def smooth(rng: np.random.Generator, *shape: int) -> Array:
    """Random signals (samples first) of unit variance below the bandwidth."""
    sections = scipy.signal.butter(8, 0.5 * BANDWIDTH, fs=1.0 / H, output="sos")
    x = scipy.signal.sosfiltfilt(sections, rng.standard_normal(shape), axis=0)
    return np.asarray(x / x.std())


def swinging(rng: np.random.Generator, samples: int, joints: int) -> Array:
    """Noise of two hertz, and a little white noise behind the bandwidth."""
    pole = 0.98 * np.exp(2.0j * np.pi * 2.0 * H)
    x = rng.standard_normal((samples + 500, joints))
    slow = scipy.signal.lfilter([1.0], np.poly([pole, pole.conj()]).real, x, axis=0)[500:]
    return np.asarray(slow / slow.std() + 0.1 * smooth(rng, samples, joints))


def rows_with(noise: Array, rng: np.random.Generator, *, size: float = 0.3) -> Rows:
    """Rows of a regression with this noise, all of which count."""
    samples, joints = noise.shape
    W = smooth(rng, samples, joints, len(THETA))
    y, motion = W @ THETA + size * noise, np.zeros((4, joints, samples))
    return Rows(W, y, np.ones_like(y), np.arange(samples), H, motion, bandwidth=BANDWIDTH)


def noise_of(seed: int = 0, samples: int = 2000) -> ColouredNoise:
    rng = np.random.default_rng(seed)
    return ColouredNoise.of(rows_with(swinging(rng, samples, 2), rng), THETA)


def beyond(lag: int, interval: float) -> float:
    """The autocovariance of white noise above the bandwidth, of three times the density below."""
    cutoff, highest = BANDWIDTH / (2.0**0.5 - 1.0) ** 0.125, 0.5 / interval

    def passed(f: float) -> float:
        return float((1.0 + (f / cutoff) ** 8) ** -2)

    def missing(f: float) -> float:
        return float((1.0 - passed(f)) * np.cos(2.0 * np.pi * f * lag * interval))

    return 3.0 * quad(missing, 0.0, highest, limit=200)[0] / quad(passed, 0.0, highest)[0]


@pytest.mark.parametrize("step", [1, 2])
def test_a_run_is_multiplied_by_the_inverse_cholesky_factor(step: int) -> None:
    noise, A = noise_of(), np.random.default_rng(1).standard_normal((40, 2, 3))
    white = noise.whitened(A.copy(), np.ones((40, 2), dtype=bool), step * np.arange(40), H)
    for j in range(2):
        gamma = noise.autocovariance[j, ::step][:40]
        gamma = gamma + gamma[0] * np.array([beyond(k, step * H) for k in range(40)])
        gamma[0] *= 1.001
        factor = scipy.linalg.cholesky(scipy.linalg.toeplitz(gamma), lower=True)
        expected = scipy.linalg.solve_triangular(factor, A[:, j], lower=True)
        np.testing.assert_allclose(white[:, j], expected, rtol=1e-3, atol=1e-3)


def test_after_a_gap_and_after_rows_that_do_not_count_nothing_is_predicted() -> None:
    noise, A = noise_of(), np.random.default_rng(1).standard_normal((200, 2, 3))
    at = np.arange(200) + 7 * (np.arange(200) >= 130)
    counts = np.ones((200, 2), dtype=bool)
    counts[50:60, 1] = False
    white = noise.whitened(A.copy(), counts, at, H)
    every = np.ones((200, 2), dtype=bool)
    for joint, parts in ((0, (slice(0, 130), slice(130, 200))),
                         (1, (slice(0, 50), slice(60, 130), slice(130, 200)))):  # fmt: skip
        for part in parts:
            alone = noise.whitened(A[part].copy(), every[part], at[part], H)
            np.testing.assert_allclose(white[part, joint], alone[:, joint], rtol=1e-12, atol=1e-12)
    assert not white[50:60, 1].any()


def test_the_autocovariance_is_that_of_the_residual() -> None:
    rng = np.random.default_rng(0)
    a = 0.9
    slow = scipy.signal.lfilter([1.0], [1.0, -a], rng.standard_normal((100_000, 1)), axis=0)
    rows = rows_with(slow, rng, size=1.0)
    rows.scales[10_000:20_000] = 0.0
    rows.y[10_000:20_000] = 1e3  # of rows that do not count
    gamma = ColouredNoise.of(rows, THETA).autocovariance[0]
    assert len(gamma) == 200  # 2 s
    lags = np.arange(20)
    np.testing.assert_allclose(gamma[lags], a**lags / (1.0 - a**2), atol=0.05 / (1.0 - a**2))


def test_lags_of_a_short_record_are_a_twentieth_of_it() -> None:
    assert noise_of(samples=1000).autocovariance.shape == (2, 50)


def test_the_spectrum_is_flat_behind_it() -> None:
    rng = np.random.default_rng(2)
    x = swinging(rng, 20_000, 1)
    every, counts = np.arange(0, len(x), 2), np.ones((len(x) // 2, 1), dtype=bool)
    noise = ColouredNoise.of(rows_with(x, rng), THETA)
    white = noise.whitened(x[every, :, None], counts, every, H)[:, 0, 0]
    flatness = []
    for signal in (x[every, 0], white):
        f, density = scipy.signal.welch(signal, 0.5 / H, nperseg=256)
        inside = density[(f > 0.3) & (f < 5.0)]
        flatness.append(float(inside.max() / inside.min()))
    assert flatness[0] > 100.0
    assert flatness[1] < 4.0


def test_four_rows_are_kept_for_each_period_of_the_bandwidth() -> None:
    rng = np.random.default_rng(0)
    rows = rows_with(swinging(rng, 2000, 2), rng)
    noise = ColouredNoise.of(rows, THETA)
    assert noise.rows(rows).at.tolist() == list(range(0, 2000, 2))


def test_white_noise_leaves_the_estimates_of_wls() -> None:
    rng = np.random.default_rng(0)
    rows = rows_with(smooth(rng, 2000, 2), rng)
    found, plain = estimated(gls.Estimator(), rows), wls.Estimator().of_rows(rows)
    assert found.extra == {"whitened": False}
    assert found.fit.estimates.tolist() == plain.fit.estimates.tolist()
    assert found.scores is not None
    assert found.scores.noise is None


def errors(seed: int) -> tuple[Array, Array, Array, Array]:
    """The errors of gls, of wls and of GLS with the true covariance; the stated ones of gls."""
    rng = np.random.default_rng(seed)
    samples = 1000
    rows = rows_with(swinging(rng, samples, 1), rng)
    found = estimated(gls.Estimator(), rows)
    assert found.extra == {"whitened": True}
    long = swinging(np.random.default_rng(10**6), 400_000, 1)[:, 0]
    gamma = np.array([long[k:] @ long[: len(long) - k] for k in range(400)]) / len(long)
    gamma = np.append(gamma * np.linspace(1.0, 0.0, 400), np.zeros(samples - 400))
    gamma[0] += 1e-3
    ideal = sm.GLS(rows.y[:, 0], rows.W[:, 0], sigma=scipy.linalg.toeplitz(gamma)).fit()
    assert found.scores is not None
    assert found.scores.noise is not None
    stated = jackknife(found.scores.noise.rows(rows), found).errors
    plain = estimated(wls.Estimator(), rows).fit.estimates
    return found.fit.estimates - THETA, plain - THETA, ideal.params - THETA, stated


def test_estimates_are_nearly_those_of_the_true_covariance_and_the_errors_hold() -> None:
    found, plain, ideal, stated = (np.array(x) for x in zip(*map(errors, range(20)), strict=True))
    rms = [float(np.sqrt(np.mean(x**2))) for x in (found, plain, ideal)]
    assert rms[0] < 0.4 * rms[1]
    assert rms[0] < 1.3 * rms[2]
    assert 0.8 < float(np.sqrt(np.mean((found / stated) ** 2))) < 1.25


def test_alternatives_are_fitted_to_the_whitened_rows() -> None:
    rng = np.random.default_rng(0)
    rows = rows_with(swinging(rng, 2000, 1), rng)
    found = estimated(gls.Estimator(), rows)
    assert found.scores is not None
    noise = found.scores.noise
    assert noise is not None
    trial = Trial.of(rows, len(THETA), np.ones(1), found.fit.estimates, noise=noise)
    effects = trial.effects()
    (offset,) = (effect for effect in effects if effect.name == "offset")
    kept = slice(None, None, 2)
    A = np.concatenate((rows.W, np.ones((2000, 1, 1)), rows.y[:, :, None]), axis=2)[kept]
    white = noise.whitened(A.copy(), np.ones((1000, 1), dtype=bool), rows.at[kept], H)[:, 0]
    without, beside = (
        np.linalg.lstsq(white[:, chosen], white[:, 4])[0] for chosen in ([0, 1, 2], [0, 1, 2, 3])
    )
    np.testing.assert_allclose(offset.moved, beside[:3] - without, rtol=1e-6, atol=1e-12)
