"""Settings from the data: likelihood against joint Gaussians, held-out errors row by row."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.stats import multivariate_normal
from unit.dense import MODELS, drawn, joint, method, narrow
from unit.support import PERIOD as H
from unit.support import encoder_readings

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters.likelihood import (
    best_model,
    best_smoothing,
    held_out_error,
    log_likelihood,
    most_likely,
    noise_of,
)
from scarid_cli.algorithms.processes.matching import over

SHORT = 120


@pytest.mark.parametrize("model", ["white snap", "oscillator"])
def test_the_likelihood_is_that_of_the_joint_gaussian(
    model: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    narrow(monkeypatch)
    q, settings = encoder_readings(40), MODELS[model]
    _, seen = joint(40, settings, 4e-8)
    expected = multivariate_normal(np.full(40, q[0]), seen, allow_singular=True).logpdf(q)
    ours = log_likelihood(method("kalman", settings), q, H) - 20.0 * np.log(2.0 * np.pi)
    assert ours == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_maximum_likelihood_finds_the_noise_of_the_model(seed: int) -> None:
    q = drawn(MODELS["white snap"], 1e-3, 3000, seed)
    fitted = most_likely(DIFFERENTIATORS.load("kalman")(), [q], H)
    assert fitted.noise == pytest.approx(1e-3, rel=0.05)
    assert 0.3 < fitted.intensity / 1e4 < 3.0


@pytest.mark.parametrize("bits", [12, 14])
def test_maximum_likelihood_finds_the_noise_of_an_encoder(bits: int) -> None:
    q = encoder_readings(4000, bits)
    step = 2.0 * np.pi / 2**bits
    assert most_likely(DIFFERENTIATORS.load("kalman")(), [q], H).noise == pytest.approx(
        step / np.sqrt(12.0), rel=0.1
    )


def test_the_noise_of_a_smooth_signal_is_that_of_its_differences() -> None:
    rng = np.random.default_rng(0)
    q = np.sin(3.0 * H * np.arange(4000)) + 1e-3 * rng.standard_normal(4000)
    assert noise_of(q) == pytest.approx(1e-3, rel=0.05)


def test_a_smoother_that_repeats_its_samples_predicts_none_of_them() -> None:
    """An infinite error, not a division by zero; and the search for an intensity goes on."""
    q = encoder_readings(SHORT)
    stiff = DIFFERENTIATORS.load("rts")(noise=1e-9, intensity=1e40)
    assert held_out_error(stiff, q, H) == np.inf
    assert np.isfinite(best_smoothing(stiff, q, H).intensity)


def test_the_held_out_error_is_that_of_leaving_each_sample_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """In the middle of the record, by conditioning on all others, row by row."""
    narrow(monkeypatch)
    settings = {**MODELS["white snap"], "intensity": 1e7}
    q = encoder_readings(SHORT) + 2e-4 * np.random.default_rng(0).standard_normal(SHORT)
    _, seen = joint(SHORT, settings, 4e-8)
    errors = []
    for k in range(SHORT // 4, 3 * SHORT // 4):
        others = np.delete(np.arange(SHORT), k)
        weights = np.linalg.solve(seen[np.ix_(others, others)], seen[others, k])
        errors.append(q[k] - q[0] - weights @ (q[others] - q[0]))
    model = method("rts", settings)
    plain = q - over(model.matched(), q, H)[0]
    pulse = np.zeros(1001)
    pulse[500] = 1.0
    weight = over(model.matched(), pulse, H)[0][500]
    middle = plain[SHORT // 4 : 3 * SHORT // 4] / (1.0 - weight)
    np.testing.assert_allclose(middle, errors, atol=0.02 * np.std(errors))


@pytest.mark.parametrize("seed", range(2))
def test_a_smooth_motion_is_smoothed_more_than_the_likelihood_would(seed: int) -> None:
    """A sum of sines: cross-validation goes most of the way to the settings of the truth."""
    t = H * np.arange(4000)
    w, phase = np.array([1.0, 2.3, 3.1]), np.array([0.0, 1.0, 2.0])
    q = np.sin(np.outer(t, w) + phase).sum(axis=1)
    a = -(np.sin(np.outer(t, w) + phase) * w**2).sum(axis=1)
    seen = q + 2e-4 * np.random.default_rng(seed).standard_normal(4000)
    likely = best_model(DIFFERENTIATORS.load("rts")(), seen, H)
    chosen = best_smoothing(likely, seen, H)

    def error(sensor: Any) -> float:
        return float(np.std((over(sensor, seen, H)[1] - a)[400:-400]))

    decades = np.arange(-6.0, 1.5, 0.25)
    least = min(error(replace(likely, intensity=likely.intensity * 10.0**d)) for d in decades)
    assert error(chosen) < 0.8 * error(likely)
    assert error(chosen) - least < 0.5 * (error(likely) - least)
