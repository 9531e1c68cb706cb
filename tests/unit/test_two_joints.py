"""Two joints whose torques do not fit together: nobody knows which one is wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conditions import Condition, log, robot_named, truth_of
from gauntlet import blind

from scarid_cli.algorithms.beyond.torques import RelativeGain
from scarid_cli.algorithms.effects.effects import Effect
from scarid_cli.algorithms.inference.gains import relative

ESTIMATES, MOVED = np.array([2.0, -1.0, 0.5]), np.array([0.1, 0.0, 0.0])


def gain_of(amounts: list[float]) -> Effect:
    noise = np.full(len(amounts), 0.01)
    noise[np.isnan(amounts)] = np.nan
    none = np.zeros(3)
    return Effect(RelativeGain.NAME, MOVED, none, MOVED, np.array(amounts), noise, blocks=50)


def test_either_of_two_joints_may_be_the_one_whose_torque_is_wrong() -> None:
    """y1 = g W1 x and y2 = W2 x are y1 = W1 x' and y2 = W2 x' / g, with x' = g x."""
    found = relative(gain_of([np.nan, 0.2]), 0, ESTIMATES)
    np.testing.assert_allclose(found.moved, 1.2 * (ESTIMATES + MOVED) - ESTIMATES)


def test_of_three_joints_the_most_that_agree_are_right() -> None:
    effect = gain_of([np.nan, 0.2, 0.0])
    assert relative(effect, 0, ESTIMATES).moved is effect.moved
    assert relative(replace(effect, name="offset"), 0, ESTIMATES).moved is effect.moved


@pytest.mark.parametrize("wrong", [(0.1, 0.0), (0.0, 0.1)])
@pytest.mark.parametrize("robot", ["scara2", "planar2-gravity"])
def test_the_intervals_allow_for_either(robot: str, wrong: tuple[float, ...]) -> None:
    condition = Condition("", {"torque-constant-error": wrong})
    arm = robot_named(robot)
    found, _ = blind(robot, log(arm, condition, 30_000))
    rows = next(iter(found.batches)).to_pylist()
    truth = truth_of(arm, condition)
    far = [
        abs(row["estimate"] - x) / row["robust_error"] for row, x in zip(rows, truth, strict=True)
    ]
    assert max(far) < 3.5
    assert any("do not fit together" in reason for reason in found.meta.extra["reasons"])
