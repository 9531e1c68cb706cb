"""The gauntlet of the benchmarks, on the fastest robot and short logs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conditions import CONDITIONS, UNSEEN, Condition, log, mean_drift, robot_named, truth_of
from gauntlet import ROBOTS, cells, run
from mixtures import KINDS, line, mixture, tried
from needed import needed

SHORT = 8.0  # s
SEED = 50_000


def test_the_blind_procedure_is_near_the_best_and_better_than_the_default() -> None:
    found = [run("scara2", Condition("short", duration=SHORT), SEED + n) for n in range(3)]
    blind = np.array([one.blind.torque for one in found])
    ratios = np.array([blind / [min(one.hindsight) for one in found],
                       blind / [one.default for one in found]]).T  # fmt: skip
    assert np.exp(np.log(ratios[:, 0]).mean()) < 1.4
    assert np.exp(np.log(ratios[:, 1]).mean()) < 1.0
    assert not any(one.blind.wrong for one in found)


@pytest.mark.parametrize("condition", CONDITIONS + UNSEEN, ids=lambda condition: condition.name)
def test_every_condition_can_be_simulated(condition: Condition) -> None:
    robot = robot_named("scara2")
    short = replace(condition, duration=4.0)
    table = log(robot, short, SEED)
    assert sum(batch.num_rows for batch in table.batches) >= 0.9 * 4.0 * condition.rate
    assert len(truth_of(robot, short)) == len(robot.names)


def test_the_needed_torques_are_those_of_the_model_and_of_what_it_lacks() -> None:
    clean = Condition("short", duration=SHORT)
    loaded = replace(clean, given={"load-friction": (0.02,)})
    truth = truth_of(robot_named("scara2"), clean)
    rest = []
    for condition in (clean, loaded):
        rows = needed(robot_named("scara2"), condition, SEED)
        W, tau = rows.W, rows.y
        away = np.abs(W[:, 0, 2]) > 0.5  # sign(dq1): the joint moves
        rest.append((tau - W @ truth)[away, 0] * W[away, 0, 2])
        torque = tau[away, 0] - W[away, 0, 2] * truth[2]
    assert np.median(np.abs(rest[0])) < 1e-6
    assert np.median(rest[1] / np.abs(torque)) == pytest.approx(0.02, rel=0.1)


def test_the_mean_of_a_drift_is_that_over_the_motion() -> None:
    """As a sum over small steps, of the time from where the standstill before it ends."""
    given = {"friction-drift": (0.2,), "friction-drift-time": (9.0,), "standstill-before": (4.0,)}
    t = 4.0 + 12.0 * (np.arange(10_000) + 0.5) / 10_000
    expected = np.mean(0.2 * (1.0 - np.exp(-t / 9.0)))
    assert mean_drift(Condition("drift", given, duration=12.0)) == pytest.approx(expected)


def test_mixtures_differ_and_stay_within_their_sizes() -> None:
    """Of 200 logs, every imperfection is in some, and none beyond the sizes that are stated."""
    found = [mixture(seed) for seed in range(200)]
    assert found[7] == mixture(7)
    sizes = [
        {**{n: x[0] for n, x in c.given.items()}, **{n: x for n, (_, x) in c.relative.items()}}
        for c in found
    ]
    for kind in KINDS:
        having = [own for own in sizes if set(kind) <= set(own)]
        assert 0 < len(having) < 100
        for name, (least, largest) in kind.items():
            assert all(least <= own[name] <= largest for own in having)


def test_mixtures_are_judged_as_the_gauntlet_is() -> None:
    found = [tried("scara2", seed) for seed in (4, 8)]
    assert [mixture(seed).duration for seed in (4, 8)] == [SHORT, SHORT]
    row = line("scara2", found).strip("| ").split(" | ")
    assert row[:2] == ["scara2", "2"]
    assert float(row[2]) > 0.0
    assert row[-1] == "0"


def test_every_robot_that_is_here_meets_every_condition() -> None:
    """But for flexible joints, where the robot has no inertia of its motors."""
    found = {name for name, _ in cells(list(ROBOTS), CONDITIONS, [])}
    assert {"scara2", "planar2-gravity"} <= found
    for name in found:
        own = sum(cell == name for cell, _ in cells([name], CONDITIONS, []))
        assert own in (len(CONDITIONS), len(CONDITIONS) - 2)
