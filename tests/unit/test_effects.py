"""How far alternatives to the model move the estimates: on one axis with known imperfections."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from conftest import seeds
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.signal import butter, sosfiltfilt
from scipy.stats import binom
from unit.regressions import estimated

from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.positions import OwnDelays
from scarid_cli.algorithms.beyond.rows import Parallel
from scarid_cli.algorithms.beyond.signals import Signals
from scarid_cli.algorithms.beyond.torques import (
    Cable,
    Curvature,
    Drift,
    LoadFriction,
    Offset,
    Saturation,
    Spring,
    Stribeck,
)
from scarid_cli.algorithms.effects.curvature import Form, form
from scarid_cli.algorithms.effects.effects import Effect
from scarid_cli.algorithms.effects.parallel import differences
from scarid_cli.algorithms.estimators import ls
from scarid_cli.algorithms.inference import alignment
from scarid_cli.algorithms.inference.alignment import Aligned, aligned
from scarid_cli.algorithms.inference.diagnostics import Diagnosis, Diagnostics
from scarid_cli.algorithms.regression.rows import Rows, plain, rows_of, thinned
from scarid_cli.algorithms.regression.shifting import led, shifted
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.uncertainty.reversals import away_from_reversals
from scarid_cli.arrays import Array

AXIS = load("emps")
H = 0.005  # s
NOISE = 1.0  # N
DRIVE = 3.0  # N
Change = Callable[[Array], Array]


def moved(samples: int = 6000) -> Array:
    """Position, velocity and acceleration (3, 1, samples) of a sum of sines."""
    t = np.arange(samples) * H
    sines = [(0.08, 0.31, 0.0), (0.05, 0.83, 1.0), (0.01, 1.9, 2.0), (0.002, 3.1, 0.5)]
    q, dq, ddq = np.zeros((3, samples))
    for size, frequency, phase in sines:
        w = 2.0 * np.pi * frequency
        q += size * np.sin(w * t + phase)
        dq += size * w * np.cos(w * t + phase)
        ddq -= size * w * w * np.sin(w * t + phase)
    return np.stack((q, dq, ddq))[:, None]


def axis(tau: Change | None = None, motion: Change | None = None, seed: int = 0) -> Rows:
    """Rows of the axis; `tau` makes torques of the motion, and `motion` what is measured of it."""
    true = moved()
    exact = AXIS.torques(AXIS.regressor(*true), AXIS.apriori)
    torque = exact if tau is None else exact + tau(true)
    noise = NOISE * np.random.default_rng(seed).standard_normal(exact.shape)
    seen = true if motion is None else motion(true)
    return rows_of(AXIS, np.stack((*seen, torque + noise)), np.arange(exact.shape[1]), H)


def test_the_form_of_a_lead_is_open_where_no_row_of_a_joint_counts() -> None:
    rows = axis()
    none = replace(rows, scales=np.zeros_like(rows.scales))
    residual = rows.y - rows.W @ AXIS.apriori
    assert form(none, rows.y, (residual, residual)) == Form(0.0, 0.0)


def forward(rows: Rows) -> Rows:
    """The rows as of a joint that never reverses."""
    motion = rows.motion.copy()
    motion[1] = 1.0
    return replace(rows, motion=motion)


def diagnosed(rows: Rows) -> Diagnostics:
    found = estimated(ls.Estimator(), rows)
    return Diagnosis(rows, found, 4, model=Model(AXIS, [0, 1, 2, 3])).diagnostics


def effect(rows: Rows, name: str) -> Effect:
    return next(effect for effect in diagnosed(rows).effects if effect.name == name)


def test_effects_are_as_seldom_significant_as_chance_where_the_model_holds() -> None:
    """At 5 %, more than these, 6 of 30, would come by chance once in a thousand times."""
    found = [diagnosed(axis(seed=seed)) for seed in seeds(15, 30)]
    counts = Counter(e.name for one in found for e in one.effects if e.significant(0.05))
    assert len(found[0].effects) > 8
    assert max(counts.values()) <= binom.ppf(0.999, len(found), 0.05)
    assert np.median([one.errors / one.scatter for one in found]) < 1.15


def attenuated(motion: Array) -> Array:
    """A soft sensor whose acceleration is a tenth too small."""
    return motion * np.array([1.0, 1.0, 0.9])[:, None, None]


def test_derivatives_that_are_not_those_of_the_position_are_found() -> None:
    found = effect(axis(motion=attenuated), Parallel.NAME)
    assert found.significant()
    assert found.apart[0] == pytest.approx(-0.1 / 0.9 * AXIS.apriori[0], rel=0.05)


def late(motion: Array) -> Array:
    """Torques three samples late."""
    exact = AXIS.torques(AXIS.regressor(*motion), AXIS.apriori)
    return np.roll(exact, 3, axis=1) - exact


def elastic(motion: Array) -> Array:
    """A joint between motor and load that vibrates at 8 Hz with the motor locked."""
    curvature = np.gradient(np.gradient(motion[2], H, axis=1), H, axis=1)
    return np.asarray(-AXIS.apriori[0] * curvature / (2.0 * np.pi * 8.0) ** 2)


@pytest.mark.parametrize("tau", [late, elastic])
def test_delays_and_flexible_joints_are_found(tau: Change) -> None:
    assert effect(axis(tau), OwnDelays.NAME).significant()


def stribeck(motion: Array) -> Array:
    return DRIVE * np.sign(motion[1]) * np.exp(-((motion[1] / 0.1) ** 2))


def bent(motion: Array) -> Array:
    """Friction that decreases over all of the usual speeds."""
    return 4.0 * DRIVE * np.sign(motion[1]) * np.exp(-((motion[1] / 0.25) ** 2))


def loaded(motion: Array) -> Array:
    """Friction that grows by 5 % of the force of inertia."""
    _, dq, ddq = motion
    return np.asarray(0.05 * np.abs(AXIS.apriori[0] * ddq) * np.sign(dq))


def pulled(motion: Array) -> Array:
    """A cable that pulls with 20 N/m."""
    return 20.0 * motion[0]


def bent_far(motion: Array) -> Array:
    """A cable that pulls with the cube of the position, half of it in proportion."""
    q = motion[0] / np.max(np.abs(motion[0]))
    return np.asarray(3.0 * q + 10.0 * q**3)


def saturated(motion: Array) -> Array:
    """A motor whose constant falls by a tenth up to the largest force."""
    exact = AXIS.torques(AXIS.regressor(*motion), AXIS.apriori)
    return np.asarray(0.1 * exact * np.abs(exact) / np.max(np.abs(exact)))


@pytest.mark.parametrize(
    ("tau", "name"),
    [
        (stribeck, Stribeck.NAME),
        (bent, Curvature.NAME),
        (loaded, LoadFriction.NAME),
        (pulled, Spring.NAME),
        (bent_far, Cable.NAME),
        (saturated, Saturation.NAME),
    ],
)
def test_intervals_allow_for_torques_that_the_model_lacks(tau: Change, name: str) -> None:
    rows = axis(tau)
    found = diagnosed(rows)
    assert next(effect for effect in found.effects if effect.name == name).significant()
    off = np.abs(estimated(ls.Estimator(), rows).fit.estimates - AXIS.apriori)
    assert np.any(off > 3.0 * found.scatter)
    assert np.all(off < 3.0 * found.errors)


def drifting(motion: Array) -> Array:
    """A force that is logged 5 N too low at the start and 5 N too high at the end."""
    return np.linspace(-5.0, 5.0, motion.shape[2])[None]


def test_a_drift_of_the_torque_is_found() -> None:
    assert effect(axis(drifting), Drift.NAME).significant()


def test_a_drift_has_no_mean_and_a_spring_has_one() -> None:
    """An offset is the mean over the log, but the torque of a spring where it is slack."""
    rows = replace(axis(), motion=axis().motion + 0.3)
    signals = Signals.of(rows, None, AXIS.apriori)
    drift, spring = (kind.columns(signals) for kind in (Drift, Spring))
    assert drift is not None
    assert spring is not None
    assert abs(drift.mean()) < 1e-9
    assert spring.shape == (rows.samples, 1, 2)
    assert spring[:, 0, 1].mean() == pytest.approx(rows.motion[0].mean())


def test_what_the_model_has_is_no_alternative() -> None:
    """The axis has an offset; a second one would be singular."""
    assert Offset.NAME not in [effect.name for effect in diagnosed(axis()).effects]


def test_a_log_without_noise_has_no_effects_beyond_rounding() -> None:
    rows = axis()
    exact = replace(rows, y=rows.W @ AXIS.apriori)
    for found in diagnosed(exact).effects:
        # Differences of five samples are exact to the fourth power of the period only.
        assert np.all(np.abs(found.apart) < 1e-4 * np.abs(AXIS.apriori))


def test_rows_near_reversals_are_left_out() -> None:
    rows = axis()
    away = away_from_reversals(rows)
    velocity = rows.motion[1, 0]
    turns = np.flatnonzero(np.diff(np.sign(velocity)))
    for turn in turns[1:-1]:
        assert not away[turn - 19 : turn + 20].any()
    assert 0.5 < away.mean() < 0.95


def test_differences_are_exact_for_polynomials_of_degree_four() -> None:
    t = np.arange(20) * 0.1
    dq, ddq = differences((t**4 - t)[None], 0.1)
    np.testing.assert_allclose(dq[0, 2:-2], (4.0 * t**3 - 1.0)[2:-2], rtol=1e-9)
    np.testing.assert_allclose(ddq[0, 2:-2], (12.0 * t**2)[2:-2], rtol=1e-9, atol=1e-9)


def test_rows_of_a_fast_log_are_thinned_to_5_ms() -> None:
    rows = replace(axis(), h=0.001)
    few = thinned(rows)
    assert few.h == pytest.approx(0.005)
    np.testing.assert_array_equal(few.at, np.arange(1200))
    np.testing.assert_array_equal(few.y, rows.y[::5])


def aligned_by_least_squares(rows: Rows) -> Aligned:
    estimates = estimated(ls.Estimator(), rows).fit.estimates
    return aligned(ls.Estimator(), np.zeros(2), rows, estimates, 1)


@given(samples=st.floats(-8.0, 8.0))
def test_the_delay_of_the_torques_is_found_however_long(samples: float) -> None:
    """The shift is by interpolation: to first order, half a sample would bias by 2e-4."""
    true, t = moved(2000), np.arange(2000) * H

    def torque(at: Array) -> Array:
        return np.sin(1.3 * at) + 0.3 * np.sin(7.0 * at)

    motion = np.stack((*true, torque(t + samples * H)[None]))
    rows = rows_of(AXIS, motion, np.arange(2000), H)
    rows = forward(replace(rows, W=torque(t)[:, None, None]))
    found = aligned_by_least_squares(rows)
    assert found.delay == pytest.approx(samples * H, abs=1e-6)
    assert found.found.fit.estimates[0] == pytest.approx(1.0, abs=1e-6)


WAVES = ((1.0, 1.3), (0.5, 4.0), (0.3, 7.0), (0.2, 12.0), (0.1, 17.0))  # N, rad/s


def behind(kind: str, lag: float) -> tuple[Rows, Array]:
    """Rows whose W is a sum of waves, in closed form, and the noise-free torques behind a lag [s].

    A "drive" makes the torque a low-passed command, which is what the log has. "both" are a delay
    and a low-pass of half the lag each.
    """
    true, t = moved(4000), np.arange(4000) * H
    shown = {
        "delay": lambda w: np.exp(-1j * w * lag),
        "low-pass": lambda w: 1.0 / (1.0 + 1j * w * lag),
        "drive": lambda w: 1.0 + 1j * w * lag,
        "both": lambda w: np.exp(-0.5j * w * lag) / (1.0 + 0.5j * w * lag),
    }[kind]
    torque = sum(a * np.exp(1j * w * t) for a, w in WAVES).imag
    logged = sum(a * shown(w) * np.exp(1j * w * t) for a, w in WAVES).imag
    rows = rows_of(AXIS, np.stack((*true, logged[None])), np.arange(4000), H)
    return replace(rows, W=np.ascontiguousarray(torque[:, None, None])), logged


@pytest.mark.parametrize("kind", ["delay", "low-pass", "drive"])
def test_a_low_pass_is_told_from_a_delay(kind: str) -> None:
    """To first order both are alike; a delay in the place of a low-pass biases by 0.2 %."""
    rows, logged = behind(kind, 0.004)
    noise = 0.01 * np.random.default_rng(7).standard_normal(len(logged))
    rows = replace(rows, y=rows.y + noise[:, None])
    found = aligned_by_least_squares(rows)
    assert found.lead.low_pass == (kind != "delay")
    assert found.delay == pytest.approx(0.004 if kind == "drive" else -0.004, abs=1e-4)
    assert found.found.fit.estimates[0] == pytest.approx(1.0, abs=5e-4)
    assert found.lead.doubt is not None
    assert np.abs(found.lead.doubt[0]) < 1e-4
    predicted = led(rows, rows.W[:, :, 0], found.delay, low_pass=found.lead.low_pass)
    inside = slice(200, -200)
    assert np.std((predicted[:, 0] - logged)[inside]) < 2e-3


def test_estimates_are_uncertain_by_the_part_of_a_lag_that_has_the_other_form() -> None:
    """A delay is found, and the curvature of a quarter of that of a low-pass is missed."""
    rows, logged = behind("both", 0.012)
    noise = 0.01 * np.random.default_rng(7).standard_normal(len(logged))
    found = aligned_by_least_squares(replace(rows, y=rows.y + noise[:, None]))
    assert not found.lead.low_pass
    assert found.lead.doubt is not None
    mean_square = sum((a * w) ** 2 for a, w in WAVES) / sum(a**2 for a, _ in WAVES)
    missed = 0.25 * 0.5 * 0.012**2 * mean_square
    assert abs(found.lead.doubt[0]) == pytest.approx(missed, rel=0.1)
    assert 0.5 * missed < abs(found.found.fit.estimates[0] - 1.0) < missed


def strokes(late: int, seed: int, samples: int = 4000) -> Rows:
    """Strokes of constant acceleration and velocity, with torques so many samples late.

    All signals have passed one low-pass of 20 Hz, forwards and backwards.
    """
    rng = np.random.default_rng(seed)
    ddq, at, side = np.zeros(samples), 0, 1.0
    while at < samples:
        ramp, constant, rest = rng.integers((10, 0, 20), 60)
        acceleration = side * rng.uniform(1.0, 4.0)
        for count, value in ((ramp, 1.0), (constant, 0.0), (ramp, -1.0), (rest, 0.0)):
            ddq[at : at + count] = value * acceleration
            at += count
        side = -side
    dq = np.cumsum(ddq) * H
    true = np.stack((np.cumsum(dq) * H, dq, ddq))[:, None]
    exact = AXIS.torques(AXIS.regressor(*true), AXIS.apriori)
    torque = np.roll(exact, late, axis=1) + NOISE * rng.standard_normal(exact.shape)
    low_pass = butter(2, 20.0, fs=1.0 / H, output="sos")
    seen = sosfiltfilt(low_pass, np.concatenate((true, torque[None])), axis=2)
    return rows_of(AXIS, seen, np.arange(samples), H)


@pytest.mark.parametrize("late", [-3, 2])
def test_accelerations_that_jump_do_not_hide_a_delay(late: int) -> None:
    """A low-pass in its place has residuals many times as large, and a mass 5 % off."""
    for seed in range(20):
        rows = strokes(late, seed)
        estimates = estimated(ls.Estimator(), rows).fit.estimates
        found = aligned(ls.Estimator(), np.zeros(5), rows, estimates, 4)
        assert not found.lead.low_pass
        assert found.delay == pytest.approx(-late * H, abs=0.1 * H)
        assert found.found.fit.estimates[0] == pytest.approx(AXIS.apriori[0], rel=2e-3)


def test_estimates_are_uncertain_where_a_low_pass_and_a_delay_cannot_be_told_apart() -> None:
    """Half the difference of the two, squared, is the mean square of an even chance.

    Which part of the lead has which form is as uncertain, and may add the whole difference.
    """
    rows, logged = behind("delay", 0.004)
    noise = 0.3 * np.random.default_rng(7).standard_normal(len(logged))
    rows = replace(rows, y=rows.y + noise[:, None])
    found = aligned_by_least_squares(forward(rows))
    assert found.lead.doubt is not None
    mean_square = sum((a * w) ** 2 for a, w in WAVES) / sum(a**2 for a, _ in WAVES)
    difference = 0.5 * found.delay**2 * mean_square
    assert 0.95 * np.sqrt(0.5) < abs(found.lead.doubt[0]) / difference < 1.05 * np.sqrt(1.5)


def test_a_lead_that_the_log_does_not_show_is_taken_as_none() -> None:
    """Its error would be 32 ms. The doubt is what a lead of 10 ms does, here by its slope."""
    rows, logged = behind("delay", 0.004)
    noise = 5.0 * np.random.default_rng(7).standard_normal(len(logged))
    rows = forward(replace(rows, y=rows.y + noise[:, None]))
    found = aligned_by_least_squares(rows)
    plain_fit = estimated(ls.Estimator(), rows).fit.estimates
    assert not found.lead.shown
    assert found.delay == 0.0
    np.testing.assert_array_equal(found.found.fit.estimates, plain_fit)
    late = estimated(ls.Estimator(), shifted(rows, 2.0)).fit.estimates
    assert found.lead.doubt is not None
    assert found.lead.doubt[0] == pytest.approx((late - plain_fit)[0], rel=1e-6)


def servo(seed: int) -> Rows:
    """An axis whose torque is mostly viscous, 4 s of it, with noise of 2 % in its acceleration."""
    rng = np.random.default_rng(seed)
    true = moved(800)
    torque = SERVO @ np.concatenate((true[2], true[1], np.sign(true[1]), np.ones_like(true[0])))
    seen = true.copy()
    seen[2] += 0.02 * np.std(true[2]) * rng.standard_normal(true[2].shape)
    noise = 0.02 * np.std(torque) * rng.standard_normal(torque.shape)
    return rows_of(AXIS, np.stack((*seen, (torque + noise)[None])), np.arange(800), H)


SERVO = np.array([0.02, 0.9, 0.08, 0.0])  # kg, N s/m, N and N: 22 ms of delay are like the mass


def test_a_delay_does_not_take_the_place_of_an_inertia() -> None:
    """A delay of 2 M / Fv and a mass of -M predict the same torques, to second order."""
    errors = []
    for seed in range(40):
        rows = servo(seed)
        estimates = estimated(ls.Estimator(), rows).fit.estimates
        found = aligned(
            ls.Estimator(), np.zeros(5), rows, estimates, 4, lambda theta: bool(theta[0] >= 0.0)
        )
        assert abs(found.delay) < 0.01
        errors.append(found.found.fit.estimates[0] - SERVO[0])
    assert np.sqrt(np.mean(np.square(errors))) < 0.2 * SERVO[0]


def test_the_delay_of_a_long_log_is_found_in_blocks_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = strokes(2, 1)
    estimates = estimated(ls.Estimator(), whole).fit.estimates
    in_all = aligned(ls.Estimator(), np.zeros(5), whole, estimates, 4)
    monkeypatch.setattr(alignment, "SEARCHED", whole.W.size // 3)
    some = alignment._some(whole)
    assert whole.samples // 4 < some.samples <= whole.samples // 3
    assert set(some.at) < set(whole.at)
    in_some = aligned(ls.Estimator(), np.zeros(5), whole, estimates, 4)
    assert in_some.rows.samples == in_all.rows.samples
    assert in_some.delay == pytest.approx(-2 * H, abs=0.1 * H)
    np.testing.assert_allclose(
        in_some.found.fit.estimates[:4], in_all.found.fit.estimates[:4], rtol=2e-3
    )


def test_torques_are_shifted_within_runs_only() -> None:
    rows = axis().part(np.r_[0:100, 200:300])
    moved_rows = shifted(rows, 3.0)
    np.testing.assert_array_equal(moved_rows.y[3:100], rows.y[:97])
    assert not moved_rows.scales[np.r_[0:3, 100:103]].any()
    assert moved_rows.scales.sum() == 194
    between = shifted(rows, 1.5)  # from three samples before and after the instant
    assert not between.scales[np.r_[0:4, 99:104, 199]].any()
    assert between.scales.sum() == 200 - 4 - 1 - 4 - 1


@given(shift=st.floats(-4.0, 4.0))
@example(shift=0.5)
@example(shift=-1.5)
def test_torques_that_jump_at_reversals_are_shifted_without_ripple(shift: float) -> None:
    """A polynomial through both sides of a jump would overshoot by 9 % of it."""
    rows = axis()
    direction = np.sign(rows.motion[1].T)
    ahead = np.clip(np.arange(rows.samples) + round(shift), 0, rows.samples - 1)
    moved_rows = shifted(replace(rows, y=direction[ahead]), shift)
    known = moved_rows.scales[:, 0] > 0.0
    np.testing.assert_allclose(moved_rows.y[known], direction[known], atol=1e-12)
    predicted = led(rows, direction, shift * H)
    assert np.abs(predicted).max() < 1.0 + 1e-12


@given(shift=st.floats(-4.0, 4.0), degree=st.integers(0, 5))
def test_polynomials_of_degree_five_are_shifted_exactly(shift: float, degree: int) -> None:
    rows = forward(axis())
    at = np.arange(rows.samples)[:, None] / rows.samples
    moved_rows = shifted(replace(rows, y=at**degree), shift)
    known = moved_rows.scales[:, 0] > 0.0
    expected = (at - shift / rows.samples) ** degree
    np.testing.assert_allclose(moved_rows.y[known], expected[known], atol=1e-14)
    assert known.sum() >= rows.samples - 9


def low_passed(t: Array, lag: float, w: float) -> Array:
    """sin(w t) behind a low-pass of first order with this time constant."""
    return np.asarray((np.exp(1j * w * t) / (1.0 + 1j * w * lag)).imag)


@pytest.mark.parametrize("lag", [0.002, 0.01, 0.05])
def test_predicted_torques_are_those_behind_a_low_pass(lag: float) -> None:
    """Within 0.1 % of 8 Hz at 200 Hz; the straight lines between samples alone lose 0.5 %."""
    rows, w = forward(axis()), 2.0 * np.pi * 8.0
    t = np.arange(rows.samples)[:, None] * H
    found = led(rows, np.sin(w * t), -lag, low_pass=True)
    inside = slice(int(10.0 * lag / H), -2)
    np.testing.assert_allclose(found[inside], low_passed(t, lag, w)[inside], atol=1e-3)


@pytest.mark.parametrize("samples", [0, 1, 2, 50])
def test_constant_torques_are_the_same_behind_a_low_pass(samples: int) -> None:
    rows = plain(np.ones((samples, 1, 1)), np.ones((samples, 1)), H)
    for lag in (0.5, 0.01, 1e-12):
        found = led(rows, rows.y, -lag, low_pass=True)
        np.testing.assert_allclose(found, rows.y, rtol=1e-12)


@pytest.mark.parametrize("lag", [0.004, 0.01, 0.02])
def test_torques_behind_a_slow_low_pass_do_not_bias(lag: float) -> None:
    """To second order, a low-pass of 8 Hz (20 ms) biases by 1.3 %."""
    rows, _ = behind("low-pass", lag)
    found = aligned_by_least_squares(forward(rows))
    assert found.lead.low_pass
    assert found.delay == pytest.approx(-lag, rel=1e-3)
    assert found.found.fit.estimates[0] == pytest.approx(1.0, abs=2e-4)


def test_predicted_torques_lead_as_the_fit_says() -> None:
    rows = forward(axis())
    t = np.arange(rows.samples)[:, None] * H
    for delay in (-0.0123, 0.0004, 0.021):
        found = led(rows, np.sin(t), delay)
        inside = slice(8, -8)  # at the ends the last sample is held
        np.testing.assert_allclose(found[inside], np.sin(t + delay)[inside], atol=1e-14)
