"""The laws that every differentiator keeps, and what each of them is by itself."""

from __future__ import annotations

import re
from dataclasses import fields
from functools import cache, partial
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal
from unit.support import (
    GIVEN,
    PERIOD,
    cuts,
    derivatives,
    encoder_readings,
    every_differentiator,
    sine,
    without_search,
)

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.differentiators import central, ed_fir, p2smd
from scarid_cli.arrays import Array
from scarid_cli.errors import ScaridError, UsageFault

ROWS = 120
LSB = 2.0 * np.pi / 2**13

METHODS = dict(every_differentiator())
every_method = pytest.mark.parametrize("make", METHODS.values(), ids=METHODS)
# Without searches for settings, for properties of many examples
QUICK = METHODS | {name: partial(without_search, name) for name in GIVEN}

astd, smd2 = DIFFERENTIATORS.load("astd"), DIFFERENTIATORS.load("2smd")


# What all of them share


@pytest.mark.parametrize("make", QUICK.values(), ids=QUICK)
@given(chunks=cuts(ROWS))
@settings(max_examples=30, deadline=None)
def test_chunks_do_not_change_a_bit(make: Any, chunks: list[slice]) -> None:
    cut = derivatives(make(), encoder_readings(ROWS), chunks)
    np.testing.assert_array_equal(cut, at_once(make))


@cache
def at_once(make: Any) -> Any:
    return derivatives(make(), encoder_readings(ROWS))


@every_method
def test_step_leaves_its_state_alone(make: Any) -> None:
    method, q = make(), encoder_readings(2 * ROWS)
    state, _ = method.step(method.init(q[0], PERIOD), q[:ROWS])
    first, second = (method.step(state, q[ROWS:])[1] for _ in range(2))
    np.testing.assert_array_equal(first, second)


@every_method
@pytest.mark.parametrize("rows", [2, 3, ROWS])
def test_every_position_gets_its_derivatives(make: Any, rows: int) -> None:
    method = make()
    try:
        v, a = derivatives(method, encoder_readings(rows))
    except ScaridError:
        assert method.lag(PERIOD) > 2, "only a method that looks far ahead needs a longer record"
        assert rows < ROWS
    else:
        assert len(v) == len(a) == rows


@every_method
def test_output_lags_by_what_the_method_declares(make: Any) -> None:
    method, q = make(), encoder_readings(ROWS)
    _, settled = method.step(method.init(q[0], PERIOD), q)
    lengths = {len(x) for x in settled} or {0}
    assert lengths == {max(ROWS - method.lag(PERIOD), 0)}


@every_method
@given(position=st.floats(-1e3, 1e3))
@settings(max_examples=20, deadline=None)
def test_standing_still_starts_without_a_jump(make: Any, position: float) -> None:
    # What differences of a position may be that a filter rounds in each of some dozen steps
    v, a = derivatives(make(), np.full(ROWS, position))
    bit = np.spacing(max(abs(position), 1.0))
    np.testing.assert_allclose(v, 0.0, atol=50.0 * bit / PERIOD)
    np.testing.assert_allclose(a, 0.0, atol=50.0 * bit / PERIOD**2)


@pytest.mark.parametrize(
    ("name", "setting", "value"),
    [
        (name, field.name, value)
        for name in DIFFERENTIATORS.names
        for field in fields(DIFFERENTIATORS.load(name))
        for value in (-1.0, nan)
    ]
    + [
        ("ed-fir", "order", 0.0),
        ("ed-fir", "order", 2.5),
        ("ed-fir", "order", inf),
        ("ed-fir", "cutoff", 0.0),
        ("p2smd", "gamma0", 0.0),
        ("p2smd", "gamma0", inf),
        ("p2smd", "leak", inf),
        ("p2smd", "cap", 0.0),
        ("2smd", "eta2", 0.0),
        ("2smd", "eta0", inf),
        ("astd", "gamma", 0.0),
        ("savgol", "window", 5.0),  # its degree
        ("savgol-end", "window", 3.0),
    ],
)
def test_setting_without_sense_is_refused(name: str, setting: str, value: float) -> None:
    with pytest.raises(UsageFault, match=rf"^{setting} must"):
        DIFFERENTIATORS.load(name)(**{setting: value})


# P2SMD


def observer(q: Array, gamma0: float, gamma1: float, h: float) -> tuple[Array, Array]:
    """P2SMD without its adaptive terms, as transfer functions.

    Euler's rule puts w / h for s, with w = z - 1:
    v = gamma0 w (w + h gamma1) / D q, a = gamma0 gamma1 w^2 / D q,
    D = w^2 + h gamma0 w + h^2 gamma0 gamma1.
    """
    w2, w1, w0 = np.array([[1.0, -2.0, 1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0]])
    D = w2 + h * gamma0 * w1 + h * h * gamma0 * gamma1 * w0
    moved = q - q[0]  # the observer starts at rest at the first position
    v = signal.lfilter(gamma0 * (w2 + h * gamma1 * w1), D, moved)
    return v, signal.lfilter(gamma0 * gamma1 * w2, D, moved)


