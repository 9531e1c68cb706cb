"""Online identification without a filter before the soft sensor: what matching achieves."""

from __future__ import annotations

from typing import Any

import crossvalidation
import numpy as np
import pytest

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS

PAIRS = 4


@pytest.fixture(scope="module")
def pairs() -> list[Any]:
    return [
        (crossvalidation.log(2 * seed + 1), crossvalidation.log(2 * seed + 2))
        for seed in range(PAIRS)
    ]


def medians(name: str, pairs: list[Any], *, match: bool, **settings: float) -> Any:
    method = DIFFERENTIATORS.load(name)(**settings)
    return np.median([crossvalidation.judged(method, p, match=match) for p in pairs], axis=0)


def test_the_recommended_pipeline_predicts_another_trajectory(pairs: list[Any]) -> None:
    """The default, causal: by its own motion and by a common one; a few percent of each inertia."""
    own1, own2, common1, common2, zz1r, zz2, l1mx2 = medians("kalman", pairs, match=True)
    assert min(own1, common1) >= 0.997
    assert min(own2, common2) >= 0.985
    assert zz1r <= 1.0
    assert max(zz2, l1mx2) <= 4.0


def test_matched_p2smd_with_the_gains_of_table_1_does_so_too(pairs: list[Any]) -> None:
    settings = DIFFERENTIATORS.load("p2smd").PRESETS["table1"]
    own1, own2, common1, common2, *_ = medians("p2smd", pairs, match=True, **settings)
    assert min(own1, common1) >= 0.996
    assert min(own2, common2) >= 0.975


@pytest.mark.parametrize("name", ["p2smd", "ed-fir", "2smd", "savgol-end", "kalman"])
def test_matching_makes_a_method_better_by_both_judgements(name: str, pairs: list[Any]) -> None:
    matched = medians(name, pairs, match=True)
    plain = medians(name, pairs, match=False)
    assert (matched[:4] > plain[:4]).all()
