"""One bandwidth for all methods: each is the filter that the chosen cut-off stands for."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters.butterworth import Butterworth
from scarid_cli.algorithms.processes.bandwidth import (
    bandwidth_of,
    lowpass_bandwidth,
    velocity_noise,
)
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.algorithms.tuning.equivalent import equivalent
from scarid_cli.algorithms.tuning.lowpassed import TWO_SIDED

H = 1e-3
CUTOFF = 12.0
LINEAR = [
    name
    for name in DIFFERENTIATORS.names
    if name not in {"spline", "rts", "backward"} and bandwidth_of(DIFFERENTIATORS.load(name)(), H)
]


def smooth_signal(rows: int = 4000) -> np.ndarray:
    rng = np.random.default_rng(0)
    return np.cumsum(np.cumsum(rng.standard_normal(rows))) * 1e-3


def test_the_bandwidth_of_a_butterworth_filter_is_its_cutoff() -> None:
    assert lowpass_bandwidth(Butterworth(CUTOFF), H) == pytest.approx(CUTOFF, rel=1e-3)


@pytest.mark.parametrize("name", [*LINEAR, "rts"])
def test_every_linear_method_gets_the_bandwidth_of_the_cutoff(name: str) -> None:
    """Within the step of a window of whole samples, and of a smoother of fixed lag."""
    method = DIFFERENTIATORS.load(name)()
    found = equivalent(method, 1e-4, CUTOFF, H)
    assert found is not None
    wanted = CUTOFF if method.lag(H) == 0 else TWO_SIDED * CUTOFF
    torque_filter = found.matched().torque_filter
    assert torque_filter is not None
    rel = 0.08 if name == "kalman-lag" else 0.02
    assert lowpass_bandwidth(torque_filter, H) == pytest.approx(wanted, rel=rel)


@pytest.mark.parametrize("name", ["2smd", "levant", "filtering", "central", "backward", "spline"])
def test_a_method_without_bandwidth_has_no_equivalent(name: str) -> None:
    assert equivalent(DIFFERENTIATORS.load(name)(), 1e-4, CUTOFF, H) is None


def test_the_smoother_of_the_chain_is_the_zero_phase_butterworth_filter() -> None:
    """Away from the ends: signals of any bandwidth come out alike."""
    rts = equivalent(DIFFERENTIATORS.load("rts")(), 1e-2, CUTOFF, H)
    assert rts is not None
    x = smooth_signal()
    q, dq, ddq = over(rts.matched(), x, H)
    b, a = signal.butter(4, CUTOFF, fs=1.0 / H)
    expected = signal.filtfilt(b, a, x, padlen=600)
    inner = slice(600, -600)
    size = np.std(x - expected)
    assert np.abs(q - expected)[inner].max() < 0.02 * size
    for found, order in ((dq, 1), (ddq, 2)):
        derivative = expected
        for _ in range(order):
            derivative = np.gradient(derivative, H)
        error = np.std((found - derivative)[inner]) / np.std(derivative[inner])
        assert error < 0.01


def test_the_causal_chain_is_the_butterworth_filter() -> None:
    kalman = equivalent(DIFFERENTIATORS.load("kalman")(), 1e-2, CUTOFF, H)
    assert kalman is not None
    torque_filter = kalman.matched().torque_filter
    assert torque_filter is not None
    x = smooth_signal()
    found = over(torque_filter, x, H)[0]
    expected = over(Butterworth(CUTOFF), x, H)[0]
    inner = slice(600, None)
    # Its differences need a sample more, and a pole in discrete time differs a little.
    assert np.std((found - expected)[inner]) < 0.05 * np.std((x - expected)[inner])


def test_the_noise_of_the_velocity_is_that_behind_a_lowpass() -> None:
    rng = np.random.default_rng(0)
    x = 1e-3 * rng.standard_normal(200_000)
    v = over(DIFFERENTIATORS.load("zero-phase")(cutoff=20.0), x, H)[0]
    assert np.std(v) == pytest.approx(velocity_noise(1e-3, TWO_SIDED * 20.0, H), rel=0.15)