@pytest.mark.parametrize(("gamma0", "gamma1"), [(25.0, 20.0), (100.0, 80.0)])
def test_p2smd_without_adaptation_is_a_linear_observer(gamma0: float, gamma1: float) -> None:
    q = 1.0 + encoder_readings(2000)
    # The adaptive gains stay below the cap, far under the last bit of anything.
    v, a = derivatives(p2smd.Differentiator(gamma0=gamma0, gamma1=gamma1, cap=1e-300), q)
    expected_v, expected_a = observer(q, gamma0, gamma1, PERIOD)
    # The rounding of q, times gamma0 and times gamma0 gamma1.
    np.testing.assert_allclose(v, expected_v, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(a, expected_a, rtol=0.0, atol=1e-9)


def literal_p2smd(q: Array, h: float, eta: tuple[float, float, float]) -> tuple[Array, Array]:
    """Equations 7 to 9 of the paper as they are printed, by Euler's rule."""
    z0, z1, integral = q[0], 0.0, 0.0
    eta0, eta1, eta2 = eta
    v, a = np.empty_like(q), np.empty_like(q)
    for k, g in enumerate(q):
        e0 = z0 - g
        y0 = z1 - eta0 * abs(e0) ** (2 / 3) * np.sign(e0) - 25.0 * e0
        e1 = z1 - y0
        y1 = -eta1 * abs(e1) ** (1 / 2) * np.sign(e1) - eta2 * integral - 20.0 * e1
        v[k], a[k] = y0, y1
        z0, z1 = z0 + h * y0, z1 + h * y1
        eta0 += h * abs(e0) ** (5 / 3)
        eta1 += h * abs(e1) ** (3 / 2)
        eta2 += h * e1 * integral
        integral += h * np.sign(e1)
    return v, a


@pytest.mark.parametrize("eta", [(0.0, 0.0, 0.0), (0.5, 0.3, 0.1)])
def test_p2smd_preset_is_the_printed_law(eta: tuple[float, float, float]) -> None:
    q = encoder_readings(4000)
    gains = dict(zip(("eta0", "eta1", "eta2"), eta, strict=True))
    method = p2smd.Differentiator(**gains, **p2smd.Differentiator.PRESETS["table1"])
    v, a = derivatives(method, q)
    expected_v, expected_a = literal_p2smd(q, PERIOD, eta)
    # cbrt(e)^2 and |e|^(2/3) differ in their last bit, and nothing else does.
    np.testing.assert_allclose(v, expected_v, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(a, expected_a, rtol=0.0, atol=1e-9)


def delay(x: Array, reference: Array, omega: float) -> float:
    """By how many seconds the first harmonic of x lags that of the reference."""
    turn = np.exp(-1j * omega * PERIOD * np.arange(len(x)))
    return float(np.angle((reference @ turn) / (x @ turn)) / omega)


@pytest.mark.parametrize(("cap", "tolerance"), [(1e-300, 0.01), (2.0, 0.1)])
@pytest.mark.parametrize("gamma1", [10.0, 20.0])
def test_p2smd_acceleration_lags_by_one_over_gamma1(
    gamma1: float, cap: float, tolerance: float
) -> None:
    """With the adaptive gains held at nothing; else they shorten the lag by some percent."""
    turn, omega = 800, 2.0 * np.pi / 4.0
    q, v, a = sine(5 * turn, omega=omega)
    got_v, got_a = derivatives(p2smd.Differentiator(gamma1=gamma1, cap=cap), q)
    # Euler's forward difference, twice, takes one period off the lag of the continuous form.
    lag = PERIOD + delay(got_a[-turn:], a[-turn:], omega)
    assert lag == pytest.approx(1.0 / gamma1, rel=tolerance)
    assert delay(got_v[-turn:], v[-turn:], omega) == pytest.approx(0.0, abs=PERIOD)


def test_p2smd_stays_bounded_for_half_an_hour_at_standstill() -> None:
    """Without its safeguards it may diverge here: the last bit dithers, and never averages out."""
    method, moving = p2smd.Differentiator(), encoder_readings(4000)
    state, _ = method.step(method.init(moving[0], PERIOD), moving)
    dither = np.random.default_rng(0).integers(0, 2, (1800, 200))
    peaks = []
    for second in moving[-1] + LSB * dither:
        state, (_, a) = method.step(state, second)
        nu, adaptive = state.values[p2smd.NU], state.values[p2smd.ETA0 :]
        assert abs(nu) <= method.nu_max
        assert np.all((adaptive >= 0.0) & (adaptive <= method.cap))
        peaks.append(np.abs(a).max())
    # The most that the linear observer makes of half a bit up and down; 5 % for the rest.
    impulse = np.eye(1, 2000)[0]
    step = np.concatenate(([0.0], impulse))
    most = 0.5 * LSB * np.abs(observer(step, 25.0, 20.0, PERIOD)[1]).sum()
    assert max(peaks[10:]) < 1.05 * most


# The methods that the paper compares with


@pytest.mark.parametrize("h", [0.005, 0.00125, 0.0003])
def test_2smd_errors_are_proportional_to_the_period(h: float) -> None:
    """On a noise-free motion whose jerk is below eta2; z2 chatters by a few times eta2 h."""
    method, t = smd2(), h * np.arange(int(10.0 / h))
    v, a = derivatives(method, 0.5 * np.sin(2.0 * t), h=h)
    late = t > 2.0
    assert np.abs(a + 2.0 * np.sin(2.0 * t))[late].max() < 3.0 * method.eta2 * h
    assert np.abs(v - np.cos(2.0 * t))[late].max() < 2.0 * h


def test_2smd_preset_of_the_paper_cannot_follow_a_fast_motion() -> None:
    """The jerk of the motion is 13.5 rad/s3, that of the preset at most 4.5 rad/s3."""
    q, _, a = sine(4000, omega=3.0)
    errors = {
        name: np.std((derivatives(method, q)[1] - a)[1000:])
        for name, method in (
            ("default", smd2()),
            ("table1", smd2(**smd2.PRESETS["table1"])),
        )
    }
    assert errors["default"] < 0.1 * np.std(a) < 0.3 * np.std(a) < errors["table1"]


def test_astd_follows_a_sine_with_its_default_threshold() -> None:
    errors = []
    for h in (0.005, 0.00125):
        t = h * np.arange(int(20.0 / h))
        v, a = derivatives(astd(), 0.5 * np.sin(2.0 * t), h=h)
        late = t > 10.0
        errors.append((np.std((v - np.cos(2.0 * t))[late]), np.std((a + 2 * np.sin(2 * t))[late])))
    (v_coarse, a_coarse), (v_fine, a_fine) = errors
    assert v_coarse < 0.05  # of an amplitude of 1 rad/s
    assert v_fine < 0.3 * v_coarse
    assert a_fine < 0.3 * a_coarse


def test_astd_estimates_nothing_with_the_printed_threshold() -> None:
    q, v, _ = sine(4000, omega=2.0)
    got, _ = derivatives(astd(**astd.PRESETS["table1"]), q)
    assert np.std((got - v)[2000:]) > np.std(v)


def test_ed_fir_taps_are_a_hamming_window_design() -> None:
    ours = ed_fir.lowpass(10, 5.0 * PERIOD)
    np.testing.assert_allclose(ours, signal.firwin(11, 5.0, fs=1.0 / PERIOD), rtol=1e-12)


@pytest.mark.parametrize(("order", "cutoff"), [(10, 5.0), (1, 20.0), (40, 8.0)])
def test_ed_fir_is_two_stages_of_difference_and_filter(order: int, cutoff: float) -> None:
    q = 1.0 + encoder_readings(400)
    taps = signal.firwin(order + 1, cutoff, fs=1.0 / PERIOD)
    expected_v = signal.lfilter(taps, 1.0, np.diff(q, prepend=q[0]) / PERIOD)
    expected_a = signal.lfilter(taps, 1.0, np.diff(expected_v, prepend=0.0) / PERIOD)
    v, a = derivatives(ed_fir.Differentiator(order, cutoff), q)
    np.testing.assert_allclose(v, expected_v, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(a, expected_a, rtol=0.0, atol=1e-10)


def test_ed_fir_refuses_a_cutoff_above_half_the_rate() -> None:
    with pytest.raises(UsageFault, match=re.escape("100 Hz is not below half the rate, 100 Hz")):
        ed_fir.Differentiator(cutoff=100.0).init(0.0, PERIOD)


@pytest.mark.parametrize("rows", [2, 3, 4, 100])
def test_central_is_the_gradient_of_the_gradient(rows: int) -> None:
    q = np.random.default_rng(rows).standard_normal(rows)
    v, a = derivatives(central.Differentiator(), q)
    once = np.gradient(q, PERIOD)
    np.testing.assert_array_equal(v, once)
    np.testing.assert_array_equal(a, np.gradient(once, PERIOD))


def test_backward_is_the_difference_to_the_sample_before_once_and_twice() -> None:
    """Against scipy's filter, at rest before the first sample."""
    q = np.random.default_rng(2).standard_normal(200)
    method = DIFFERENTIATORS.load("backward")()
    _, (v, a) = method.step(method.init(float(q[0]), PERIOD), q)
    from_rest = q - q[0]
    np.testing.assert_allclose(v, signal.lfilter([1.0, -1.0], [PERIOD], from_rest), atol=1e-9)
    np.testing.assert_allclose(
        a, signal.lfilter([1.0, -2.0, 1.0], [PERIOD**2], from_rest), atol=1e-7
    )
