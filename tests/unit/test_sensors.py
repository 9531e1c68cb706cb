"""The parts between the simulated robot and its log, each against a closed form or scipy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from scipy.interpolate import BPoly
from scipy.signal import lsim
from scipy.stats import binom, norm
from unit.support import cuts

from scarid_cli.algorithms.sensors.clock import Clock
from scarid_cli.algorithms.sensors.faults import Faults, Outliers
from scarid_cli.algorithms.sensors.instants import LIMIT, Instants, Path
from scarid_cli.algorithms.sensors.motion import Encoder, between
from scarid_cli.algorithms.sensors.noise import GaussMarkov, Source, stream
from scarid_cli.algorithms.sensors.torque import TorqueSensor, rounded
from scarid_cli.arrays import Array

H = 1e-3
COLOURED = GaussMarkov(np.array([0.2, 3.0, 1.0]), np.array([0.02, 0.05, 0.0]), H)


def noise(ticks: int, chunks: list[slice] | None = None) -> Array:
    state, parts = COLOURED.init(Source.named(1, "test")), []
    for chunk in chunks or [slice(0, ticks)]:
        state, part = COLOURED.step(state, chunk.stop - chunk.start)
        parts.append(part)
    return np.concatenate(parts, axis=1)


def test_coloured_noise_has_the_autocorrelation_of_a_gauss_markov_process() -> None:
    """s^2 exp(-lag / T); Bartlett's formula gives the error of an estimate, here times five."""
    n, memory = 400_000, np.exp(-H / np.array([0.02, 0.05]))
    found = noise(n)
    for j, a in enumerate([*memory, 0.0]):
        variance = COLOURED.deviations[j] ** 2
        errors = variance * np.sqrt((1.0 + a * a) / (1.0 - a * a) / n)
        for lag in (0, 1, 20, 50):
            product = found[j, lag:] * found[j, : n - lag]
            expected = variance * a**lag if lag else variance
            assert product.mean() == pytest.approx(expected, abs=5.0 * 2.0**0.5 * errors)


def test_coloured_noise_starts_in_its_stationary_distribution() -> None:
    first = [COLOURED.step(COLOURED.init(Source.named(s, "n")), 1)[1][:, 0] for s in range(4000)]
    # The standard deviation of 4000 samples deviates by 1 / sqrt(8000), 1.1 %; five times that.
    np.testing.assert_allclose(np.std(first, axis=0), COLOURED.deviations, rtol=0.056)


@given(chunks=cuts(60))
@settings(max_examples=30, deadline=None)
def test_chunks_do_not_change_a_bit_of_coloured_noise(chunks: list[slice]) -> None:
    np.testing.assert_array_equal(noise(60, chunks), noise(60))


def test_streams_of_different_names_and_seeds_differ_and_are_repeatable() -> None:
    draws = {(seed, name): stream(seed, name).random() for seed in (0, 1) for name in ("a", "b")}
    assert len(set(draws.values())) == 4
    assert draws[0, "a"] == stream(0, "a").random()


def test_a_step_leaves_its_source_alone() -> None:
    source = Source.named(0, "test")
    np.testing.assert_array_equal(source.normal(5)[1], source.normal(5)[1])
    np.testing.assert_array_equal(source.uniform(5)[1], source.uniform(5)[1])


def test_low_pass_of_the_torque_solves_its_equation_exactly() -> None:
    """On a torque that is held, at the ticks and between them, as scipy's lsim does."""
    bandwidth, fine = np.array([30.0, 7.0]), 4
    sensor = TorqueSensor(np.array([0.1, -0.2]), np.array([1.0, 0.0]), bandwidth, H)
    tau = np.random.default_rng(0).standard_normal((2, 300))
    _, u, y = sensor.step(None, tau)
    t = np.arange(300 * fine) * H / fine
    for j in range(2):
        held = np.repeat((1.0 + sensor.error[j]) * tau[j] + sensor.offset[j], fine)
        w = 2.0 * np.pi * bandwidth[j]
        _, expected, _ = lsim(([w], [1.0, w]), held - held[0], t, interp=False)
        for k in range(fine):
            found = sensor.between(u, y, np.full((2, 300), k / fine))[j]
            np.testing.assert_allclose(found, expected[k::fine] + held[0], rtol=0.0, atol=1e-12)


@given(chunks=cuts(60))
@settings(max_examples=20, deadline=None)
def test_chunks_do_not_change_a_bit_of_the_low_pass(chunks: list[slice]) -> None:
    sensor = TorqueSensor(np.zeros(2), np.zeros(2), np.array([30.0, 0.0]), H)
    tau = np.random.default_rng(0).standard_normal((2, 60))
    sums, parts = None, []
    for chunk in chunks:
        sums, _, y = sensor.step(sums, tau[:, chunk])
        parts.append(y)
    np.testing.assert_array_equal(np.concatenate(parts, axis=1), sensor.step(None, tau)[2])


def test_motion_between_ticks_is_the_polynomial_through_both() -> None:
    """Of fourth order, from the position, velocity and acceleration; scipy makes it by Bernstein
    polynomials."""
    rng = np.random.default_rng(3)
    q, v, a, q1, v1 = rng.standard_normal((5, 1, 1))
    x = np.linspace(0.0, H, 7)[None]
    expected = BPoly.from_derivatives([0.0, H], [[q[0, 0], v[0, 0], a[0, 0]], [q1[0, 0], v1[0, 0]]])
    found = between((q, v, a), (q1, v1), x, H)
    for order, values in enumerate(found):
        truth = expected.derivative(order)(x) if order else expected(x)
        np.testing.assert_allclose(values, truth, rtol=1e-9, atol=1e-9 / H**order)


