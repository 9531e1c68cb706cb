"""The Kalman methods against dense, independent ones: matrices, and Gaussian conditioning."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.stats import multivariate_normal
from unit.support import PERIOD, encoder_readings

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters import kalman
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.algorithms.tuning.likelihood import (
    best_model,
    best_smoothing,
    held_out_error,
    log_likelihood,
    most_likely,
    noise_of,
)
from scarid_cli.arrays import Array

H = PERIOD
# Rows before the gain settles, and after.
ROWS = 500
MODELS: dict[str, dict[str, float]] = {
    "white jerk": {"states": 3, "intensity": 1e3},
    "white snap": {"states": 4, "intensity": 1e4},
    "white crackle": {"states": 5, "intensity": 1e6},
    "oscillator": {"states": 4, "intensity": 1e4, "damping": 1.3, "frequency": 6.0},
    "Matern": {"states": 5, "intensity": 1e6, "damping": 4.0},
}
every_model = pytest.mark.parametrize("settings", MODELS.values(), ids=MODELS)


def continuous(states: int, damping: float = 0.0, frequency: float = 0.0) -> Array:
    """The acceleration process in torque_filter form, below two integrators."""
    s = np.polynomial.Polynomial([damping, 1.0])
    pair = s**2 + frequency**2
    characteristic = {3: s, 4: pair, 5: s * pair}[states].coef
    A = np.diag(np.ones(states - 1), 1)
    A[-1, 2:] = -characteristic[:-1]
    return A


def discrete(settings: dict[str, float]) -> tuple[Array, Array]:
    """Van Loan's method with scipy's matrix exponential."""
    m = int(settings["states"])
    A = continuous(m, settings.get("damping", 0.0), settings.get("frequency", 0.0))
    noise = np.zeros((m, m))
    noise[-1, -1] = settings["intensity"]
    block = expm(H * np.block([[-A, noise], [np.zeros((m, m)), A.T]]))
    F = block[m:, m:].T
    return F, F @ block[:m, m:]


def filtered(q: Array, settings: dict[str, float], r: float) -> Array:
    """The textbook's filter in Joseph's form."""
    F, Q = discrete(settings)
    m = len(F)
    x, P, rows = np.eye(m)[0] * q[0], np.diag([r, *[kalman.START] * (m - 1)]), []
    for g in q:
        S = P[0, 0] + r
        K = P[:, 0] / S
        x = x + K * (g - x[0])
        L = np.eye(m) - np.outer(K, np.eye(m)[0])
        P = L @ P @ L.T + r * np.outer(K, K)
        rows.append(x)
        x, P = F @ x, F @ P @ F.T + Q
    return np.array(rows)


def joint(rows: int, settings: dict[str, float], r: float) -> tuple[Array, Array]:
    """Covariance of all states, stacked, before any measurement; and of all measurements."""
    F, Q = discrete(settings)
    m = len(F)
    P = np.diag([r, *[kalman.START] * (m - 1)])
    cov = np.zeros((rows * m, rows * m))
    for i in range(rows):
        cross = P
        for j in range(i, rows):
            cov[j * m : (j + 1) * m, i * m : (i + 1) * m] = cross
            cov[i * m : (i + 1) * m, j * m : (j + 1) * m] = cross.T
            cross = F @ cross
        P = F @ P @ F.T + Q
    return cov, cov[::m, ::m] + r * np.eye(rows)


def method(name: str, settings: dict[str, float], **more: Any) -> Any:
    return DIFFERENTIATORS.load(name)(**settings, noise=2e-4, gate=np.inf, **more)


def alike(found: Array, expected: Array) -> None:
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=2e-6 * np.abs(expected).max())


@every_model
def test_the_model_is_discretised_exactly(settings: dict[str, float]) -> None:
    model = kalman.Settings(**settings).model(H)  # type: ignore[arg-type]
    for ours, theirs in zip((model.F, model.Q), discrete(settings), strict=True):
        scale = np.sqrt(np.abs(np.outer(np.diag(theirs), np.diag(theirs))))
        np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-9 * scale.max())


@every_model
def test_kalman_is_the_textbooks_filter(settings: dict[str, float]) -> None:
    """From the unknown start on, and long after the gain has settled."""
    q = encoder_readings(ROWS)
    expected = filtered(q, settings, 4e-8)
    v, a = over(method("kalman", settings), q, H)
    alike(v, expected[:, 1])
    alike(a, expected[:, 2])


SHORT = 120


@pytest.fixture
def narrow(monkeypatch: pytest.MonkeyPatch) -> None:
    """A start that is known well enough for dense matrices to bear it."""
    monkeypatch.setattr(kalman, "START", 1.0)


def smoothed(q: Array, settings: dict[str, float], last: Any) -> Array:
    """Each state given the measurements up to the row `last` of it, by conditioning."""
    m, r = int(settings["states"]), 4e-8
    states, seen = joint(len(q), settings, r)
    moved = q - q[0]  # the prior is about the first position
    rows = []
    for k in range(len(q)):
        n = last(k) + 1
        cross = states[k * m : (k + 1) * m, ::m][:, :n]
        rows.append(cross @ np.linalg.solve(seen[:n, :n], moved[:n]))
    return np.array(rows)


@pytest.mark.parametrize("model", ["white jerk", "white snap", "oscillator"])
@pytest.mark.usefixtures("narrow")
def test_rts_is_the_state_given_the_whole_record(model: str) -> None:
    q = encoder_readings(SHORT)
    expected = smoothed(q, MODELS[model], lambda _: SHORT - 1)
    v, a = over(method("rts", MODELS[model]), q, H)
    alike(v, expected[:, 1])
    alike(a, expected[:, 2])


@pytest.mark.parametrize("model", ["white jerk", "white snap", "oscillator"])
@pytest.mark.parametrize("lag", [1, 10, 40])
@pytest.mark.usefixtures("narrow")
def test_kalman_lag_is_the_state_given_the_rows_up_to_the_lag(model: str, lag: int) -> None:
    q = encoder_readings(SHORT)
    expected = smoothed(q, MODELS[model], lambda k: min(k + lag, SHORT - 1))
    v, a = over(method("kalman-lag", MODELS[model], delay=lag * H), q, H)
    alike(v, expected[:, 1])
    alike(a, expected[:, 2])


def test_kalman_lag_goes_on_with_the_settled_gain_as_with_the_exact_one() -> None:
    """Of a long record: the same as the smoother of a whole record that ends with the lag."""
    q, lag = encoder_readings(3000), 30
    v, a = over(method("kalman-lag", MODELS["white snap"], delay=lag * H), q, H)
    for k in (1500, 2500):
        whole = over(method("rts", MODELS["white snap"]), q[: k + lag + 1], H)
        assert v[k] == pytest.approx(whole[0][k], abs=1e-7)
        assert a[k] == pytest.approx(whole[1][k], abs=1e-6)


@pytest.mark.parametrize("model", ["white snap", "oscillator"])
@pytest.mark.usefixtures("narrow")
def test_the_likelihood_is_that_of_the_joint_gaussian(model: str) -> None:
    q, settings = encoder_readings(40), MODELS[model]
    _, seen = joint(40, settings, 4e-8)
    expected = multivariate_normal(np.full(40, q[0]), seen, allow_singular=True).logpdf(q)
    ours = log_likelihood(method("kalman", settings), q, H) - 20.0 * np.log(2.0 * np.pi)
    assert ours == pytest.approx(expected, rel=1e-6)


def drawn(settings: dict[str, float], sigma: float, rows: int, seed: int) -> Array:
    """A motion of the model itself, with white noise."""
    F, Q = discrete(settings)
    rng = np.random.default_rng(seed)
    root = np.linalg.cholesky(Q + 1e-12 * np.diag(np.diag(Q)))
    x, q = np.zeros(len(F)), np.empty(rows)
    for k in range(rows):
        q[k] = x[0] + sigma * rng.standard_normal()
        x = F @ x + root @ rng.standard_normal(len(F))
    return q


@pytest.mark.parametrize("seed", range(3))
def test_maximum_likelihood_finds_the_noise_of_the_model(seed: int) -> None:
    q = drawn(MODELS["white snap"], 1e-3, 3000, seed)
    fitted = most_likely(DIFFERENTIATORS.load("kalman")(), q, H)
    assert fitted.noise == pytest.approx(1e-3, rel=0.05)
    assert 0.3 < fitted.intensity / 1e4 < 3.0


@pytest.mark.parametrize("bits", [12, 14])
def test_maximum_likelihood_finds_the_noise_of_an_encoder(bits: int) -> None:
    q = encoder_readings(4000, bits)
    step = 2.0 * np.pi / 2**bits
    assert most_likely(DIFFERENTIATORS.load("kalman")(), q, H).noise == pytest.approx(
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


@pytest.mark.usefixtures("narrow")
def test_the_held_out_error_is_that_of_leaving_each_sample_out() -> None:
    """In the middle of the record, by conditioning on all others, row by row."""
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


# Glitches


def readings(rows: int = 2000) -> Array:
    return encoder_readings(rows, 14)


@pytest.mark.parametrize("name", ["kalman", "kalman-lag", "rts"])
def test_a_glitch_is_left_out(name: str) -> None:
    """0.1 rad for one sample: without the gate the acceleration jumps by tens of rad/s2."""
    clean, wrong = readings(), readings()
    wrong[1200] += 0.1
    peaks = {}
    for gate in (20.0, np.inf):
        sensor = DIFFERENTIATORS.load(name)(noise=1.5e-4, intensity=1e3, gate=gate)
        a, b = (over(sensor, q, H)[1] for q in (clean, wrong))
        peaks[gate] = np.abs(a - b).max()
    assert peaks[20.0] < 0.2
    assert peaks[np.inf] > 20.0 * peaks[20.0]


def test_a_step_that_stays_is_taken_in() -> None:
    q = readings()
    q[1200:] += 0.1
    _, rows = kalman.filtered(
        kalman.Settings(noise=1.5e-4, intensity=1e3).model(H).at_rest(q[0]), q
    )
    assert np.abs(rows[:, 0] - q)[1500:].max() < 1e-3


@pytest.mark.parametrize("intensity", [1e-2, 1e2, 1e6])
def test_the_gate_does_not_touch_a_clean_record(intensity: float) -> None:
    """Even where the intensity is far too low for the motion."""
    q = readings()
    gated, free = (
        over(DIFFERENTIATORS.load("kalman")(noise=1.5e-4, intensity=intensity, gate=g), q, H)[1]
        for g in (20.0, np.inf)
    )
    np.testing.assert_array_equal(gated, free)
