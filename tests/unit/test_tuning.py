"""Settings from the data: as near to those from the truth as the data allow."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
import pytest
from conftest import long
from unit.support import PERIOD

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters.likelihood import best_model
from scarid_cli.algorithms.processes.delays import reference
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.algorithms.processes.resolution import resolution_of
from scarid_cli.algorithms.tuning import judges, search
from scarid_cli.arrays import Array
from scarid_cli.errors import TooShort
from scarid_cli.stages.records.record import Record
from scarid_cli.stages.tune import chosen, octaves, online, tune

RESOLUTION = 2.0 * np.pi / 2**14
SEARCHED = [name for name in DIFFERENTIATORS.names if DIFFERENTIATORS.load(name).TUNED]


def readings(seed: int = 0) -> tuple[Array, Array, Array]:
    """Quintic moves as an encoder of 14 bit with some noise sees them, and their derivatives."""
    q, v, a = reference(PERIOD)
    noise = 0.3 * RESOLUTION * np.random.default_rng(seed).standard_normal(len(q))
    return RESOLUTION * np.round((q + noise) / RESOLUTION), v, a


def error(method: Any, q: Array, v: Array, a: Array) -> float:
    """The geometric mean of both errors against the truth, each over the size of the truth."""
    inner = slice(200, -200)
    errors = [
        np.std((x - y)[inner]) / np.std(y[inner])
        for x, y in zip(over(method, q, PERIOD), (v, a), strict=True)
    ]
    return float(np.sqrt(errors[0] * errors[1]))


def best(trials: list[search.Trial]) -> Any:
    return min(trials, key=lambda trial: trial.loss).method


@pytest.mark.parametrize("name", SEARCHED)
def test_what_is_searched_are_settings_with_a_range_around_the_default(name: str) -> None:
    method = DIFFERENTIATORS.load(name)()
    for setting, r in method.TUNED.items():
        low, high = (r.setting(x, PERIOD) for x in (0.0, 1.0))
        assert low <= getattr(method, setting) <= high
        for x in (0.0, 0.3, 1.0):
            replace(method, **{setting: r.setting(x, PERIOD)})


@pytest.mark.parametrize("step", [1, 2])
def test_a_range_in_samples_gives_whole_numbers(step: int) -> None:
    r = Range(0.05, 1.0, samples=True, step=step)
    values = [r.setting(x, 0.01) for x in np.linspace(0.0, 1.0, 50)]
    assert all(value % step == 1 % step for value in values)
    assert (min(values), max(values)) == (5, 100 if step == 1 else 101)


@pytest.mark.parametrize(
    "name",
    [
        *("p2smd", "2smd", "high-gain", "savgol-end"),
        *(pytest.param(name, marks=long) for name in ("levant", "filtering", "tracking")),
    ],
)
def test_a_smoother_judges_nearly_as_well_as_the_truth(name: str) -> None:
    """The settings it chooses are at most 15 % worse than those that the truth would choose."""
    q, v, a = readings()
    method = DIFFERENTIATORS.load(name)()
    blind = best(
        list(search.search(method, method.TUNED, judges.distance_to_smoother(q, PERIOD), PERIOD, 0))
    )
    informed = best(
        list(search.search(method, method.TUNED, lambda m: error(m, q, v, a), PERIOD, 0))
    )
    assert error(blind, q, v, a) < 1.15 * error(informed, q, v, a)
    assert error(blind, q, v, a) < error(method, q, v, a) * 1.001


def test_the_smoother_is_nearer_to_the_truth_than_what_it_judges() -> None:
    q, v, a = readings()
    smooth = error(judges.smoother(q, PERIOD), q, v, a)
    judge = judges.distance_to_smoother(q, PERIOD)
    nearest = min(
        judge(best(list(search.search(m(), m.TUNED, judge, PERIOD, 0))))
        for m in (DIFFERENTIATORS.load(name) for name in ("p2smd", "high-gain", "levant"))
    )
    assert smooth < 0.25 * nearest


@pytest.mark.parametrize("name", ["kalman", "kalman-lag", "rts"])
def test_likelihood_prefers_its_fit(name: str) -> None:
    q, _, _ = readings()
    method = DIFFERENTIATORS.load(name)()
    fitted = best_model(method, q, PERIOD)
    judge = judges.negative_log_likelihood(q, PERIOD)
    for factor in (0.3, 3.0):
        assert judge(fitted) < judge(replace(fitted, intensity=factor * fitted.intensity))
        assert judge(fitted) < judge(replace(fitted, noise=factor * fitted.noise))
    sigma = RESOLUTION * np.hypot(1.0 / np.sqrt(12.0), 0.3)
    assert fitted.noise == pytest.approx(sigma, rel=0.05)


def two_joints(*sigmas: float) -> Array:
    """Quintic moves of two joints with white noise of these standard deviations."""
    rng = np.random.default_rng(0)
    q = reference(PERIOD)[0]
    return np.array([q + sigma * rng.standard_normal(len(q)) for sigma in sigmas])


@pytest.mark.parametrize("sigmas", [(1e-4, 1e-3), (1e-3, 1e-4)])
def test_settings_for_all_joints_come_from_all_joints(sigmas: tuple[float, float]) -> None:
    """Of one variance for two records, the most likely is the mean of theirs, in either order."""
    q = two_joints(*sigmas)
    rows = tune(Record((q,), 2, PERIOD), ["kalman"], 0, list)
    noise = next(row.trial.method.noise for row in rows if row.best)
    assert noise == pytest.approx(np.sqrt(np.mean(np.square(sigmas))), rel=0.05)


def test_joints_that_move_alike_are_tuned_as_one_of_them() -> None:
    q = two_joints(3e-4)
    alone, both = (best_model(DIFFERENTIATORS.load("kalman")(), x, PERIOD) for x in (q, [*q, *q]))
    assert both.states == alone.states
    assert both.noise == pytest.approx(alone.noise, rel=1e-2)


def test_a_record_needs_more_rows_than_its_model_has_states_and_settings() -> None:
    """Five states, and noise, intensity, damping and frequency: ten rows, as the message says."""
    method, (q,) = DIFFERENTIATORS.load("kalman")(), two_joints(3e-4)
    assert best_model(method, q[100:110], PERIOD).noise > 1e-6
    with pytest.raises(TooShort, match=r"^9 rows are too few .* at least 10 rows$"):
        best_model(method, q[100:109], PERIOD)


def test_the_same_seed_gives_the_same_trials() -> None:
    q, _, _ = readings()
    record = Record((q[None, :],), 1, PERIOD)
    first, second, other = (
        [(row.settings, row.trial.loss) for row in tune(record, ["p2smd"], seed, list)]
        for seed in (1, 1, 2)
    )
    assert first == second != other


def test_the_chosen_settings_are_the_best_of_those_tried() -> None:
    q, _, _ = readings()
    record = Record((np.array([q, 0.5 * q]),), 2, PERIOD)
    rows = tune(record, ["high-gain", "backward"], 0, list)
    settings = chosen(rows, 2)
    assert settings["backward"] == {}
    mine = [row for row in rows if row.name == "high-gain"]
    least = min(mine, key=lambda row: row.trial.loss)
    assert least.best
    assert settings["high-gain"]["bandwidth"] == [least.trial.method.bandwidth] * 2


def test_every_causal_method_is_tuned_by_all() -> None:
    assert set(online()) == {
        name for name in DIFFERENTIATORS.names if DIFFERENTIATORS.load(name)().lag(0.01) == 0
    }
    assert {"kalman", "p2smd", "2smd", "astd", "ed-fir"} <= set(online())


def test_the_noise_is_at_least_that_of_the_resolution() -> None:
    """A slow motion crosses a step of the encoder now and then; between them, nothing scatters."""
    t = np.arange(4000) * PERIOD
    step = 1e-3
    x = step * np.round(0.02 * np.sin(0.5 * t) / step)
    assert resolution_of(x) == pytest.approx(step)
    for joints in (x, np.array([x, x])):
        fitted = best_model(DIFFERENTIATORS.load("kalman")(), joints, PERIOD)
        assert fitted.noise >= 0.999 * step / np.sqrt(12.0)


def test_joints_with_different_bandwidths_are_seen() -> None:
    t = np.arange(4000) * PERIOD
    rng = np.random.default_rng(0)
    slow, fast = (np.sin(rate * t) + 1e-4 * rng.standard_normal(len(t)) for rate in (1.0, 20.0))
    apart, own = octaves(Record((np.array([slow, fast]),), 2, PERIOD))
    assert apart > 1.0
    assert own[0] < own[1]
    assert octaves(Record((np.array([fast, fast]),), 2, PERIOD))[0] == 0.0


def test_a_method_that_diverges_loses() -> None:
    q, _, _ = readings()
    judge = judges.distance_to_smoother(q, PERIOD)
    wild = DIFFERENTIATORS.load("p2smd")(gamma0=2000.0, gamma1=2000.0)
    assert not judge(wild) < inf
