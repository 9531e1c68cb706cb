"""A small part of `make montecarlo`: coverage of the intervals, and detection of bias."""

from __future__ import annotations

import numpy as np
import pytest
from crossvalidation import log
from defaults import ROBOT
from montecarlo import Z95, identified

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS

RUNS = range(500, 530)


def test_the_stated_intervals_contain_the_truth_and_those_of_white_residuals_do_not() -> None:
    """30 experiments: 90 to 98 % of 240 intervals; each parameter in at least 24 of 30."""
    truth = ROBOT.apriori
    kalman = DIFFERENTIATORS.load("kalman")()
    inside, white = [], []
    for seed in RUNS:
        estimates, errors, low, high, extra = identified(kalman, log(seed))
        inside.append((low <= truth) & (truth <= high))
        white.append(np.abs(estimates - truth) <= Z95 * errors)
        assert extra["delay"] == pytest.approx(5e-4, abs=5e-4)
    assert 0.9 <= np.mean(inside) <= 0.98
    assert np.sum(inside, axis=0).min() >= 24
    assert np.mean(white) < 0.7


@pytest.mark.parametrize("method", ["kalman", "high-gain", "savgol-end"])
def test_bias_is_reported_and_nothing_else_is(method: str) -> None:
    differentiator = DIFFERENTIATORS.load(method)()

    def reported(seed: int, *, match: bool) -> bool:
        reasons = identified(differentiator, log(seed), match=match)[-1]["reasons"]
        return any(reason.startswith("biased") for reason in reasons)

    assert sum(reported(seed, match=False) for seed in RUNS[:10]) == 10
    assert sum(reported(seed, match=True) for seed in RUNS[:10]) <= 1
