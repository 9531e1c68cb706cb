"""The verdict of `validate`: what has changed is called by its name, and nothing else is."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from crossvalidation import COMMON, log
from stages.tables import SCARA
from unit.support import adjusted

from scarid_cli.algorithms.changes.columns import Columns
from scarid_cli.algorithms.changes.evidence import Products
from scarid_cli.algorithms.changes.likelihood import Difference, along
from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS
from scarid_cli.algorithms.regression.estimation import BaseEstimator
from scarid_cli.algorithms.regression.rows import rows_of
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.io.table import Metadata, Table, doubles
from scarid_cli.stages.differentiate import matched
from scarid_cli.stages.identify import identify
from scarid_cli.stages.results.changes import known
from scarid_cli.stages.results.estimates import errors_of
from scarid_cli.stages.results.parameters import EVIDENCE, identified
from scarid_cli.stages.validate import validate

PERIOD = 0.005
KALMAN = DIFFERENTIATORS.load("kalman")()
SLOW = Treatment(slow=(0.1, 0.1))
COLUMNS = Columns(8, 2)
Edit = Callable[[Array, Array], tuple[Array, Array]]


def motion(q: Array, tau: Array, method: Any = KALMAN) -> pa.RecordBatch:
    """The motion that a soft sensor estimates from a log (joints, rows)."""
    arrays = [doubles(x) for x in (PERIOD * np.arange(q.shape[1]), *q, *tau)]
    batch = pa.RecordBatch.from_arrays(arrays, ["t", "q1", "q2", "tau1", "tau2"])
    measured = Table("log", batch.schema, Metadata(period=PERIOD), iter([batch]))
    made = matched(measured, [method] * 2)
    return pa.Table.from_batches(list(made.batches)).combine_chunks().to_batches()[0]


def table(batch: pa.RecordBatch) -> Table:
    return Table("motion", batch.schema, Metadata(kind="motion", period=PERIOD), iter([batch]))


LOGS = {seed: log(seed) for seed in (11, 12, 13)}


def parameters(treatment: Treatment = SLOW, estimator: BaseEstimator | None = None) -> Table:
    """Parameters identified from the first log, kept so that they can be read again and again."""
    estimator = estimator or ESTIMATORS.load("wls")()
    return identify(table(motion(*LOGS[11])), SCARA, estimator, np.zeros(8), treatment=treatment)


def change(before: Table, q: Array, tau: Array, treatment: Treatment = SLOW) -> dict[str, Any]:
    """What `validate` says about a log, with the metadata as a file would give them back."""
    batches = list(before.batches)
    before = replace(before, meta=Metadata.from_json(before.meta.to_json()))
    model = identified(replace(before, batches=iter(batches)), SCARA)
    last = known(before, model.robot, errors_of(pa.Table.from_batches(batches)))
    result = validate(table(motion(q, tau)), model, treatment=treatment, before=last)
    found: dict[str, Any] = json.loads(json.dumps(result.meta.extra["change"]))
    return found


def kinds(found: dict[str, Any]) -> list[tuple[str, list[int]]]:
    return [(e["kind"], e["joints"]) for e in found["explanations"]]


@pytest.mark.parametrize("estimator", ["wls", "rls", "ls", "irls"])
@pytest.mark.parametrize("seed", [11, 12, 13])
def test_the_same_robot_is_unchanged(seed: int, estimator: str) -> None:
    """On the log of the identification itself as on others, whatever the estimator."""
    found = change(parameters(estimator=ESTIMATORS.load(estimator)()), *LOGS[seed])
    assert found["verdict"] == "unchanged"
    if seed == 11:
        assert found["p_value"] > 0.5


@pytest.mark.parametrize("treatment", [replace(SLOW, align=True), replace(SLOW, essential=True)])
def test_a_fitted_delay_and_dropped_parameters_change_nothing(treatment: Treatment) -> None:
    assert change(parameters(treatment), *LOGS[12])["verdict"] == "unchanged"


def scaled(joint: int, gain: float) -> Edit:
    gains = np.ones((2, 1))
    gains[joint - 1] = gain
    return lambda q, tau: (q, gains * tau)


@pytest.mark.parametrize("joint", [1, 2])
def test_a_motor_constant_that_is_off(joint: int) -> None:
    found = change(parameters(), *scaled(joint, 1.05)(*LOGS[12]))
    assert found["verdict"] == "changed"
    assert kinds(found) == [("motor constant", [joint])]
    (amount,), (error,) = (found["explanations"][0][key].values() for key in ("amounts", "errors"))
    assert amount == pytest.approx(0.05, abs=4.0 * error)


def test_all_torques_are_measured_too_large() -> None:
    """As by another factor between currents and torques; it is no payload with more friction."""
    q, tau = LOGS[12]
    found = change(parameters(), q, 1.05 * tau)
    assert (found["verdict"], kinds(found)) == ("changed", [("scale", [])])
    (amount,), (error,) = (found["explanations"][0][key].values() for key in ("amounts", "errors"))
    assert amount == pytest.approx(0.05, abs=4.0 * error)
    assert found["reason"].startswith("scale of all torques (torques +")


def test_another_zero_of_a_joint() -> None:
    """The positions of joint 2 are 0.03 rad too large."""
    q, tau = LOGS[12]
    found = change(parameters(), q + 0.03 * np.array([[0.0], [1.0]]), tau)
    assert (found["verdict"], kinds(found)) == ("changed", [("zero", [2])])
    (amount,), (error,) = (found["explanations"][0][key].values() for key in ("amounts", "errors"))
    assert amount == pytest.approx(-0.03, abs=4.0 * error)
    assert "zero of joint 2 (its positions are 0.03" in found["reason"]
    assert "rad too large)" in found["reason"]


@pytest.mark.parametrize("missing", [3, 5])
def test_a_table_of_an_earlier_version_says_less(missing: int) -> None:
    """Its evidence ends with the zeros of the joints, or with the offsets."""
    before, gain = parameters(), scaled(1, 1.05)(*LOGS[12])
    stored = before.meta.extra[EVIDENCE]
    count = len(stored["score"]) - missing
    older = {
        **stored,
        "score": stored["score"][:count],
        "information": stored["information"][: count * (count + 1) // 2],
    }
    before = replace(
        before, meta=replace(before.meta, extra={**before.meta.extra, EVIDENCE: older})
    )
    assert kinds(change(before, *gain)) == [("motor constant", [1])]


def test_the_torque_that_a_change_makes_is_relative_to_that_of_each_joint() -> None:
    rows = rows_of(SCARA, np.random.default_rng(1).standard_normal((4, 2, 50)), np.arange(50), 0.01)
    theta, changed = SCARA.apriori, np.zeros(COLUMNS.count)
    changed[3] = 0.2
    torques, moved = rows.W @ theta, rows.W[:, :, 3] * 0.2
    expected = np.sqrt((moved**2).sum(axis=0) / (torques**2).sum(axis=0))
    sums = Products.of(rows, theta)
    np.testing.assert_allclose(sums.torque_shares(np.outer(changed, changed)), expected, rtol=1e-9)
    changed = np.zeros(COLUMNS.count)
    changed[COLUMNS.motors[1]] = 0.05  # of joint 2
    squares = np.outer(changed, changed)
    np.testing.assert_allclose(sums.torque_shares(squares), [0.0, 0.05], atol=1e-12)


def test_columns_that_are_no_parameters_are_fitted_to_each_log() -> None:
    """The information about the rest is that of all columns less what these share with them."""
    rng = np.random.default_rng(4)
    rows = rows_of(SCARA, rng.standard_normal((4, 2, 400)), np.arange(400), 0.01)
    rows = replace(rows, y=rows.W @ SCARA.apriori + rng.standard_normal(rows.y.shape))
    nuisance = np.zeros((*rows.y.shape, 1))
    nuisance[:, 1, 0] = rows.W[:, 1, 4] + 0.1 * rng.standard_normal(400)
    wide = replace(rows, W=np.concatenate((rows.W, nuisance), axis=2))
    found = Products.of(wide, SCARA.apriori).values[1].sum(axis=0)[:8, :8]
    W, c = rows.W[:, 1], nuisance[:, 1, 0]
    expected = W.T @ W - np.outer(W.T @ c, c @ W) / (c @ c)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_biases_add_to_the_covariance_of_a_difference() -> None:
    rng = np.random.default_rng(5)
    root, biases = rng.standard_normal((6, 6)), rng.standard_normal((2, 6))
    information, amounts = root @ root.T, rng.standard_normal(6)
    difference = Difference(information, information @ amounts, root, information, 20)
    found = difference.allowing(biases)
    expected = np.linalg.inv(np.linalg.inv(information) + biases.T @ biases)
    np.testing.assert_allclose(found.information, expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(found.gradient, expected @ amounts, rtol=1e-9, atol=1e-9)


def test_a_change_within_the_stated_intervals_is_named_but_is_none() -> None:
    before, gain = parameters(), scaled(1, 1.05)(*LOGS[12])
    stated = before.meta.extra["joints"]
    known_worse = [{**joint, "torque_error": 0.04} for joint in stated]
    extra = {**before.meta.extra, "joints": known_worse}
    found = change(replace(before, meta=replace(before.meta, extra=extra)), *gain)
    assert found["verdict"] == "unchanged"
    assert kinds(found) == [("motor constant", [1])]
    assert "%, within the intervals of the identification (if anything, motor" in found["reason"]


def test_another_delay() -> None:
    q, tau = LOGS[12]
    found = change(parameters(), q[:, 2:], tau[:, :-2])
    assert kinds(found) == [("delay", [])]
    assert found["explanations"][0]["amounts"]["delay"] == pytest.approx(-0.01, rel=0.2)


WIRING: dict[str, Edit] = {
    "torque of joint 2 reversed": scaled(2, -1.0),
    "torque of joints 1 and 2 swapped": lambda q, tau: (q, tau[::-1]),
    "position and torque of joints 1 and 2 swapped": lambda q, tau: (q[::-1], tau[::-1]),
    "position of joint 2 reversed": lambda q, tau: (q * [[1.0], [-1.0]], tau),
}


@pytest.mark.parametrize("wrong", WIRING)
def test_reversed_and_swapped_joints(wrong: str) -> None:
    found = change(parameters(), *WIRING[wrong](*LOGS[12]))
    assert found["verdict"] == "changed"
    assert found["wiring"] == [wrong]


def other(**values: float) -> Array:
    """What other parameters add to the torques of the second log."""
    batch = motion(*LOGS[12], COMMON)
    q, dq, ddq = (
        np.array([batch.column(f"{signal}{i}").to_numpy() for i in (1, 2)])
        for signal in ("q", "dq", "ddq")
    )
    robot: Robot = adjusted("scara2", **values)
    W = SCARA.regressor(q, dq, ddq)
    return SCARA.torques(W, robot.apriori - SCARA.apriori)


def test_a_payload() -> None:
    """A tenth of a kilogram at .25 m on the second link."""
    added = other(ZZ2=0.064 + 0.00625, L1MX2=0.131 + 0.0125, ZZ1R=3.42 + 0.025)
    found = change(parameters(), LOGS[12][0], LOGS[12][1] + added)
    assert kinds(found) == [("payload", [])]
    amounts = found["explanations"][0]["amounts"]
    assert amounts["L1MX2"] == pytest.approx(0.0125, abs=0.002)


def test_friction_that_has_risen() -> None:
    added = other(Fv2=0.02, Fs2=0.208)
    found = change(parameters(), LOGS[12][0], LOGS[12][1] + added)
    assert kinds(found) == [("friction", [2])]
    assert "Fs2" in found["reason"]


def test_a_force_that_no_change_explains() -> None:
    q, tau = LOGS[12]
    rng = np.random.default_rng(1)
    found = change(parameters(), q, tau + rng.standard_normal(tau.shape) * [[3.0], [1.0]])
    assert found["verdict"] == "unexplained"
    assert "the residuals are larger than at the identification" in found["reason"]


def test_a_table_without_metadata_is_tested_with_its_errors() -> None:
    """As CSV gives it back: errors are known, residuals are not."""
    before = replace(parameters(), meta=Metadata(kind="parameters"))
    assert change(before, *LOGS[12])["verdict"] == "unchanged"
    before = replace(parameters(), meta=Metadata(kind="parameters"))
    assert kinds(change(before, *scaled(2, 1.1)(*LOGS[12]))) == [("motor constant", [2])]


def test_amounts_of_which_only_a_combination_is_known_have_no_error() -> None:
    """Two directions with the same effect, and one of its own."""
    effects = np.array([[1.0, 0.0], [0.5, 0.0], [0.0, 2.0]])
    difference = Difference(np.eye(2), np.array([0.3, 0.4]), np.eye(2), np.eye(2), 20)
    found = along(difference, effects.T)
    assert found.rank == 2
    np.testing.assert_array_equal(np.isfinite(found.errors), [False, False, True])
    assert found.amounts @ effects == pytest.approx([0.3, 0.4])
