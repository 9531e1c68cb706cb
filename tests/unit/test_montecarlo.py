"""A small part of `make montecarlo` and `make bench-verdicts`: intervals and verdicts."""

from __future__ import annotations

import numpy as np
import pytest
import verdicts
from conftest import seeds
from crossvalidation import log
from defaults import ROBOT
from montecarlo import Z95, identified
from verdicts import CONDITIONS, motion

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS

RUNS = [500 + seed for seed in seeds(8, 30)]


def test_the_stated_intervals_contain_the_truth_and_those_of_white_residuals_do_not() -> None:
    """90 to 99 % of the intervals of 8 parameters; each in at least 80 % of the experiments."""
    truth = ROBOT.apriori
    kalman = DIFFERENTIATORS.load("kalman")()
    inside, white = [], []
    for seed in RUNS:
        estimates, errors, low, high, extra = identified(kalman, log(seed))
        inside.append((low <= truth) & (truth <= high))
        white.append(np.abs(estimates - truth) <= Z95 * errors)
        assert extra["delay"] == pytest.approx(5e-4, abs=5e-4)
    assert 0.9 <= np.mean(inside) <= 0.99
    assert np.mean(inside, axis=0).min() >= 0.8
    assert np.mean(white) < 0.7


CELLS = {condition.name: condition for condition in CONDITIONS}


@pytest.mark.parametrize(
    "name",
    ["kalman unmatched, noise x4", "high-gain unmatched", "savgol-end unmatched, noise x4"],
)
def test_unmatched_signals_are_never_confidently_wrong(name: str) -> None:
    for seed in RUNS[:5]:
        run = verdicts.identified(motion(CELLS[name], seed))
        assert not run.good or run.off.max() < 3.0


@pytest.mark.parametrize(
    "name", ["clean", "torque late by 4 samples", "offset", "Stribeck, up to 0.3 rad/s"]
)
def test_intervals_hold_and_nothing_is_doubted_without_reason(name: str) -> None:
    runs = [verdicts.identified(motion(CELLS[name], seed)) for seed in RUNS[:5]]
    inside = [(r.low <= ROBOT.apriori) & (ROBOT.apriori <= r.high) for r in runs]
    assert np.mean(inside) >= 0.9
    if name == "clean":
        assert all(run.good for run in runs)
        assert np.median([run.extra["widened"] for run in runs]) < 1.3
