"""Phase matching: derivatives of the filtered position, and torques of the same instant."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters.butterworth import Butterworth
from scarid_cli.algorithms.processes.delays import delays, lateness, later, reference
from scarid_cli.algorithms.processes.matching import over, settling_rows
from scarid_cli.algorithms.processes.method import Matching
from scarid_cli.arrays import Array

H = 0.005
NAMES = DIFFERENTIATORS.names
every_method = pytest.mark.parametrize("name", NAMES)


def declared(*kinds: Matching) -> list[str]:
    """The methods that declare to be matched in one of these ways."""
    return [name for name in NAMES if DIFFERENTIATORS.load(name).MATCHING in kinds]


# With which settings a method is its linearisation on these motions, where not by default.
LINEAR_WITH: dict[str, dict[str, float]] = {"p2smd": {"cap": 1e-15}}
# More settings with which a method must be exact.
EXACT = [
    *((name, LINEAR_WITH.get(name, {})) for name in declared(Matching.EXACT, Matching.LINEARISED)),
    ("kalman-lag", {"damping": 1.3, "frequency": 2.0}),
    ("p2smd", {"cap": 1e-15, "implicit": 1}),
]


def positions(rows: int = 3000) -> Array:
    t = np.arange(rows) * H
    return np.sin(2.0 * t) + 0.4 * np.sin(7.0 * t + 1.0) + 0.5


def form(name: str, q: Array, **settings: float) -> Any:
    """The matched form of a method, tuned by the positions if it tunes itself."""
    return DIFFERENTIATORS.load(name)(**settings).fitted(q, H).matched()


def through(torque_filter: Any, x: Array) -> Array:
    return x if torque_filter is None else over(torque_filter, x, H)[0]


@pytest.mark.parametrize(("name", "settings"), EXACT)
def test_matched_derivatives_are_central_differences_of_the_filtered_position(
    name: str, settings: dict[str, float]
) -> None:
    """Exactly in discrete time, except at the ends, where the filters come to rest."""
    q = positions()
    matched = form(name, q, **settings)
    u, v, a = over(matched, q, H)
    settled = slice(800, -300)
    np.testing.assert_allclose(u[settled], through(matched.torque_filter, q)[settled], atol=1e-12)
    np.testing.assert_allclose(v[settled], np.gradient(u, H)[settled], rtol=0.0, atol=1e-9)
    curvature = np.diff(np.diff(u)) / H**2
    np.testing.assert_allclose(a[settled], curvature[799:-299], rtol=0.0, atol=1e-7)


@pytest.mark.parametrize("name", declared(Matching.MEASURED))
def test_a_method_matched_by_measured_delays_is_not_linear(name: str) -> None:
    """A linear one could be matched exactly, and would escape the test above."""
    q = positions(1000)
    method = DIFFERENTIATORS.load(name)()
    once, twice = (np.array(over(method, x, H)) for x in (q, 2.0 * q))
    assert np.abs(2.0 * once - twice).max() > 0.01 * np.abs(once).max()


@pytest.mark.parametrize("name", declared(Matching.UNFILTERED))
def test_an_unfiltered_method_keeps_position_and_torque(name: str) -> None:
    q = positions()
    matched = form(name, q)
    u, *derivatives = over(matched, q, H)
    assert matched.torque_filter is None
    np.testing.assert_array_equal(u, q)
    np.testing.assert_array_equal(derivatives, over(DIFFERENTIATORS.load(name)(), q, H))


@pytest.mark.parametrize("name", ["kalman-lag", "savgol"])
def test_the_matched_acceleration_is_the_methods_own(name: str) -> None:
    """On a settled record, at the method's own sample or the one before."""
    q = positions()
    method = DIFFERENTIATORS.load(name)()
    own = over(method, q, H)[1]
    matched = over(method.matched(), q, H)[2]
    np.testing.assert_allclose(matched[1000:-300], own[1000:-300], rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("name", declared(Matching.SECOND_ORDER))
def test_smoothers_are_matched_to_second_order_in_the_period(name: str) -> None:
    """Differences of a smooth curve are off by h^2 / 6 of the third derivative, / 12 of the fourth.

    Those of the estimate are up to twice those of the motion.
    """
    q = positions() + 1e-4 * np.random.default_rng(0).standard_normal(3000)
    u, v, a = over(form(name, q), q, H)
    inner = slice(300, -300)
    third, fourth = (8.0 + 0.4 * 7.0**3), (16.0 + 0.4 * 7.0**4)
    np.testing.assert_allclose(
        v[inner], np.gradient(u, H)[inner], rtol=0.0, atol=2.0 * H**2 * third / 6.0
    )
    curvature = np.diff(np.diff(u)) / H**2
    np.testing.assert_allclose(
        a[inner], curvature[299:-299], rtol=0.0, atol=2.0 * H**2 * fourth / 12.0
    )


@every_method
def test_the_torque_filter_keeps_a_constant(name: str) -> None:
    torque_filter = form(name, positions()).torque_filter
    np.testing.assert_allclose(through(torque_filter, np.full(3000, 3.7)), 3.7, rtol=1e-10)


@every_method
def test_position_and_torque_go_the_same_way(name: str) -> None:
    q = positions()
    matched = form(name, q)
    settled = slice(1000, -300)
    u = through(matched.torque_filter, q)
    # A spline, for one, takes the torque through the least-squares spline of the same knots.
    tolerance = 1e-6 if name in declared(Matching.SECOND_ORDER) else 1e-12
    np.testing.assert_allclose(over(matched, q, H)[0][settled], u[settled], atol=tolerance)


@every_method
def test_matched_forms_give_the_same_bits_in_chunks(name: str) -> None:
    q = positions(400)
    matched = form(name, q)
    state, parts = matched.init(float(q[0]), H), []
    for start in range(0, 400, 7):
        state, rows = matched.step(state, q[start : start + 7])
        parts.append(rows)
    parts.append(matched.finish(state))
    whole = over(matched, q, H)
    for chunked, expected in zip(zip(*filter(None, parts), strict=True), whole, strict=True):
        np.testing.assert_array_equal(np.concatenate(chunked), expected)


# On this fast sine the chattering of these costs more than their delay.
CHATTERING = {"astd", "super-twisting"}


@pytest.mark.parametrize("name", sorted(set(NAMES) - CHATTERING))
def test_torque_matched_to_its_motion_gives_the_mass_back(name: str) -> None:
    """A force of 3 kg times the true acceleration: the lag of an unmatched method costs mass."""
    t = np.arange(4000) * H
    q, force = np.sin(3.5 * t), -3.0 * 3.5**2 * np.sin(3.5 * t)
    matched = form(name, q)
    _, _, a = over(matched, q, H)
    tau = through(matched.torque_filter, force)
    inner = slice(800, -300)
    mass = float(a[inner] @ tau[inner] / (a[inner] @ a[inner]))
    measured = name in declared(Matching.MEASURED)
    assert mass == pytest.approx(3.0, rel=0.1 if measured else 0.01)


@pytest.mark.parametrize("name", ["ed-fir", "p2smd"])
def test_the_lag_of_an_unmatched_method_costs_mass(name: str) -> None:
    t = np.arange(4000) * H
    q, force = np.sin(9.0 * t), -3.0 * 81.0 * np.sin(9.0 * t)
    _, a = over(DIFFERENTIATORS.load(name)(), q, H)
    assert abs(float(a[800:] @ force[800:] / (a[800:] @ a[800:])) - 3.0) > 0.3


# Delays and edges


def test_reference_motion_has_the_derivatives_it_says() -> None:
    q, v, a = reference(0.001)
    np.testing.assert_allclose(np.gradient(q, 0.001)[1:-1], v[1:-1], atol=1e-4)
    np.testing.assert_allclose(np.gradient(v, 0.001)[1:-1], a[1:-1], atol=0.05)


@pytest.mark.parametrize("late", [0.0, 0.0033, 0.05, 0.1234])
def test_lateness_finds_a_known_delay(late: float) -> None:
    _, _, a = reference(H)
    t = np.arange(len(a)) * H
    assert lateness(np.interp(t - late, t, a), a, H) == pytest.approx(late, abs=2e-4)


@pytest.mark.parametrize("late", [0.0, 0.3, 1.0, 7.25, 399.0, 5000.0])
def test_a_delayed_signal_is_interpolated_and_holds_its_first_sample(late: float) -> None:
    x = positions(400)
    t = np.arange(400.0)
    np.testing.assert_allclose(later(x, late), np.interp(t - late, t, x), rtol=0, atol=1e-13)


def test_the_delays_of_a_method_are_measured_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """At a high rate the reference motion has a million samples, and every column asks for them."""
    method = DIFFERENTIATORS.load("levant")(bound=123.0)
    runs = []
    law = type(method).law
    monkeypatch.setattr(type(method), "law", lambda *given: (runs.append(given), law(*given))[1])
    for _ in range(3):
        over(method.matched(), positions(30), H)
        over(method.matched().torque_filter, positions(30), H)
    assert len([x for _, x, *_ in runs if len(x) > 30]) == 1


@pytest.mark.parametrize(("bits", "tolerance"), [(16, 0.009), (18, 0.004), (24, 0.009)])
@pytest.mark.parametrize(
    "name", ["levant", "implicit-levant", "filtering", "super-twisting", "2smd"]
)
def test_the_matching_delay_is_that_of_motions_within_the_bounds(
    name: str, bits: int, tolerance: float
) -> None:
    """On two sines that no default bound excludes; the delay grows with the encoder's noise."""
    t, w = np.arange(6000) * H, 2.0 * np.pi * 0.7
    q = 0.5 * np.sin(w * t) + 0.15 * np.sin(0.37 * w * t)
    truth = -(w**2) * (0.5 * np.sin(w * t) + 0.15 * 0.37**2 * np.sin(0.37 * w * t))
    resolution = 2.0 * np.pi / 2**bits
    method = DIFFERENTIATORS.load(name)()
    _, a = over(method, resolution * np.round(q / resolution), H)
    found = lateness(a[1000:], truth[1000:], H)
    assert delays(method, H)[1] == pytest.approx(found, abs=tolerance)


@pytest.mark.parametrize("bounds", [((4, 400.0),), ((3, 5.0),), ((2, 20.0), (3, 150.0))])
def test_reference_motion_stays_within_the_bounds(bounds: tuple[tuple[int, float], ...]) -> None:
    h = 0.001
    signals = dict(enumerate(reference(h, bounds)))
    for order in (3, 4):
        signals[order] = np.gradient(signals[order - 1], h)
    for order, bound in bounds:
        assert np.abs(signals[order]).max() < 1.02 * bound


def test_measured_delays_of_a_linear_method_are_those_of_its_phase() -> None:
    """High-gain, four poles at w: acceleration (4 w^3 s + w^4) s^2 / (s + w)^4, so 0 at rest, and
    (s^2 / w^2) (10 - 4) more: its delay is found on the reference alone, p2smd's is 1 / gamma1."""
    slow = DIFFERENTIATORS.load("p2smd")(cap=1e-15)
    v, a = delays(slow, H)
    assert a == pytest.approx(1.0 / slow.gamma1, rel=0.15)
    assert v == pytest.approx(0.0, abs=0.01)


def test_a_causal_filter_settles_after_its_settling_time() -> None:
    """One pole: 1 % after ln(100) time constants, its slope .5 % of the first after ln(200)."""
    before, after = settling_rows(Butterworth(4.0, 1), H)
    assert before == 0
    assert after == pytest.approx(np.log(200.0) / (2.0 * np.pi * 4.0) / H, abs=2)


def test_a_zero_phase_filter_settles_on_both_sides() -> None:
    before, after = settling_rows(form("zero-phase", positions()).torque_filter, H)
    assert before == pytest.approx(after, abs=1)
    assert before > 10
