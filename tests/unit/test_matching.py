"""Phase matching: derivatives of the filtered position, and torques of the same instant."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scarid_cli.algorithms.registry import DIFFERENTIATORS
from scarid_cli.arrays import Array

H = 0.005
MATCHED = [n for n in DIFFERENTIATORS.names if hasattr(DIFFERENTIATORS.load(n), "matched")]
# Without the adaptive terms p2smd is linear.
LINEAR = {"p2smd": {"cap": 1e-15}}


def positions(rows: int = 3000) -> Array:
    t = np.arange(rows) * H
    return np.sin(2.0 * t) + 0.4 * np.sin(7.0 * t + 1.0) + 0.5


def filtered(lowpass: Any, x: Array) -> Array:
    return x if lowpass is None else lowpass.step(lowpass.init(float(x[0]), H), x)[1]


def derivatives(method: Any, q: Array) -> tuple[Array, Array]:
    state, (v, a) = method.step(method.init(float(q[0]), H), q)
    rest_v, rest_a = method.finish(state)
    return np.concatenate((v, rest_v)), np.concatenate((a, rest_a))


@pytest.mark.parametrize("name", MATCHED)
def test_matched_derivatives_are_central_differences_of_the_filtered_position(name: str) -> None:
    """Exactly in discrete time, but for the start, where the filters come to rest."""
    method = DIFFERENTIATORS.load(name)(**LINEAR.get(name, {})).matched()
    q = positions()
    v, a = derivatives(method, q)
    u = filtered(method.companion, q)
    settled = slice(800, -2)
    velocity = np.gradient(u, H)
    narrow = np.concatenate(([0.0], np.diff(u, 2) / H**2, [0.0]))
    acceleration = np.gradient(velocity, H) if name == "central" else narrow
    np.testing.assert_allclose(v[settled], velocity[settled], rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(a[settled], acceleration[settled], rtol=0.0, atol=1e-7)


@pytest.mark.parametrize("name", MATCHED)
def test_the_companion_keeps_a_constant(name: str) -> None:
    lowpass = DIFFERENTIATORS.load(name)().matched().companion
    np.testing.assert_allclose(filtered(lowpass, np.full(500, 3.7)), 3.7, rtol=1e-12)


@pytest.mark.parametrize("name", MATCHED)
def test_matched_forms_give_the_same_bits_in_chunks(name: str) -> None:
    method = DIFFERENTIATORS.load(name)().matched()
    q = positions(400)
    state = method.init(float(q[0]), H)
    parts = []
    for start in range(0, 400, 7):
        state, pair = method.step(state, q[start : start + 7])
        parts.append(pair)
    parts.append(method.finish(state))
    for chunked, whole in zip(zip(*parts, strict=True), derivatives(method, q), strict=True):
        np.testing.assert_array_equal(np.concatenate(chunked), whole)


@pytest.mark.parametrize("name", ["ed-fir", "p2smd"])
def test_torque_matched_to_its_motion_gives_the_mass_back(name: str) -> None:
    """A force of 3 kg times the true acceleration: the lag of an unmatched method costs mass."""
    t = np.arange(4000) * H
    q, force = np.sin(9.0 * t), -3.0 * 81.0 * np.sin(9.0 * t)
    method = DIFFERENTIATORS.load(name)()

    def mass(form: Any, tau: Array) -> float:
        _, a = derivatives(form, q)
        return float(a[800:] @ tau[800:] / (a[800:] @ a[800:]))

    matched = method.matched()
    assert mass(matched, filtered(matched.companion, force)) == pytest.approx(3.0, rel=0.01)
    assert abs(mass(method, force) - 3.0) > 0.3
