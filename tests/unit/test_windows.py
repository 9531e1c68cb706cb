"""Methods that others have too, against theirs: scipy's, and AlgDiff's where it is installed."""

from __future__ import annotations

from math import exp
from typing import Any

import numpy as np
import pytest
from scipy import signal
from scipy.interpolate import UnivariateSpline
from unit.support import PERIOD, derivatives, encoder_readings

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.differentiators import algebraic
from scarid_cli.algorithms.filters.likelihood import noise_of
from scarid_cli.algorithms.processes.matching import over

load = DIFFERENTIATORS.load


def noisy(rows: int = 600) -> Any:
    return encoder_readings(rows) + 1e-4 * np.random.default_rng(1).standard_normal(rows)


@pytest.mark.parametrize(("window", "degree"), [(81, 5), (21, 3), (7, 2), (41, 4)])
def test_savgol_is_scipys_filter_edges_included(window: int, degree: int) -> None:
    q = noisy()
    found = derivatives(load("savgol")(window=window, degree=degree), q)
    for order, ours in enumerate(found, start=1):
        theirs = signal.savgol_filter(q, window, degree, deriv=order, delta=PERIOD, mode="interp")
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-9 * np.abs(theirs).max())


@pytest.mark.parametrize(("window", "degree"), [(45, 3), (44, 3), (15, 2), (61, 4)])
def test_savgol_end_has_scipys_coefficients(window: int, degree: int) -> None:
    for order, taps in enumerate(load("savgol-end")(window, degree).taps(PERIOD), start=1):
        theirs = signal.savgol_coeffs(
            window, degree, deriv=order, delta=PERIOD, pos=window - 1, use="dot"
        )
        np.testing.assert_allclose(taps[::-1], theirs, rtol=0.0, atol=1e-9 * np.abs(theirs).max())


