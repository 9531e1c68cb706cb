"""The verdict on an estimation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scarid_cli.algorithms.beyond.model import tilted
from scarid_cli.algorithms.beyond.positions import OwnDelays
from scarid_cli.algorithms.beyond.rows import Parallel
from scarid_cli.algorithms.beyond.torques import Stribeck
from scarid_cli.algorithms.effects.effects import Effect
from scarid_cli.algorithms.inference.consequences import Consequences
from scarid_cli.algorithms.inference.diagnostics import Diagnostics
from scarid_cli.algorithms.inference.verdict import Evidence, combination, verdict
from scarid_cli.algorithms.regression.information import weakest
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.uncertainty.bursts import Interval
from scarid_cli.algorithms.uncertainty.cuts import Cut
from scarid_cli.algorithms.uncertainty.residuals import JointResidual
from scarid_cli.arrays import Array

P = 3
SCARA = load("scara2")
GOOD = JointResidual(1000, 0.999, 0.1, 0.1, 2.0, 0.0, 5.0)
KNOWN = Consequences(
    np.ones(2),
    np.array([0.001, 0.002]),
    np.full(2, 0.001),
    np.array([3.5, 0.06]),
    np.array([0.003, 0.004]),
    np.full(8, 0.5),
)
LOUD, VERY_LOUD = (replace(GOOD, relative_error=x, torque=0.5) for x in (5.0, 20.0))
PUSHED = "the torques at 2 to 2.3 s cannot be explained"
BLOCKS = 40


def effect(name: str, *, moved: float = 0.0, largest: float = 0.0) -> Effect:
    """One that moves the second parameter by so many standard errors of 0.01."""
    row = 0.01 * moved * np.eye(8)[1]
    return Effect(name, row, np.full(8, 0.001), row, np.full(8, largest), np.ones(8), BLOCKS)


def cut(error: float = 0.01, **changes: float) -> tuple[tuple[float, Cut], ...]:
    """A cut after 7 s behind which some parameters, whose value is 1, have other values."""
    after = np.array([1.0 + changes.get(name, 0.0) for name in SCARA.names])
    same = Cut(9, np.ones(8), np.ones(8), np.full(8, error), BLOCKS // 2)
    return (3.5, same), (7.0, Cut(14, np.ones(8), after, np.full(8, error), BLOCKS // 2))


def evidence(**changes: object) -> Evidence:
    diagnostics = Diagnostics(
        covariance=None,
        blocks=BLOCKS,
        scatter=0.01 * np.ones(8),
        errors=0.01 * np.ones(8),
        quantiles=2.0 * np.ones(8),
        matrix=1e-4 * np.eye(8),
        joints=(GOOD, replace(GOOD, torque=0.5)),
        effects=(effect(Parallel.NAME), effect(OwnDelays.NAME)),
        gains=np.ones((2, 8)),
        consequences=KNOWN,
        totals=np.zeros((2, 10, 10)),
        counts=np.ones(2),
        inflation=1.0,
    )
    plain_evidence = Evidence(
        names=SCARA.names,
        estimates=np.ones(8),
        condition=20.0,
        scaled_condition=5.0,
        weak="Fv1 - Fs1",
        diagnostics=diagnostics,
        treatment=Treatment(),
    )
    changed = {k: v for k, v in changes.items() if k in vars(plain_evidence)}
    others = {k: v for k, v in changes.items() if k not in changed}
    return replace(plain_evidence, diagnostics=replace(diagnostics, **others), **changed)  # type: ignore[arg-type]


def consequence(**changes: Array) -> dict[str, object]:
    return {"consequences": replace(KNOWN, **changes)}


FAR = {"moved": -4.0, "largest": 9.0}
NOT_KNOWN = np.array([np.nan, np.nan])


@pytest.mark.parametrize(
    ("changes", "grade", "reason"),
    [
        (
            {},
            "good",
            "8 of 8 parameters known within 30 %; model torque within joint 1 0.2 %, joint 2 0.4 % "
            "on motions like this one; residual joint 1 0.1 %, joint 2 0.1 %; inertia within joint "
            "1 0.61 %, joint 2 0.81 %; R2 joint 1 0.9990, joint 2 0.9990; condition number 20",
        ),
        (
            {"effects": (effect(Parallel.NAME, **FAR),)},
            "doubtful",
            "the estimates depend on the soft sensor: with the same low-pass for derivatives "
            "and torques, Fv1 would change from 1 to 0.96 (4 standard errors)",
        ),
        (
            {"effects": (effect(Parallel.NAME), effect(OwnDelays.NAME, **FAR))},
            "doubtful",
            "Fv1 would change from 1 to 0.96 (4 standard errors); --align fits a delay",
        ),
        (
            {"effects": (effect(Parallel.NAME, moved=-4.0, largest=2.0),)},
            "good",
            "8 of 8 parameters",
        ),
        (
            {"effects": (effect(Parallel.NAME, moved=-2.0, largest=9.0),)},
            "good",
            "8 of 8 parameters",
        ),
        (
            {
                "effects": (effect(Parallel.NAME, moved=-4.0, largest=9.0),),
                **consequence(parts=np.full(8, 1e-3)),
            },
            "good",  # no torque changes by a ten-thousandth
            "8 of 8 parameters",
        ),
        ({"effects": ()}, "doubtful", "the estimates were not tested for bias"),
        (
            {"effects": (effect(Parallel.NAME), effect(Stribeck.NAME, **FAR))},
            "good",
            "friction of joints 1 and 2 decreases with speed (add Stribeck friction with "
            "--estimator separable); the interval of Fv1 allows for it",
        ),
        (
            consequence(inertia=np.array([0.45, 0.55])),
            "good",
            "the inertia of joint 2 is not known: do not predict the torques of faster motions",
        ),
        (
            consequence(inertia=np.array([0.6, 2.0])),
            "good",
            "the inertia of joints 1 and 2 is not known",
        ),
        (
            {"joints": (GOOD, replace(GOOD, r2=0.3, torque=0.5))},
            "doubtful",
            "the model does not explain the torque of joint 2 (R2 0.3)",
        ),
        (
            {"joints": (GOOD, replace(GOOD, r2=np.nan, torque=0.5))},
            "doubtful",
            "joint 2 has no R2, because its torque is constant or fewer than two",
        ),
        (
            {"joints": (GOOD, replace(GOOD, r2=np.nan, torque=0.5))},
            "doubtful",
            "R2 joint 1 0.9990, joint 2 undefined; condition number 20",
        ),
        (
            {"errors": np.full(8, np.nan), **consequence(noise=NOT_KNOWN)},
            "doubtful",
            "0 of 8 parameters known within 30 %",
        ),
        (consequence(noise=NOT_KNOWN), "doubtful", "uncertainty of the torque of joint 1"),
        (
            consequence(noise=np.array([0.1, 0.0])),
            "doubtful",
            "torque of joint 1 is known only within 20 %",
        ),
        (
            consequence(torque=np.array([0.1, 80.0])),
            "doubtful",
            "the torque of joint 2 is not known: its interval is wider than the torque",
        ),
        (
            consequence(torque=np.array([0.049, 0.049])),
            "good",
            "model torque within joint 1 9.9 %, joint 2 9.9 % on motions like this one",
        ),
        (
            consequence(torque=np.array([0.049, 0.1])),
            "rough",
            "the torque of joint 2 is known within 20 % only",
        ),
        (
            {"joints": (replace(GOOD, lasting=0.0), replace(GOOD, lasting=0.2))},
            "good",
            "; needed torque within joint 1 0.2 %, joint 2 8 %; ",
        ),
        (
            {"joints": (GOOD, replace(GOOD, lasting=0.3))},
            "rough",
            "the torque that joint 2 needs on other motions is known within 12 % only, because",
        ),
        (
            {"joints": (replace(GOOD, lasting=0.0),) * 2, "offsets": {1: 0.75}},
            "good",
            "; needed torque within joint 1 0.2 %, joint 2 15 %; ",
        ),
        (
            consequence(torque=np.array([0.1, 0.2])),
            "doubtful",
            "torque of joint 2 is known only within 40 %",
        ),
        (
            {"joints": (GOOD, LOUD), **consequence(held_out=np.array([1.0, 2.4]))},
            "doubtful",
            "predicted with an error of 12 % of the torque of joint 2, those of the fit with 5 %",
        ),
        (
            {"joints": (GOOD, LOUD), **consequence(held_out=np.array([9.0, 1.4]))},
            "good",  # 0.9 % and 4.9 % more
            "8 of 8 parameters",
        ),
        (
            {"joints": (GOOD, VERY_LOUD), **consequence(held_out=np.array([1.0, 1.4]))},
            "good",  # 20 % more, which is little for this joint
            "8 of 8 parameters",
        ),
        (
            consequence(held_out=np.array([1.0, np.inf])),
            "doubtful",
            "some part of the motion occurs only once",
        ),
        (
            {"joints": (GOOD, LOUD), **consequence(held_out=np.array([1.0, 21.0]))},
            "doubtful",  # 105 % of the torque
            "some part of the motion occurs only once",
        ),
        ({"unexplained": PUSHED, "bursts": (Interval(2.0, 2.1),)}, "good", "8 of 8 parameters"),
        ({"unexplained": PUSHED, "bursts": (Interval(2.0, 2.3),)}, "good", PUSHED),
        ({"unexplained": PUSHED, "blocks": 3.2}, "doubtful", PUSHED),
        (
            consequence(diagonal=np.array([3.5, -0.06])),
            "doubtful",
            "the inertia of joint 2 is negative (-0.06), which is impossible",
        ),
        (
            {
                "estimates": np.array([1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -1.0, -1.0]),
                **consequence(diagonal=np.array([3.5, -0.06])),
            },
            "doubtful",
            "friction and inertia of joint 2 are negative: the torque's sign seems reversed",
        ),
        (
            {"cuts": cut(ZZ1R=0.3)},
            "doubtful",
            "the log is not of one robot: ZZ1R is 1 up to about 7 s after its start, and 1.3 from "
            "then on (30 standard errors): did the payload change?",
        ),
        ({"cuts": cut(ZZ1R=0.05)}, "good", "8 of 8 parameters"),  # 5 standard errors
        ({"cuts": cut(ZZ1R=0.019, error=1e-4)}, "good", "8 of 8 parameters"),  # 1 %
        ({"cuts": cut(Fs1=0.3)}, "good", "8 of 8 parameters"),  # friction warms up
        ({"errors": np.full(8, 0.5)}, "good", "0 of 8 parameters known within 30 %"),
        ({"blocks": 3.2}, "doubtful", "only 3.2 independent parts of the log count, too few"),
        ({"estimates": -np.ones(8)}, "doubtful", "the torques' sign seems reversed"),
        (
            {"estimates": np.array([1.0, -1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0])},
            "doubtful",
            "the friction parameter Fv1 is negative",
        ),
        ({"scaled_condition": 1e6}, "not identifiable", "hardly determines Fv1 - Fs1"),
        (
            {"joints": (GOOD, replace(GOOD, torque=0.01))},
            "not identifiable",
            "joint 2 has hardly any torque (0.01 N m rms",
        ),
    ],
    ids=str,
)
def test_the_verdict_says_what_is_wrong(
    changes: dict[str, object], grade: str, reason: str
) -> None:
    judged = verdict(evidence(**changes), SCARA)
    assert judged.grade == grade
    assert any(reason in found for found in judged.reasons), judged.reasons


@pytest.mark.parametrize("scaled", [5.0, 1e6])
def test_a_log_that_fails_a_check_is_not_to_be_relied_on(scaled: float) -> None:
    found = verdict(evidence(failed=("positions: in degrees",), scaled_condition=scaled), SCARA)
    assert found.grade == ("doubtful" if scaled < 1e4 else "not identifiable")
    assert "positions: in degrees" in found.reasons
    assert found.biased
    assert not verdict(evidence(), SCARA).biased


def test_a_delay_is_not_advised_twice() -> None:
    effects = (effect(Parallel.NAME), effect(OwnDelays.NAME, **FAR))
    judged = verdict(evidence(treatment=Treatment(align=True), effects=effects), SCARA)
    assert "--align" not in judged.reasons[0]


def test_essential_parameters_are_not_advised_twice() -> None:
    poor = consequence(noise=np.array([0.5, 0.5]))
    hint = "try --essential, which leaves out the parameters that are not known"
    assert hint in verdict(evidence(**poor), SCARA).reasons
    assert hint not in verdict(evidence(treatment=Treatment(essential=True), **poor), SCARA).reasons


def test_a_parameter_of_zero_is_named_but_no_reason_for_doubt() -> None:
    estimates = np.ones(8)
    estimates[5] = 1e-3
    judged = verdict(evidence(estimates=estimates), SCARA)
    assert judged.grade == "good"
    assert judged.reasons[-1].startswith("7 of 8 parameters known within 30 % (all but L1MY2); ")


def test_the_weakest_direction_is_that_of_the_smallest_singular_value() -> None:
    """Whatever the units: W with columns of unit length."""
    rng = np.random.default_rng(0)
    W = rng.standard_normal((100, P)) * [1.0, 1e3, 1e-3]
    W[:, 2] = 1e-3 * (W[:, 0] - 1e-3 * W[:, 1] + 1e-3 * rng.standard_normal(100))
    unit = W / np.linalg.norm(W, axis=0)
    singular = np.linalg.svd(unit)[1]
    inverse = np.linalg.inv(np.linalg.qr(W)[1])
    condition, direction = weakest(inverse @ inverse.T)
    assert condition == pytest.approx(singular[0] / singular[-1], rel=1e-6)
    moved = np.linalg.norm(W @ direction) / np.linalg.norm(W * direction)
    assert moved < 2e-3


def test_a_direction_is_written_out() -> None:
    assert combination(np.array([2.0, -1.0, 0.01]), ["a", "b", "c"]) == "a - 0.5 b"
    assert combination(np.array([0.0, -3.0, 0.0]), ["a", "b", "c"]) == "b"


def test_a_direction_that_is_singular_to_rounding_is_found_as_well() -> None:
    """The inverse of such a covariance has negative diagonals, or does not exist."""
    rng = np.random.default_rng(0)
    for apart in np.geomspace(1e-10, 1e-6, 50):
        W = rng.standard_normal((60, 4))
        W[:, 3] = W[:, 0] + W[:, 1] + apart * rng.standard_normal(60)
        inverse = np.linalg.inv(np.linalg.qr(W)[1])
        condition, direction = weakest(inverse @ inverse.T)
        assert condition > 1e5
        expected = np.array([1.0, 1.0, 0.0, -1.0]) / np.sqrt(3.0)
        np.testing.assert_allclose(np.abs(direction @ expected), 1.0, rtol=1e-6)


def test_a_motion_that_is_matched_is_not_to_be_matched() -> None:
    advice = "--match"
    doubtful = evidence(effects=(effect(Parallel.NAME, moved=-4.0, largest=9.0),))
    assert advice in verdict(doubtful, SCARA).reasons[0]
    assert advice not in verdict(replace(doubtful, matched=True), SCARA).reasons[0]


@pytest.mark.parametrize(
    ("sines", "sine"),
    [([0.1, 0.0], 0.1), ([0.0, -0.1], 0.1), ([np.nan, 0.1], 0.1), ([np.nan, np.nan], 0.0)],
)
def test_gravity_of_a_tilted_base_is_as_large_as_before(sines: list[float], sine: float) -> None:
    down = np.array([0.0, 0.0, -9.81])
    gravity = tilted(down, np.array(sines))
    np.testing.assert_allclose(np.linalg.norm(gravity), 9.81)
    np.testing.assert_allclose(np.linalg.norm(gravity[:2]) / 9.81, sine, atol=1e-12)
