"""The deadbeat differentiator, and adaptive input and state estimation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from unit.support import PERIOD, derivatives, encoder_readings, sine

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.differentiators import aise, deadbeat
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

# The deadbeat differentiator


@pytest.mark.parametrize("states", [3, 4, 5])
def test_deadbeat_is_exact_on_a_polynomial_from_its_first_estimate_on(states: int) -> None:
    t = PERIOD * np.arange(400)
    path = np.polynomial.Polynomial([0.3, 2.0, -1.5, 0.7, 0.4][:states])
    v, a = derivatives(deadbeat.Differentiator(states=states), path(t))
    first = round(0.05 / PERIOD)
    assert np.all(v[:first] == 0.0)
    np.testing.assert_allclose(v[first:], path.deriv(1)(t)[first:], rtol=0.0, atol=1e-7)
    np.testing.assert_allclose(a[first:], path.deriv(2)(t)[first:], rtol=0.0, atol=1e-5)


@pytest.mark.parametrize("states", [3, 4, 5])
def test_deadbeat_is_a_linear_observer_after_its_start(states: int) -> None:
    """Against the observer of Ackermann's formula, which no Volterra operator led to."""
    method = deadbeat.Differentiator(states=states)
    q = 1.0 + encoder_readings(2000)
    found = derivatives(method, q)
    expected = derivatives(deadbeat.AfterStart(method), q)
    for ours, theirs in zip(found, expected, strict=True):
        np.testing.assert_allclose(ours[400:], theirs[400:], rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("t", [0.02, 0.1, 0.5])
def test_deadbeat_weights_are_derivatives_of_an_annihilating_kernel(t: float) -> None:
    pole, rise, m = 50.0, 40.0, 4

    def kernel(s: Array) -> Array:
        return np.asarray(np.exp(-pole * (t - s)) * (1.0 - np.exp(-rise * s)) ** m)

    near = np.polynomial.Chebyshev.interpolate(kernel, 20, domain=[t - 0.01, t + 0.01])
    weight = deadbeat.weights(np.array([pole]), rise, m, np.array([t]))[0, 0]
    assert weight == pytest.approx(float(near.deriv(m)(t)) / pole**m, rel=1e-6)
    start = np.polynomial.Chebyshev.interpolate(kernel, 20, domain=[-0.01, 0.01])
    for order in range(m):
        assert abs(start.deriv(order)(0.0)) < 1e-8 * abs(start.deriv(m)(0.0))


def test_deadbeat_refuses_a_memory_of_hours() -> None:
    with pytest.raises(UsageFault, match="bandwidth must be larger"):
        deadbeat.Differentiator(bandwidth=1e-3).init(0.0, PERIOD)


# Adaptive input and state estimation


def written_out(method: aise.Differentiator, q: Array, h: float) -> tuple[Array, Array]:
    """The equations of docs/theory.md with matrices, as they are written there."""
    n, window, size = method.order, round(method.window / h), 2 * method.order + 1
    A, B, C = np.array([[1.0, h], [0.0, 1.0]]), np.array([h * h / 2.0, h]), np.array([1.0, 0.0])
    x, P = np.array([q[0], 0.0]), np.zeros((2, 2))
    theta, information = np.zeros(size), method.prior * np.eye(size)
    right = np.zeros(size)
    z, d, closed, rows = [], [], [], []
    v, a = np.empty_like(q), np.empty_like(q)
    for k, g in enumerate(q):
        z.append(float(C @ x - g))
        P = A @ P @ A.T
        left = float(np.var(z)) - P[0, 0]
        eta, noise = method.low, 0.0
        if left > eta:
            extremes = max(left - method.high, 0.0), left - method.low
            noise = method.share * extremes[0] + (1.0 - method.share) * extremes[1]
            eta = left - noise
        P = P + eta * np.eye(2)
        gain = P @ C / (C @ P @ C + noise)
        x, P = x - gain * z[k], P - np.outer(gain, C @ P)
        row = [d[k - i] if k >= i else 0.0 for i in range(1, n + 1)]
        rows.append(np.array(row + [z[k - i] if k >= i else 0.0 for i in range(n + 1)]))
        filtered, caused, before = np.zeros(size), 0.0, C
        for i in range(1, min(window, k) + 1):
            filtered += before @ B * rows[k - i]
            caused += before @ B * d[k - i]
            before = before @ closed[k - i]
        closed.append(A @ (np.eye(2) - np.outer(gain, C)))
        d.append(float(rows[k] @ theta))
        information += np.outer(filtered, filtered)
        information += method.bandwidth**-4.0 * np.outer(rows[k], rows[k])
        right += filtered * (caused - z[k])
        theta = np.linalg.solve(information, right)
        v[k], a[k] = x[1], d[k]
        x = A @ x + B * d[k]
    return v, a


@pytest.mark.parametrize(
    "settings", [{}, {"order": 3, "window": 0.03}, {"high": 1e-6, "share": 0.3, "bandwidth": 40.0}]
)
def test_aise_is_what_is_written(settings: dict[str, Any]) -> None:
    """Up to the rounding of the least squares, whose coefficients differ by orders of magnitude."""
    method, q = aise.Differentiator(**settings), encoder_readings(300)
    for ours, theirs in zip(derivatives(method, q), written_out(method, q, PERIOD), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-4 * np.abs(theirs).max())


def test_aise_adapts_to_a_motion_that_its_filter_does_not_know() -> None:
    q, v, a = sine(6000, omega=3.0)
    got_v, got_a = derivatives(aise.Differentiator(), q)
    wrong = np.abs(got_a - a)
    assert wrong[4000:].max() < 0.2 * np.abs(a).max() < np.abs(a).max() < wrong[:1000].max()
    assert np.abs(got_v - v)[4000:].max() < 0.1 * np.abs(v).max()


def test_the_weight_of_the_input_is_the_bandwidth_of_aise() -> None:
    """It promises to choose by itself; the noise of the acceleration shows that it does not."""
    q = encoder_readings(8000, bits=16)
    _, _, a = sine(8000, omega=3.0)
    noise = []
    for bandwidth in (90.0, 300.0):
        found = derivatives(aise.Differentiator(bandwidth=bandwidth), q)[1]
        noise.append(float(np.std(np.diff((found - a)[4000:]))))
    assert noise[1] > 3.0 * noise[0]


def test_aise_stays_bounded_at_standstill() -> None:
    step = 2.0 * np.pi / 2**13
    q = step * np.random.default_rng(0).integers(0, 2, 60_000).astype(float)
    v, a = derivatives(aise.Differentiator(), q)
    assert np.abs(v[2000:]).max() < 0.5
    assert np.abs(a[2000:]).max() < 20.0


def test_aise_refuses_a_window_without_samples() -> None:
    with pytest.raises(UsageFault, match="window must be 2 to"):
        DIFFERENTIATORS.load("aise")(window=0.001).init(0.0, PERIOD)
