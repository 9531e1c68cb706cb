"""The Kalman methods against dense, independent ones: matrices, and Gaussian conditioning."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from unit.dense import MODELS, discrete, joint, method, narrow
from unit.support import PERIOD as H
from unit.support import encoder_readings

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters import kalman, kalman_method
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.arrays import Array

# Rows before the gain settles, and after.
ROWS = 500
every_model = pytest.mark.parametrize("settings", MODELS.values(), ids=MODELS)


def filtered(q: Array, settings: dict[str, float], r: float) -> Array:
    """The textbook's filter in Joseph's form."""
    F, Q = discrete(settings)
    m = len(F)
    x, P, rows = np.eye(m)[0] * q[0], np.diag([r, *[kalman_method.START] * (m - 1)]), []
    for g in q:
        S = P[0, 0] + r
        K = P[:, 0] / S
        x = x + K * (g - x[0])
        L = np.eye(m) - np.outer(K, np.eye(m)[0])
        P = L @ P @ L.T + r * np.outer(K, K)
        rows.append(x)
        x, P = F @ x, F @ P @ F.T + Q
    return np.array(rows)


def alike(found: Array, expected: Array, within: float = 2e-6) -> None:
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=within * np.abs(expected).max())


@every_model
def test_the_model_is_discretised_exactly(settings: dict[str, float]) -> None:
    model = DIFFERENTIATORS.load("kalman")(**settings).model(H)
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


SHORT, LONG = 120, 200


def smoothed(q: Array, settings: dict[str, float], known: Any) -> Array:
    """Each state given the measurements of the rows that are known for it, by conditioning."""
    m, r = int(settings["states"]), 4e-8
    states, seen = joint(len(q), settings, r)
    moved = q - q[0]  # the prior is about the first position
    rows = []
    for k in range(len(q)):
        among = known(k)
        cross = states[k * m : (k + 1) * m, ::m][:, among]
        rows.append(cross @ np.linalg.solve(seen[np.ix_(among, among)], moved[among]))
    return np.array(rows)


@pytest.mark.parametrize("model", ["white jerk", "white snap", "oscillator"])
def test_rts_is_the_state_given_the_whole_record(
    model: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    narrow(monkeypatch)
    q = encoder_readings(SHORT)
    expected = smoothed(q, MODELS[model], lambda _: np.arange(SHORT))
    v, a = over(method("rts", MODELS[model]), q, H)
    alike(v, expected[:, 1])
    alike(a, expected[:, 2])


@pytest.mark.parametrize("model", ["white jerk", "white snap", "oscillator"])
@pytest.mark.parametrize("lag", [1, 10, 40])
def test_kalman_lag_is_the_state_given_the_rows_up_to_the_lag(
    model: str, lag: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    narrow(monkeypatch)
    q = encoder_readings(SHORT)
    expected = smoothed(q, MODELS[model], lambda k: np.arange(min(k + lag + 1, SHORT)))
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


@pytest.mark.parametrize("rows", [1, 3])
@pytest.mark.parametrize("model", ["white jerk", "white snap", "oscillator"])
def test_rts_at_a_glitch_is_the_state_given_all_other_rows(
    model: str, rows: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Long after the gain has settled, which grows again without a measurement."""
    narrow(monkeypatch)
    q = encoder_readings(LONG)
    glitch = np.arange(160, 160 + rows)
    q[glitch] += 0.1
    others = np.delete(np.arange(LONG), glitch)
    expected = smoothed(q, MODELS[model], lambda _: others)
    v, a = over(replace(method("rts", MODELS[model]), gate=20.0), q, H)
    alike(v, expected[:, 1], within=2e-5)
    alike(a, expected[:, 2], within=2e-5)


def test_a_step_that_stays_is_taken_in() -> None:
    q = readings()
    q[1200:] += 0.1
    method = DIFFERENTIATORS.load("kalman")(noise=1.5e-4, intensity=1e3)
    _, rows = kalman.filtered(method.model(H).at_rest(q[0]), q)
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
