"""The verdict on an estimation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scarid_cli.algorithms.regression.information import weakest
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.statistics.diagnostics import Diagnostics
from scarid_cli.algorithms.statistics.residuals import JointResidual
from scarid_cli.algorithms.statistics.verdict import Evidence, combination, verdict

P = 3
SCARA = load("scara2")
GOOD = JointResidual(1000, 0.999, 0.1, 0.1, 2.0, 0.0, 5.0)


def evidence(**changes: object) -> Evidence:
    diagnostics = Diagnostics(
        covariance=None,
        blocks=20,
        errors=0.01 * np.ones(8),
        joints=(GOOD, replace(GOOD, torque=0.5)),
        lag_share=0.1,
        moved=np.zeros(8),
        slow=np.full(2, 0.1),
    )
    plain_evidence = Evidence(
        names=SCARA.names,
        estimates=np.ones(8),
        condition=20.0,
        scaled_condition=5.0,
        weak="Fv1 - Fs1",
        diagnostics=diagnostics,
        treatment=Treatment(),
        weighted=False,
    )
    changed = {k: v for k, v in changes.items() if k in vars(plain_evidence)}
    others = {k: v for k, v in changes.items() if k not in changed}
    return replace(plain_evidence, diagnostics=replace(diagnostics, **others), **changed)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "grade", "reason"),
    [
        ({}, "good", "8 of 8 parameters known within 30 %, R2 0.9990, 0.9990, condition number 20"),
        ({"lag_share": 0.8}, "doubtful", "biased: the motion 25 ms before and after explains 80 %"),
        ({"moved": np.eye(8)[1] * -4.0}, "doubtful", "Fv1 would move by up to 4.0 deviations"),
        (
            {"joints": (GOOD, replace(GOOD, r2=0.3, torque=0.5))},
            "doubtful",
            "explains the torque of joint 2 badly",
        ),
        ({"lag_share": np.nan}, "doubtful", "not tested for bias"),
        ({"moved": np.full(8, np.nan)}, "doubtful", "not tested whether the estimates depend on"),
        ({"moved": np.full(8, 1e99)}, "doubtful", "would move by up to 1.0e+99 deviations"),
        (
            {"joints": (GOOD, replace(GOOD, r2=np.nan, torque=0.5))},
            "doubtful",
            "joint 2 has no R2, because its torque is constant or fewer than two",
        ),
        (
            {"joints": (GOOD, replace(GOOD, r2=np.nan, torque=0.5))},
            "doubtful",
            "8 of 8 parameters known within 30 %, R2 0.9990, undefined, condition number 20",
        ),
        ({"errors": np.full(8, np.nan)}, "doubtful", "0 of 8 parameters known within 30 %"),
        ({"estimates": -np.ones(8)}, "doubtful", "Fv1 is negative"),
        ({"errors": np.full(8, 0.5)}, "doubtful", "0 of 8 parameters known within 30 %"),
        ({"scaled_condition": 1e6}, "not identifiable", "hardly determines Fv1 - Fs1"),
        (
            {"joints": (GOOD, replace(GOOD, torque=0.01))},
            "not identifiable",
            "joint 2 has hardly any torque (0.01 N m rms",
        ),
    ],
    ids=lambda x: next(iter(x), "nothing") if isinstance(x, dict) else None,
)
def test_the_verdict_says_what_is_wrong(
    changes: dict[str, object], grade: str, reason: str
) -> None:
    judged = verdict(evidence(**changes), SCARA)
    assert judged.grade == grade
    assert any(reason in found for found in judged.reasons), judged.reasons


@pytest.mark.parametrize(
    ("used", "advice"),
    [
        ({}, "(--drop-slow 0.1,0.1 --align)"),
        ({"treatment": Treatment(slow=(0.1, 0.1))}, "(--align)"),
        ({"treatment": Treatment(slow=(0.1, 0.05), align=True)}, "(--drop-slow 0.1,0.1)"),
        ({"treatment": Treatment(slow=(0.2, 0.1), align=True)}, "(--estimator wls)"),
        ({"treatment": Treatment(slow=(0.2, 0.1), align=True), "weighted": True}, None),
    ],
    ids=["nothing", "slow rows", "slower rows", "both", "both and weights"],
)
def test_the_advice_is_what_was_not_tried(used: dict[str, object], advice: str | None) -> None:
    """Velocities are advised with one digit: 0.1 for 0.14, and 0.1 given is then as advised."""
    moved = {"moved": np.eye(8)[1] * 4.0, "slow": np.array([0.14, 0.1])}
    reason = verdict(evidence(**used, **moved), SCARA).reasons[0]
    assert "Fv1 would move by up to 4.0 deviations" in reason
    assert reason.endswith(advice) if advice else "--" not in reason


def test_essential_parameters_are_not_advised_twice() -> None:
    poor = {"errors": np.array([0.01] * 3 + [0.5] * 5)}
    hint = "--essential leaves out what is not known"
    assert hint in verdict(evidence(**poor), SCARA).reasons
    assert hint not in verdict(evidence(treatment=Treatment(essential=True), **poor), SCARA).reasons


def test_a_parameter_of_zero_is_named_but_no_reason_for_doubt() -> None:
    estimates = np.ones(8)
    estimates[5] = 1e-3
    judged = verdict(evidence(estimates=estimates), SCARA)
    assert judged.grade == "good"
    assert judged.reasons[-1] == "not L1MY2"


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
