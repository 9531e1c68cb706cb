"""`validate` says `unchanged` only where the residuals are as the identification lets expect."""

from __future__ import annotations

import numpy as np
import pytest

from scarid_cli.algorithms.changes.explanation import Change
from scarid_cli.algorithms.changes.wording import Verdict, of_change

NO_CHANGE = Change(0.5, 11)


def judged(residuals: list[float], fitted: list[float], allowed: list[float]) -> Verdict:
    """The verdict where no test finds a change; all are relative to the torques of two joints."""
    expected = np.array(fitted), np.array(allowed)
    return of_change(NO_CHANGE, {}, np.ones(2), np.array(residuals), expected)


@pytest.mark.parametrize(
    ("residuals", "allowed", "grade", "words"),
    [
        ([0.019, 0.011], [0.0, 0.0], "unchanged", "joint 2 1.1 % (1, 1 % at the identification);"),
        ([0.03, 0.01], [0.02, 0.0], "unchanged", "the intervals of the parameters add joint 1 2 %"),
        ([0.03, 0.01], [0.01, 0.0], "unexplained", "the residual of joint 1 is 3 % of the torque"),
        ([0.01, 0.096], [0.0, 0.01], "unexplained", "residual of joint 2 is 9.6 % of the torque"),
    ],
)
def test_a_residual_beyond_twice_what_was_stated_is_not_unchanged(
    residuals: list[float], allowed: list[float], grade: str, words: str
) -> None:
    """With 1 % at the identification, the bound is 2 (1^2 + allowed^2)^.5."""
    found = judged(residuals, [0.01, 0.01], allowed)
    assert found.grade == grade
    assert words in found.reason
    assert found.reason.endswith("11 tests find no change (smallest p-value 0.5)")


def test_a_residual_that_was_not_stated_is_not_compared() -> None:
    """As that of several tables together."""
    found = judged([0.2, 0.3], [np.nan, 0.01], [0.0, 0.0])
    assert found.grade == "unchanged"
    assert found.reason.startswith("residual joint 1 20 %, joint 2 30 %; 11 tests")
