"""What the torques are beyond the model: found where it alone explains them, and then fitted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from conftest import seeds
from unit.pendulum import ARM, MODEL, H, motion
from unit.regressions import estimated

from scarid_cli.algorithms.beyond.additions import Addition, mean_additions
from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.torques import (
    DECAYED,
    Asymmetry,
    Cable,
    Cube,
    Curvature,
    Drift,
    LoadFriction,
    Offset,
    Ripple,
    RippleSine,
    Saturation,
    SlowFriction,
    Spring,
    Stribeck,
)
from scarid_cli.algorithms.effects.additions import Shapes, of_explanation
from scarid_cli.algorithms.effects.explanations import Explanation
from scarid_cli.algorithms.effects.offsets import with_offsets
from scarid_cli.algorithms.estimators import wls
from scarid_cli.algorithms.inference.diagnostics import Diagnosis, Diagnostics
from scarid_cli.algorithms.inference.outcome import Problem
from scarid_cli.algorithms.inference.sentences import additions_of
from scarid_cli.algorithms.regression.rows import Rows, rows_of
from scarid_cli.arrays import Array

NOISE = 0.02  # N m
Beyond = Callable[[Array], Array]


def nothing(at: Array) -> Array:
    return np.zeros_like(at[0])


def of_the_load(at: Array) -> Array:
    """Friction of 3 % of the torque that the gears transmit: all but friction."""
    own = MODEL.transmits
    load = ARM.regressor(*at)[:, :, own] @ ARM.apriori[own]
    return np.asarray(0.03 * np.sign(at[1]) * np.abs(load.T))


def of_the_first_load(at: Array) -> Array:
    return of_the_load(at) * np.array([[1.0], [0.0]])


def pulled(at: Array) -> Array:
    """A cable at the second joint that is slack at 0, so that the offset remains what it is."""
    return np.array([[0.0], [0.1]]) * at[0]


def bent(at: Array) -> Array:
    """A cable at the second joint that pulls the more, the farther it is bent."""
    return np.array([[0.0], [0.1]]) * at[0] ** 3


def of_the_speed(at: Array) -> Array:
    """Stribeck friction of the first joint, at speeds between two of those that are tried."""
    return np.array([[0.2], [0.0]]) * np.sign(at[1]) * np.exp(-((at[1] / 0.4) ** 2))


def rippled(at: Array) -> Array:
    """Ripple of the first joint, whose torque is 0.1 N m at 0."""
    return np.array([[0.12], [0.0]]) * np.sin(2.0 * np.pi * 3.1 * at[0] + 1.0)


def of_two_kinds(at: Array) -> Array:
    return of_the_load(at) + pulled(at) + of_the_speed(at)


def log(beyond: Beyond, seed: int = 0) -> Rows:
    """Rows of a log whose torques have something beyond the model, and white noise."""
    true = motion()
    torque = ARM.torques(ARM.regressor(*true), ARM.apriori) + beyond(true)
    noise = NOISE * np.random.default_rng(seed).standard_normal(torque.shape)
    return rows_of(ARM, np.stack((*true, torque + noise)), np.arange(true.shape[2]), H)


def diagnosed(rows: Rows) -> Diagnostics:
    return Diagnosis(
        rows, estimated(wls.Estimator(), rows), len(ARM.names), model=MODEL
    ).diagnostics


@pytest.mark.parametrize(
    ("beyond", "expected"),
    [
        (of_the_load, {(LoadFriction.NAME, 0), (LoadFriction.NAME, 1)}),
        (of_the_first_load, {(LoadFriction.NAME, 0)}),
        (pulled, {(Spring.NAME, 1)}),
        (bent, {(Cable.NAME, 1)}),
        (rippled, {(Ripple.NAME, 0)}),
        (
            lambda at: of_the_load(at) + rippled(at),
            {(LoadFriction.NAME, 0), (LoadFriction.NAME, 1), (Ripple.NAME, 0)},
        ),
    ],
)
def test_what_explains_the_torques_alone_is_found(
    beyond: Beyond, expected: set[tuple[str, int]]
) -> None:
    assert diagnosed(log(beyond)).explanations[0].torques == expected


def test_friction_may_be_any_curve_of_the_speed() -> None:
    torques = diagnosed(log(of_the_speed)).explanations[0].torques
    assert {joint for _, joint in torques} == {0}
    assert {name for name, _ in torques} <= DECAYED.keys()
    assert len(torques) > 1


def test_of_several_causes_none_explains_the_torques_alone() -> None:
    found = diagnosed(log(of_two_kinds))
    assert any(effect.significant() for effect in found.effects)
    assert found.explanations == ()


def test_noise_is_seldom_explained() -> None:
    """Of 100 logs 1 is expected; more than 4 come by chance once in 250 times."""
    found = [diagnosed(log(nothing, seed)) for seed in seeds(25, 100)]
    most = len(found) // 25
    assert sum(bool(one.explanations) for one in found) <= most
    ripples = [effect for one in found for effect in one.effects if effect.name == Ripple.NAME]
    assert len(ripples) >= len(found) - most  # one that does not show away from reversals is none
    assert sum(effect.significant() for effect in ripples) <= most  # of hundreds that are tried


def explained(rows: Rows, without: Diagnostics) -> tuple[Array, Diagnostics]:
    """The estimates with the explanation, and their diagnostics."""
    additions = of_explanation(without.explanations[0], rows, {0, 1})
    plain = estimated(wls.Estimator(), rows).fit.estimates
    wide = Shapes(additions, MODEL, plain).beside(rows)
    found = estimated(wls.Estimator(), wide)
    curves = {x.joint for x in additions if x.name in DECAYED}
    own = len(ARM.names)
    return found.fit.estimates[:own], Diagnosis(
        wide, found, own, model=MODEL, curves=curves
    ).diagnostics


@pytest.mark.parametrize("beyond", [of_the_load, pulled, of_the_speed])
def test_with_the_explanation_the_estimates_are_right(beyond: Beyond) -> None:
    """Without it, some are off by more than three errors from noise."""
    rows = log(beyond)
    without = diagnosed(rows)
    plain = estimated(wls.Estimator(), rows).fit.estimates
    assert np.any(np.abs(plain - ARM.apriori) > 3.0 * without.scatter)
    estimates, stated = explained(rows, without)
    assert np.all(np.abs(estimates - ARM.apriori) < 3.5 * stated.errors)


def test_with_its_ripple_a_joint_is_known_as_well_as_without_any() -> None:
    """Its friction and inertia, of which the ripple made the errors over ten times as large."""
    smooth, rows = log(nothing), log(rippled)
    without = diagnosed(rows)
    estimates, stated = explained(rows, without)
    assert np.all(np.abs(estimates - ARM.apriori) < 3.5 * stated.errors)
    first = [ARM.names.index(name) for name in ("ZZ1R", "MX1R", "Fv1", "Fc1")]
    usual = diagnosed(smooth).scatter[first]
    assert np.all(without.scatter[first] > 10.0 * usual)
    assert np.all(stated.scatter[first] < 1.3 * usual)


def test_other_joints_may_have_what_one_has_as_far_as_the_log_can_tell() -> None:
    """The joint without a spring: its static moment is known as well as with a spring fitted."""
    rows, own, moment = log(pulled), len(ARM.names), ARM.names.index("MX1R")

    def fitted(
        joints: Sequence[int], shared: frozenset[str] = frozenset()
    ) -> tuple[float, Diagnostics]:
        springs = [Addition(Spring.NAME, joint, 1.0) for joint in joints]
        wide = Shapes(springs, MODEL, ARM.apriori).beside(rows)
        found = estimated(wls.Estimator(), wide)
        return found.fit.estimates[moment], Diagnosis(
            wide, found, own, model=MODEL, shared=shared
        ).diagnostics

    def bias(found: Diagnostics) -> float:
        (spring,) = [effect for effect in found.effects if effect.name == Spring.NAME]
        return float(abs(spring.bias[moment]))

    both, known = fitted([0, 1])
    one, found = fitted([1], frozenset({Spring.NAME}))
    assert bias(found) == pytest.approx(np.hypot(both - one, known.scatter[moment]), rel=0.05)
    assert bias(fitted([1])[1]) == 0.0
    found = replace(found, additions=(Addition(Spring.NAME, 1, 1.0, 0.1),))
    (note,) = additions_of(ARM.names, found, ARM)
    assert note.endswith("the intervals of ZZ1R and MX1R allow for the same at joint 1")


def test_other_joints_may_have_an_offset_where_one_has() -> None:
    kept = [k for k, name in enumerate(ARM.names) if not name.startswith("offset")]
    arm = replace(ARM, parameters=tuple(ARM.parameters[k] for k in kept))
    rows, own = replace(log(nothing), W=log(nothing).W[:, :, kept]), len(kept)
    found = estimated(wls.Estimator(), rows)
    plain = Problem(rows, found, own, None, Model(arm, list(range(own))))
    wide = with_offsets(rows, (1,))
    fitted = replace(plain, rows=wide, found=estimated(wls.Estimator(), wide), offsets=(1,))
    for problem, shared in ((plain, []), (fitted, [Offset.NAME])):
        effects = problem.diagnosis(0.0).effects
        assert [effect.name for effect in effects if effect.shared] == shared
    (offset,) = [effect for effect in fitted.diagnosis(0.0).effects if effect.name == Offset.NAME]
    known = np.hypot(offset.moved, offset.errors)
    np.testing.assert_allclose(np.abs(offset.bias), known)


def test_the_diagnostics_of_an_outcome_know_what_was_fitted_for_other_joints() -> None:
    additions = (Addition(Spring.NAME, 1, 1.0, 0.1),)
    rows = Shapes(additions, MODEL, ARM.apriori).beside(log(pulled))
    found = estimated(wls.Estimator(), rows)
    problem = Problem(rows, found, len(ARM.names), None, MODEL, additions=additions)
    effects = problem.diagnostics(0.0).effects
    assert [effect.name for effect in effects if effect.shared] == [Spring.NAME]


def test_a_spring_is_slack_somewhere_unless_the_joint_has_an_offset() -> None:
    explanation = Explanation(
        frozenset({(Spring.NAME, 0), (Spring.NAME, 1)}),
        clearness=2.0,
        threshold=4.0,
        cycles=np.zeros((0, 2)),
    )
    found = [(x.name, x.joint) for x in of_explanation(explanation, log(pulled), {0})]
    assert found == [(Offset.NAME, 1), (Spring.NAME, 0), (Spring.NAME, 1)]


def test_a_bent_cable_is_told_once_for_each_joint() -> None:
    _, found = explained(rows := log(bent), diagnosed(rows))
    parts = (
        Addition(Cube.NAME, 1, 1.0, 0.1),
        Addition(Spring.NAME, 1, 1.0, -0.02),
        Addition(Spring.NAME, 0, 1.0),
    )
    cable, spring = additions_of(
        dict.fromkeys(ARM.names, 1.0), replace(found, additions=parts), ARM
    )
    assert cable.startswith("something pulls on joint 2 more than in proportion to the position")
    assert "; fitted as well: -0.02 N m/rad and 0.1 N m/rad3 at joint 2" in cable
    assert spring.startswith("something pulls on joint 1 as a spring")


def test_the_torques_are_those_of_the_robot_and_not_of_the_log() -> None:
    rows = log(nothing)
    additions = [
        Addition(name, 1, 0.5, 2.0)
        for name in (
            Offset.NAME,
            Asymmetry.NAME,
            Spring.NAME,
            Cube.NAME,
            SlowFriction.NAME,
            Stribeck.NAME,
            Curvature.NAME,
            Saturation.NAME,
            Drift.NAME,
            LoadFriction.NAME,
        )
    ]
    q, v = rows.motion[0, 1], rows.motion[1, 1]
    model = (rows.W @ ARM.apriori)[:, 1]
    own = MODEL.transmits
    carried = (rows.W[:, :, own] @ ARM.apriori[own])[:, 1]
    friction = sum(np.exp(-((v / (0.5 * part)) ** 2)) for part in (0.1, 0.3, 1.0))
    expected = 1.0 + np.abs(v) + q + q**3 + np.sign(v) * (friction + np.abs(carried))
    expected += model * np.abs(model)
    torques = Shapes(additions, MODEL, ARM.apriori).torques(rows)
    assert torques[:, 1] == pytest.approx(2.0 * expected)
    assert np.all(torques[:, 0] == 0.0)


def test_pooled_additions_are_the_mean_of_those_of_all_logs() -> None:
    first = [Addition(LoadFriction.NAME, 0, 1.0, 0.02), Addition(Stribeck.NAME, 1, 1.0, 0.3)]
    other = [Addition(LoadFriction.NAME, 0, 3.0, 0.04)]
    assert mean_additions([first, other]) == (
        Addition(LoadFriction.NAME, 0, 2.0, 0.03),
        Addition(Stribeck.NAME, 1, 1.0, 0.15),
    )
    assert mean_additions([first]) == tuple(first)


def test_pooled_ripples_keep_their_periods() -> None:
    """The mean of the torques of two ripples is not one of a ripple between them."""
    sets = [[Addition(RippleSine.NAME, 0, 1.0, 0.1, cycles)] for cycles in (9.9, 10.1)]
    rows = log(nothing)
    pooled, *own = (
        Shapes(found, MODEL, ARM.apriori).torques(rows) for found in (mean_additions(sets), *sets)
    )
    assert pooled == pytest.approx(np.mean(own, axis=0), abs=1e-12)


def test_gears_take_a_part_of_the_load_away() -> None:
    sizes = (-0.01, 0.02, 0.9, 1.5)
    assert [Addition(LoadFriction.NAME, 0, 1.0, size).possible for size in sizes] == [
        False,
        True,
        True,
        False,
    ]
    assert all(Addition(Spring.NAME, 0, 1.0, size).possible for size in sizes)
