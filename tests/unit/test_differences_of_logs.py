"""The difference of two logs: what both say about the parameters, and with how many blocks."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from scipy import stats

from scarid_cli.algorithms.beyond.torques import RelativeGain
from scarid_cli.algorithms.changes.columns import Columns
from scarid_cli.algorithms.changes.evidence import LogEvidence, _without
from scarid_cli.algorithms.changes.explanation import Change, Explanation, _of_search, found_in
from scarid_cli.algorithms.changes.hypotheses import (
    LOW_PASS,
    MOTOR,
    OFFSET,
    Hypothesis,
    hypotheses,
)
from scarid_cli.algorithms.changes.likelihood import Difference, _scatter
from scarid_cli.algorithms.effects.effects import Effect
from scarid_cli.algorithms.inference.diagnostics import Diagnostics
from scarid_cli.algorithms.inference.gains import Gain, apart, relative, significant
from scarid_cli.algorithms.robots.reading import load

RNG = np.random.default_rng(3)
N = 4


def evidence(blocks: int) -> LogEvidence:
    """Any information and score, with the scores of so many blocks."""
    root = RNG.standard_normal((N, N))
    scores = RNG.standard_normal((blocks, N))
    return LogEvidence(root @ root.T + np.eye(N), RNG.standard_normal(N), np.ones(1), scores)


@pytest.mark.parametrize(("one", "other", "freedom"), [(12, 20, 11), (20, 12, 11), (1, 9, 1)])
def test_the_degrees_of_freedom_are_those_of_the_log_with_fewer_blocks(
    one: int, other: int, freedom: int
) -> None:
    assert Difference.between(evidence(one), evidence(other)).freedom == freedom


def test_the_change_is_the_difference_of_the_estimates_weighted_by_its_information() -> None:
    """With N1 and N2, its covariance is inv(N1) + inv(N2); the gradient is its inverse times it."""
    first, second = evidence(9), evidence(9)
    found = Difference.between(first, second)
    covariance = np.linalg.inv(first.information) + np.linalg.inv(second.information)
    change = np.linalg.solve(second.information, second.score)
    change -= np.linalg.solve(first.information, first.score)
    assert found.information == pytest.approx(np.linalg.inv(covariance))
    assert found.gradient == pytest.approx(np.linalg.solve(covariance, change))


@pytest.mark.parametrize(("blocks", "together"), [(1, 1), (2, 1), (7, 1), (7, 2), (7, 4), (3, 4)])
def test_scores_of_joined_blocks_scatter_as_their_sums_do(blocks: int, together: int) -> None:
    """About zero, with the factor of a jackknife; a single block has none."""
    scores = RNG.standard_normal((blocks, N))
    sums = [scores[i : i + together].sum(axis=0) for i in range(0, blocks, together)]
    factor = len(sums) / (len(sums) - 1) if len(sums) > 1 else 1.0
    assert _scatter(scores, together) == pytest.approx(factor * np.sum(np.square(sums)))


def test_what_an_explanation_leaves_is_tested_in_the_other_directions() -> None:
    """Six directions of unit information, and a change along the first of them."""
    gradient = np.array([20.0, 0.5, 1.4, 0.3, 1.2, 0.1])
    nothing = np.zeros((6, 6))
    difference = Difference(np.eye(6), gradient, nothing, nothing, freedom=11)
    possible = [Hypothesis(MOTOR, np.eye(6)[:, [i]], ("k",), ("1",), (i + 1,)) for i in range(2)]
    found = found_in(difference, possible)
    assert [e.hypothesis.joints for e in found.explanations] == [(1,)]
    assert found.left == pytest.approx(stats.f.sf(np.sum(gradient[1:] ** 2) / 5.0, 5, 11))


@pytest.mark.parametrize(
    ("explanations", "explained", "left", "complete"),
    [
        (1, 0.9, 1e-9, True),
        (1, 0.3, 0.5, True),
        (1, 0.3, 1e-9, False),
        (0, 0.0, 0.0, False),
    ],
)
def test_explanations_are_complete_if_they_leave_little_or_nothing_but_noise(
    explanations: int, explained: float, left: float, *, complete: bool
) -> None:
    own = Explanation(Hypothesis(MOTOR, np.eye(6)[:, :1], ("k",), ("1",)), (1.0,), (0.1,))
    assert Change(1e-9, 3, (own,) * explanations, explained, left).complete is complete


def test_the_columns_follow_each_other() -> None:
    columns = Columns(8, 2)
    places = [columns.delay, *columns.motors, *columns.offsets, *columns.zeros, *columns.tilts]
    assert [*places, columns.bend] == list(range(8, columns.count))
    assert Columns.among(columns.count, 2) == columns
    assert columns.usual == columns.zeros[0]


@pytest.mark.parametrize(
    ("delay", "bend", "error", "there"),
    [
        (-0.01, 1e-4, 0.001, True),  # 1 / (1 + 0.01 s) to second order
        (-0.01, 0.5e-4, 0.001, False),  # a delay
        (-0.01, 2e-4, 0.001, False),  # noise of accelerations
        (-0.01, 1e-4, 0.005, False),  # no delay that noise would not be
    ],
)
def test_a_low_pass_has_a_second_derivative_that_belongs_to_its_delay(
    delay: float, bend: float, error: float, *, there: bool
) -> None:
    hypothesis = next(h for h in hypotheses(load("scara2")) if h.kind == LOW_PASS)
    assert _of_search(Explanation(hypothesis, (delay, bend), (error, 1e-6))) is there


@pytest.mark.parametrize("name", ["scara2", "emps"])
def test_another_offset_is_a_constant_torque_of_its_joint_alone(name: str) -> None:
    """Whether the robot has a parameter for it, as emps has, or not."""
    robot = load(name)
    joints = len(robot.joints)
    W = robot.regressor(*RNG.standard_normal((3, joints, 20)))
    others = np.zeros((20, joints, 1 + joints))  # the delay and the motor constants
    offsets = np.broadcast_to(np.eye(joints), (20, joints, joints))
    further = np.zeros((20, joints, joints + 3))  # zeros, tilts, and the second derivative
    columns = np.concatenate((W, others, offsets, further), axis=2)
    found = [h for h in hypotheses(robot) if h.kind == OFFSET]
    torques = np.concatenate([columns @ h.directions for h in found], axis=2)
    assert np.array_equal(torques, offsets)
    assert all(np.count_nonzero(h.directions) == 1 for h in found)


def test_a_column_that_the_nuisances_span_leaves_nothing() -> None:
    """As that of a motor constant beside a gain that was fitted: rounding is no information."""
    columns = RNG.standard_normal((50, 3))
    nuisances = columns[:, :2] @ RNG.standard_normal((2, 2))
    left = _without(nuisances, columns)
    assert np.all(left[:, :2] == 0.0)
    assert np.linalg.norm(left[:, 2]) > 1.0


@pytest.mark.parametrize(
    ("factors", "expected"),
    [
        ((1.0, 0.77, 0.765, 0.61), {0: 1.3, 3: 0.795}),
        ((1.0, 1.3, 0.99), None),
        ((1.0, 0.8), None),
        ((1.0, 0.8, 0.6), None),
    ],
)
def test_gains_are_relative_to_the_joints_that_agree(
    factors: tuple[float, ...], expected: dict[int, float] | None
) -> None:
    found = apart([Gain(j, x, 0.01 * (j > 0)) for j, x in enumerate(factors)], 0)
    if expected is None:
        assert found is None
    else:
        assert found is not None
        assert {x.joint: x.factor for x in found} == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(
    ("amounts", "expected"),
    [
        ((np.nan, -0.05, -0.052, -0.048), {0: 1.05}),
        ((np.nan, -0.05, 0.001, -0.001), {1: 0.95}),
        ((np.nan, 0.001, 0.001, -0.001), {}),
    ],
)
def test_gains_that_are_not_fitted_are_those_of_the_joints_that_are_apart(
    amounts: tuple[float, ...], expected: dict[int, float]
) -> None:
    none = np.zeros(3)
    noise = np.array([np.nan, 0.004, 0.003, 0.007])
    effect = Effect(
        RelativeGain.NAME, none, none, none, amounts=np.array(amounts), noise=noise, blocks=50
    )
    diagnostics = cast("Diagnostics", SimpleNamespace(effects=(effect,), reference=0))
    found = significant(diagnostics)
    assert {x.joint: x.factor for x in found} == pytest.approx(expected, rel=5e-3)
    assert all(0.0 < x.error < 0.01 for x in found)


def test_intervals_allow_for_the_gain_of_the_joint_that_others_are_relative_to() -> None:
    """Its own friction, which no other row has, is as much too large as its torque."""
    none, estimates = np.zeros(2), np.array([2.1, 10.5])  # friction of the joint; of an inertia
    noise = np.array([np.nan, 0.003, 0.003, 0.003])
    apart_, right = np.array([np.nan, -1.0, -1.0, -1.0]) / 21.0, np.array([np.nan, 0.05, 0.0, 0.0])
    moved = np.array([0.0, -0.2])
    effect = Effect(RelativeGain.NAME, moved, none, none, amounts=apart_, noise=noise, blocks=50)
    expected = (estimates + moved) / 1.05 - estimates
    np.testing.assert_allclose(relative(effect, 0, estimates).moved, expected)
    other = replace(effect, amounts=right)
    np.testing.assert_allclose(relative(other, 0, estimates).moved, moved, atol=1e-15)


def test_joints_whose_gains_are_known_less_well_decide_between_two() -> None:
    """Joint 1 is 5 % larger than joint 3, or this one smaller: the others are nearer to joint 3."""
    gains = [(1.0, 0.0), (0.943, 0.02), (0.954, 0.002), (0.949, 0.016), (0.95, 0.036)]
    found = apart([Gain(j, x, error) for j, (x, error) in enumerate(gains)], 0)
    assert found is not None
    assert {x.joint: x.factor for x in found} == pytest.approx({0: 1.0 / 0.954}, rel=1e-3)
    gains[1], gains[3] = (0.99, 0.02), (1.01, 0.016)
    assert apart([Gain(j, x, error) for j, (x, error) in enumerate(gains)], 0) is None
