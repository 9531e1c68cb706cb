"""A state of each estimator is known as one, and nothing else is."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, get_type_hints

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.algorithms.choices.registry import ESTIMATORS
from scarid_cli.algorithms.regression.rows import plain
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.uncertainty.checkpoint import Checkpoint
from scarid_cli.stages.results.soundness import require_state

JOINTS, PARAMETERS = 2, 8
ROWS = plain(np.ones((5, JOINTS, PARAMETERS)), np.ones((5, JOINTS)))


def checkpoint_of(name: str) -> tuple[Checkpoint, Any]:
    """The checkpoint of an estimator before the first row, but with rows, and its type of state."""
    estimator = ESTIMATORS.load(name)().for_robot(load("scara2"))
    start = Checkpoint.at_start(estimator.init(np.ones(PARAMETERS)), 0.001)
    assert start.blocks
    kind = get_type_hints(type(estimator).init)["return"]
    return replace(start, subsample=start.subsample.add(ROWS), blocks=start.blocks.add(ROWS)), kind


@pytest.mark.parametrize("name", ESTIMATORS.names)
def test_the_state_of_an_estimator_is_one(name: str) -> None:
    require_state(*checkpoint_of(name), JOINTS, PARAMETERS)


@pytest.mark.parametrize("name", ESTIMATORS.names)
def test_a_state_for_another_robot_is_none(name: str) -> None:
    checkpoint, kind = checkpoint_of(name)
    for joints, parameters in ((JOINTS + 1, PARAMETERS), (JOINTS, PARAMETERS - 1)):
        with pytest.raises(ValueError, match="another structure"):
            require_state(checkpoint, kind, joints, parameters)


@given(
    field=st.sampled_from(["W", "y", "scales", "at", "motion", "h", "order", "reference"]),
    other=st.sampled_from(
        [None, "x", True, -1, 2**70, 1e300, float("nan"), (), {}, np.zeros(0), np.zeros((5, 2, 9)),
         np.full((5, 2), np.nan), np.zeros(5, dtype=np.float32), np.arange(5)[::-1]]
    ),
)  # fmt: skip
def test_rows_with_another_field_are_none(field: str, other: Any) -> None:
    if (field, other if isinstance(other, int | None) else "") in (
        ("order", None),
        ("reference", None),
        ("h", 2**70),  # s: long, but a number
    ):
        return
    checkpoint, kind = checkpoint_of("ls")
    subsample = replace(checkpoint.subsample, parts=(replace(ROWS, **{field: other}),))
    with pytest.raises((AttributeError, TypeError, ValueError)):
        require_state(replace(checkpoint, subsample=subsample), kind, JOINTS, PARAMETERS)
