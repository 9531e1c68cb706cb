"""What stands behind +-: half the 95 % interval."""

from __future__ import annotations

import pytest
from scipy.stats import norm

from scarid_cli.algorithms.inference.verdict import GRADES, meets
from scarid_cli.interval import HALF, plus_minus
from scarid_cli.words import percents_of_joints


def test_it_is_half_the_interval_of_a_normal_distribution() -> None:
    assert pytest.approx(norm.ppf(0.975), rel=1e-6) == HALF
    assert plus_minus(0.5) == "+- 0.98"
    assert plus_minus(0.5, 1) == "+- 1"


@pytest.mark.parametrize(
    ("parts", "text"),
    [
        ([0.0036], "0.36 %"),
        ([0.0036, 0.0038], "joint 1 0.36 %, joint 2 0.38 %"),
        ([0.01, 0.02, 0.03, 2.0], "joints 1 to 4 1, 2, 3, 200 %"),
    ],
)
def test_figures_of_joints_are_labelled(parts: list[float], text: str) -> None:
    assert percents_of_joints(parts) == text


def test_a_grade_meets_what_is_worse() -> None:
    for place, grade in enumerate(GRADES):
        for required in GRADES[:2]:
            assert meets(required, grade, biased=False) == (place <= GRADES.index(required))
    assert meets("not-biased", "rough", biased=False)
    assert not meets("identifiable", "not identifiable", biased=False)
