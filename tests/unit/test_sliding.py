"""The sliding mode differentiators of Levant's family: accuracy, recursion, boundedness."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from unit.support import PERIOD, derivatives, encoder_readings

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters.sliding import LAMBDA, gains
from scarid_cli.arrays import Array

load = DIFFERENTIATORS.load


def sine_errors(method: Any, h: float) -> tuple[float, float]:
    """Largest errors of velocity and acceleration on sin(2 t) / 2, once they have converged."""
    t = np.arange(round(40.0 / h)) * h
    v, a = derivatives(method, 0.5 * np.sin(2.0 * t), h=h)
    late = t > 25.0
    return (
        float(np.abs(v - np.cos(2.0 * t))[late].max()),
        float(np.abs(a + 2.0 * np.sin(2.0 * t))[late].max()),
    )


def powers(method: Any) -> list[float]:
    """With which power of the period both errors fall, between 20 and 5 ms."""
    pairs = zip(sine_errors(method, 0.02), sine_errors(method, 0.005), strict=True)
    return [float(np.log(coarse / fine) / np.log(4.0)) for coarse, fine in pairs]


def bound(order: int) -> float:
    """Of the derivative of order + 1 of that sine, and a third more."""
    return 1.3 * 0.5 * 2.0 ** (order + 1)


@pytest.mark.parametrize("order", [2, 3, 4, 5])
def test_without_noise_errors_fall_as_the_theory_says(order: int) -> None:
    """As h^n for the velocity and h^(n-1) for the acceleration of order n (Livne, Levant 2014)."""
    found = powers(load("levant")(order=order, bound=bound(order)))
    assert found == pytest.approx([order, order - 1], abs=0.15)


@pytest.mark.parametrize("order", [2, 3, 4])
def test_the_implicit_form_does_as_well_with_its_output_map(order: int) -> None:
    found = powers(load("implicit-levant")(order=order, bound=bound(order)))
    assert found == pytest.approx([order, order - 1], abs=0.05)


@pytest.mark.parametrize("order", [2, 3, 4, 5])
def test_in_eulers_steps_every_error_is_proportional_to_the_period(order: int) -> None:
    found = powers(load("levant")(order=order, bound=bound(order), euler=1))
    assert found == pytest.approx([1.0, 1.0], abs=0.15)


def written_out(q: Array, order: int, bound: float, filters: int, h: float) -> tuple[Array, Array]:
    """The recursions of Levant and Livne (2014, 2020) as they are printed, with Taylor terms."""
    total = order + filters
    lam = [x * bound ** ((i + 1) / (total + 1)) for i, x in enumerate(LAMBDA[total - 1])]
    w, z = [0.0] * filters, [float(q[0]), *[0.0] * order]

    def power(x: float, p: float) -> float:
        return float(np.sign(x) * abs(x) ** p)

    v, a = np.empty_like(q), np.empty_like(q)
    for k, g in enumerate(q):
        e = z[0] - g
        x = w[0] if filters else e
        dw = [-lam[i] * power(x, (total - i) / (total + 1)) for i in range(filters)]
        for i in range(filters):
            dw[i] += w[i + 1] if i < filters - 1 else e
        dz = [-lam[filters + i] * power(x, (order - i) / (total + 1)) for i in range(order + 1)]
        new = []
        for i in range(order + 1):
            dz[i] += z[i + 1] if i < order else 0.0
            taylor = sum(
                h**j / np.prod(np.arange(1.0, j + 1)) * z[i + j] for j in range(2, order - i + 1)
            )
            new.append(z[i] + h * dz[i] + taylor)
        w = [w[i] + h * dw[i] for i in range(filters)]
        z = new
        steps = [(-h) ** j / np.prod(np.arange(1.0, j + 1)) for j in range(order + 1)]
        v[k] = sum(s * x for s, x in zip(steps, z[1:], strict=False))
        a[k] = sum(s * x for s, x in zip(steps, z[2:], strict=False))
    return v, a


@pytest.mark.parametrize(("order", "filters"), [(2, 0), (3, 0), (5, 0), (2, 1), (2, 2), (3, 4)])
def test_the_kernel_is_the_recursion_as_written(order: int, filters: int) -> None:
    q = encoder_readings(300)
    expected = written_out(q, order, 200.0, filters, PERIOD)
    name, more = ("filtering", {"filters": filters}) if filters else ("levant", {})
    found = derivatives(load(name)(order=order, bound=200.0, **more), q)
    for ours, theirs in zip(found, expected, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-7 * np.abs(theirs).max())


def test_super_twisting_is_two_of_order_1_in_a_row() -> None:
    q = encoder_readings(500)
    v, a = derivatives(load("super-twisting")(acceleration=30.0, jerk=30.0), q)
    expected_v, _ = written_out(q, 1, 30.0, 0, PERIOD)
    np.testing.assert_allclose(v, expected_v, atol=1e-9)
    first = load("levant")(order=1, bound=30.0, euler=1)
    np.testing.assert_array_equal(derivatives(first, q), (v, a))


@pytest.mark.parametrize("order", [2, 3, 5])
def test_the_implicit_step_solves_its_inclusion(order: int) -> None:
    """z_i(k+1) - z_i(k) = h (z_(i+1)(k+1) - lambda_i S |q|^(n-i)), S in Sgn of the new error."""
    method, q = load("implicit-levant")(order=order, bound=200.0), encoder_readings(400)
    lam, state = gains(order, 200.0), method.init(float(q[0]), PERIOD)
    for g in q:
        before = state.values
        state, _ = method.step(state, np.array([g]))
        z = state.values
        e = z[0] - g
        root = abs(e) ** (1.0 / (order + 1))
        rates = (z - before) / PERIOD - np.append(z[1:], 0.0)
        if abs(e) > 1e-9:
            expected = -lam * np.sign(e) * root ** np.arange(order, -1, -1)
            np.testing.assert_allclose(rates, expected, rtol=1e-5, atol=1e-5 * lam[-1])
        else:
            assert abs(rates[-1]) <= lam[-1] * (1.0 + 1e-9)


@pytest.mark.parametrize(
    "name", ["levant", "implicit-levant", "filtering", "super-twisting", "2smd"]
)
def test_a_dithering_last_bit_leaves_them_bounded(name: str) -> None:
    step = 2.0 * np.pi / 2**13
    q = step * np.random.default_rng(0).integers(0, 2, 60_000).astype(float)
    v, a = derivatives(load(name)(), q)
    assert np.abs(v[2000:]).max() < 0.5
    assert np.abs(a[2000:]).max() < 20.0


def test_filtering_bears_vibration() -> None:
    """70 Hz of 10 mrad on a slow motion: against levant of the same order and bound."""
    t = np.arange(4000) * PERIOD
    q = 0.5 * np.sin(2.0 * t) + 0.01 * np.sin(2.0 * np.pi * 70.0 * t)
    errors = {
        name: np.std((derivatives(load(name)(order=2, bound=10.0), q)[1] + 2 * np.sin(2 * t))[800:])
        for name in ("levant", "filtering")
    }
    assert errors["filtering"] < 0.25 * np.std(2.0 * np.sin(2.0 * t))
    assert errors["filtering"] < 0.5 * errors["levant"]