def test_encoder_reads_its_eccentric_position_to_the_nearest_step() -> None:
    encoder = Encoder(*np.array([[1e-4, 0.0], [1e-3, 2e-3], [1.0, 50.0], [0.3, -0.5]]))
    q = np.random.default_rng(0).uniform(-3.0, 3.0, (2, 100))
    first = np.round((q[0] + 1e-3 * np.sin(q[0] + 0.3)) / 1e-4) * 1e-4
    found = encoder.reading(q, np.zeros_like(q))
    np.testing.assert_allclose(found[0], first, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(found[1], q[1] + 2e-3 * np.sin(50.0 * q[1] - 0.5), atol=1e-15)


def test_torques_are_rounded_to_the_nearest_multiple() -> None:
    x = np.array([[0.74, 0.76, -0.74, -0.76], [0.74, 0.76, -0.74, -0.76]])
    found = rounded(x, np.array([0.5, 0.0]))
    np.testing.assert_array_equal(found, [[0.5, 1.0, -0.5, -1.0], x[1]])


@pytest.mark.parametrize(
    ("rate", "delay", "expected"),
    [
        (0.0, 0.0, [0, 5, 10, 15, 20]),
        (0.0, 0.007, [0, 0, 3, 8, 13]),
        (0.0, 0.0025, [0, 2.5, 7.5, 12.5, 17.5]),
        (125.0, 0.0, [0, 0, 8, 8, 16]),
        (125.0, 0.003, [0, 0, 0, 8, 16]),
        (300.0, 0.0, [0, 10 / 3, 10, 40 / 3, 20]),
    ],
)
def test_signals_are_sampled_by_their_sensor_and_then_delayed(
    rate: float, delay: float, expected: list[float]
) -> None:
    path = Path.sampled(np.array([rate]), np.array([delay]), 1.0 / H)
    at = path.instants(np.arange(0.0, 25.0, 5.0), 1000)
    np.testing.assert_allclose(at.tick[0] + at.fraction[0], expected, atol=1e-9)


def test_an_instant_next_to_a_tick_is_the_tick() -> None:
    at = Instants.of(np.array([[3.0 - 1e-9, 3.0 + 1e-9, 3.5, -2.0, 99.0]]), 10)
    np.testing.assert_array_equal(at.tick, [[3, 3, 3, 0, 10]])
    np.testing.assert_array_equal(at.fraction, [[0.0, 0.0, 0.5, 0.0, 0.0]])


def within(count: float, trials: int, probability: float) -> bool:
    """Whether a count is one that a binomial distribution gives with all but 1e-6 of chance."""
    low, high = binom.ppf([5e-7, 1.0 - 5e-7], trials, probability)
    return bool(low <= count <= high)


def test_faults_have_their_probabilities() -> None:
    rows = 20_000
    quiet = Outliers(np.array([0.0, 0.01]), np.array([1.0, 2.0]))
    faults = Faults(quiet, Outliers(np.array([0.3, 1.0]), np.array([5.0, 6.0])), 0.05, 0.02)
    values = np.zeros((10, rows))
    values[4:] = np.arange(rows)
    _, found, kept = faults.step(faults.init(0), values)
    assert within((~kept).sum(), rows, 0.02)
    assert within((found[4] < values[4]).sum(), rows, 0.05)
    assert not found[0].any()
    for row, size, probability in ((1, 2.0, 0.01), (2, 5.0, 0.3), (3, 6.0, 1.0)):
        hit = found[row] != 0.0
        assert set(np.abs(found[row][hit])) == {size}
        # A repeated row repeats an outlier as well: runs of them, so a wider margin.
        assert hit.mean() == pytest.approx(probability, abs=0.02)
        assert within((found[row] > 0.0).sum(), int(hit.sum()), 0.5)


def test_a_repeated_row_has_the_values_of_the_row_before() -> None:
    none = Outliers(np.zeros(1), np.zeros(1))
    values = np.random.default_rng(0).standard_normal((5, 500))
    _, found, _ = Faults(none, none, repeated=0.5).step(
        Faults(none, none, repeated=0.5).init(0), values
    )
    changed = (found == values).all(axis=0)
    assert changed[0]
    for row in range(1, 500):
        expected = values[:, row] if changed[row] else found[:, row - 1]
        np.testing.assert_array_equal(found[:, row], expected)


def test_jitter_is_normal_and_keeps_the_order_of_the_rows() -> None:
    period = 0.005
    _, sampled, stamped = Clock(period, sampling=1e-4).step(Clock(period).init(0), 10_000)
    np.testing.assert_array_equal(sampled, stamped)
    assert sampled.std() == pytest.approx(1e-4, rel=0.04)
    clock = Clock(period, sampling=1.0, stamp=1.0, hidden=1.0)
    _, sampled, stamped = clock.step(clock.init(0), 10_000)
    for late in (sampled, stamped):
        assert np.abs(late).max() <= 2.0 * LIMIT * period
        assert np.diff(late).min() > -period
    share = 2.0 * norm.sf(LIMIT * period / 1e-3)
    _, _, stamped = Clock(period, stamp=1e-3).step(Clock(period).init(0), 10_000)
    assert within((np.abs(stamped) == LIMIT * period).sum(), 10_000, share)