@pytest.mark.parametrize(("cutoff", "order"), [(8.0, 4), (20.0, 2)])
def test_zero_phase_is_sosfiltfilt_and_central_differences(cutoff: float, order: int) -> None:
    q = noisy()
    sections = signal.butter(order, cutoff, fs=1.0 / PERIOD, output="sos")
    u = signal.sosfiltfilt(sections, q, padlen=3 * order)
    v, a = derivatives(load("zero-phase")(cutoff=cutoff, order=order), q)
    np.testing.assert_allclose(v, np.gradient(u, PERIOD), rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(a[1:-1], np.diff(u, 2) / PERIOD**2, rtol=0.0, atol=1e-7)


@pytest.mark.parametrize("noise", [0.0, 3e-4])
def test_spline_is_fitpacks_with_as_much_residual_as_noise(noise: float) -> None:
    q, t = noisy(), np.arange(600) * PERIOD
    theirs = UnivariateSpline(t, q, k=5, s=600 * (noise or noise_of(q)) ** 2)
    v, a = derivatives(load("spline")(noise=noise), q)
    np.testing.assert_array_equal(v, theirs(t, 1))
    np.testing.assert_array_equal(a, theirs(t, 2))


@pytest.mark.parametrize("states", [3, 4, 5])
def test_high_gain_has_all_its_poles_in_one_place(states: int) -> None:
    """Its response to a pulse is a polynomial times pole^k: the filter (1 - pole / z)^m ends it."""
    method = load("high-gain")(bandwidth=30.0, states=states)
    pulse = np.zeros(400)
    pulse[10] = 1e-3
    _, a = derivatives(method, pulse)
    pole = exp(-30.0 * PERIOD)
    ended = signal.lfilter(np.poly([pole] * states), [1.0], a)
    assert np.abs(ended[:20]).max() > 0.1
    np.testing.assert_allclose(ended[10 + states + 1 :], 0.0, atol=1e-9 * np.abs(a).max())


def test_high_gain_follows_a_constant_acceleration() -> None:
    t = np.arange(1000) * PERIOD
    v, a = derivatives(load("high-gain")(), 0.5 * 3.0 * t**2)
    assert v[-1] == pytest.approx(3.0 * t[-1], rel=1e-9)
    assert a[-1] == pytest.approx(3.0, rel=1e-9)


def test_tracking_is_linear_below_its_limits() -> None:
    q = encoder_readings(600) - encoder_readings(600)[0]
    pole = PERIOD / 0.02
    stage = [0.0, pole**2 / PERIOD, -(pole**2) / PERIOD], [1.0, 2 * pole - 2, (1 - pole) ** 2]
    v = signal.lfilter([*stage[0][1:], 0.0], stage[1], q)
    v_found, a_found = derivatives(load("tracking")(limit=1e6, jerk=1e9), q)
    np.testing.assert_allclose(v_found, v, rtol=0.0, atol=1e-9)
    a = signal.lfilter([*stage[0][1:], 0.0], stage[1], v)
    np.testing.assert_allclose(a_found, a, rtol=0.0, atol=1e-7)


def test_tracking_never_accelerates_beyond_its_limit() -> None:
    """And goes to a step without overshoot."""
    step = np.concatenate((np.zeros(10), np.ones(990)))
    method = load("tracking")(limit=20.0)
    _, first, _ = method.stages(method.init(0.0, PERIOD), step)
    assert np.abs(np.diff(first[1])).max() <= 20.0 * PERIOD * (1.0 + 1e-12)
    assert first[0].max() < 1.0 + 1e-6
    assert first[0][-1] == pytest.approx(1.0, abs=1e-6)


def toolbox(alpha: float, beta: float, degree: int) -> Any:
    """AlgDiff's differentiator with a window of 0.2 s."""
    package = pytest.importorskip("AlgDiff")
    return package.AlgebraicDifferentiator(
        ts=PERIOD, alpha=alpha, beta=beta, N=degree, T=0.2, display=False, corr=True
    )


@pytest.mark.parametrize("degree", [0, 1, 2, 4])
@pytest.mark.parametrize(("alpha", "beta"), [(4.0, 4.0), (4.0, 6.0), (2.5, 3.5)])
def test_algebraic_has_the_kernel_and_the_velocity_of_algdiff(
    alpha: float, beta: float, degree: int
) -> None:
    """Its "analytic" taps, the first 40 of ours; the kernel is nothing at both ends."""
    theirs = toolbox(alpha, beta, degree)
    ours = load("algebraic")(0.2, alpha, beta, degree)
    kernel = np.ravel(theirs.evalKernel(PERIOD * np.arange(1, 40)))
    np.testing.assert_allclose(ours.lowpass(PERIOD), kernel / kernel.sum(), rtol=1e-9, atol=1e-12)
    first = np.ravel(theirs.discretize(1, method="analytic")[1]["analytic"])
    found = ours.taps(PERIOD)[0]
    np.testing.assert_allclose(found[:40], first, rtol=0.0, atol=1e-6 * np.abs(first).max())


@pytest.mark.parametrize("degree", [0, 1, 2])
@pytest.mark.parametrize(("alpha", "beta"), [(4.0, 4.0), (4.0, 6.0)])
def test_algebraic_accelerates_as_algdiff_does(alpha: float, beta: float, degree: int) -> None:
    """At 1 Hz. Its second derivative is integrated over a sample, half of one before ours."""
    integrated = toolbox(alpha, beta, degree).discretize(2, method="analytic")[2]["analytic"]
    theirs = np.convolve(np.ravel(integrated), [0.5, 0.5])
    ours = load("algebraic")(0.2, alpha, beta, degree).taps(PERIOD)[1]
    response, reference = (
        taps @ np.exp(-2j * np.pi * PERIOD * np.arange(len(taps))) for taps in (ours, theirs)
    )
    assert abs(response - reference) < 0.005 * abs(reference)


@pytest.mark.parametrize("degree", [1, 3, 6])
def test_jacobi_polynomials_are_scipys(degree: int) -> None:
    from scipy.special import eval_jacobi, roots_jacobi

    x = np.linspace(-1.0, 1.0, 21)
    np.testing.assert_allclose(
        algebraic.jacobi(degree, 2.5, 4.0, x), eval_jacobi(degree, 2.5, 4.0, x), atol=1e-12
    )
    roots = roots_jacobi(degree, 2.5, 4.0)[0]
    assert algebraic.last_zero(degree, 2.5, 4.0) == pytest.approx(roots.max(), abs=1e-12)


def test_algebraic_is_exact_on_its_polynomial_but_for_the_delay() -> None:
    """Degree 0, equal weights: of a parabola the acceleration, and the velocity of T / 2 ago."""
    t = np.arange(400) * PERIOD
    v, a = over(load("algebraic")(), 1.5 * t**2, PERIOD)
    delay = 0.05 - 0.5 * PERIOD
    assert a[-1] == pytest.approx(3.0, rel=1e-9)
    assert v[-1] == pytest.approx(3.0 * (t[-1] - delay), rel=1e-4)
