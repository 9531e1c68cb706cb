"""Identification of simulated experiments: delays, long records, essential parameters, verdicts."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from conftest import seeds
from crossvalidation import log, seen
from defaults import PERIOD

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.uncertainty import subsample
from scarid_cli.algorithms.uncertainty.checkpoint import Checkpoint
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData
from scarid_cli.io.facts import ORDER
from scarid_cli.io.table import Metadata, Table, doubles
from scarid_cli.stages.identify import identify
from scarid_cli.stages.results.parameters import identified
from scarid_cli.stages.validate import validate

SCARA = load("scara2")
COLUMNS = [f"{signal}{i}" for signal in ("q", "dq", "ddq", "tau") for i in (1, 2)]


@cache
def signals(name: str, seed: int, *, match: bool) -> Array:
    """Those of an experiment through a soft sensor (columns, rows)."""
    method = DIFFERENTIATORS.load(name)(**DIFFERENTIATORS.load(name).PRESETS.get("table1", {}))
    motion = seen(method, *log(seed), match=match)
    return np.concatenate(motion.signals)[:, motion.settled]


def motion(
    name: str = "kalman",
    seed: int = 1,
    *,
    match: bool = True,
    late: int = 0,
    rows: int | None = None,
) -> Table:
    """A motion whose torques are late by so many samples."""
    x = signals(name, seed, match=match).copy()
    x[-2:] = np.roll(x[-2:], late, axis=1)
    batch = pa.RecordBatch.from_arrays([doubles(row[late:rows]) for row in x], COLUMNS)
    batch = batch.add_column(0, "t", doubles(PERIOD * np.arange(batch.num_rows)))
    meta = Metadata(kind="motion", period=PERIOD)
    return Table("motion", batch.schema, meta, iter([batch]))


def found(
    source: Table, estimator: str = "rls", settings: dict[str, Any] | None = None, **options: Any
) -> Table:
    """The parameters, all of them at once."""
    solver = ESTIMATORS.load(estimator)(**(settings or {}))
    result = identify(source, SCARA, solver, SCARA.apriori, treatment=Treatment(**options))
    return replace(result, batches=list(result.batches))  # type: ignore[arg-type]


def column(result: Table, name: str) -> Array:
    values: Array = next(iter(result.batches)).column(name).to_numpy(zero_copy_only=False)
    return values


WITHOUT_SCORES = [("rls", {"forgetting": 0.999}), ("tls", {}), ("ekf", {})]


@pytest.mark.parametrize(("estimator", "settings"), WITHOUT_SCORES, ids=lambda x: str(x))
def test_an_unmatched_soft_sensor_is_called_biased_by_every_estimator(
    estimator: str, settings: dict[str, float]
) -> None:
    extra = found(motion("p2smd", match=False), estimator, settings).meta.extra
    assert extra["verdict"] == "doubtful"
    assert blamed(extra)


def with_forgetting(late: int) -> list[Table]:
    """The parameters of experiments with forgetting, the torques late by so many samples."""
    settings = {"forgetting": 0.999}
    return [found(motion(seed=n + 1, late=late), "rls", settings) for n in seeds(4, 10)]


def blamed(extra: dict[str, Any]) -> bool:
    """Whether the signals are a reason for doubt."""
    words = ("the estimates depend on the soft sensor", "torque and motion are not those")
    return any(reason.startswith(words) for reason in extra["reasons"])


def test_torques_10_ms_late_do_not_mislead_with_forgetting() -> None:
    """Most are called so, and all intervals allow for it; on time the signals are never blamed."""
    late, on_time = with_forgetting(late=2), with_forgetting(late=0)
    assert sum(blamed(result.meta.extra) for result in late) > len(late) // 2
    for result in late:
        off = np.abs(column(result, "estimate") - SCARA.apriori)
        assert np.all(off < 3.0 * column(result, "robust_error"))
    assert not any(blamed(result.meta.extra) for result in on_time)
    assert any(result.meta.extra["verdict"] == "good" for result in on_time)


@pytest.mark.parametrize(
    ("estimator", "settings"),
    [("tls", {}), ("rls", {"forgetting": 0.999}), ("rls", {"forgetting": (0.99, *[0.999] * 7)})],
    ids=["tls", "forgetting", "forgetting of one"],
)
def test_the_delay_is_fitted_with_every_estimator_that_can(
    estimator: str, settings: dict[str, Any]
) -> None:
    """Torques 5 ms late, and half a millisecond early by the controller's hold."""
    result = found(motion(late=1), estimator, settings, align=True, slow=(0.1, 0.1))
    assert len(column(result, "estimate")) == 8
    assert result.meta.extra["delay"] == pytest.approx(-4.5e-3, abs=1e-3)


def test_torques_without_noise_are_fitted_by_maximum_likelihood() -> None:
    x = signals("kalman", 1, match=True)
    exact = SCARA.torques(SCARA.regressor(*(np.ascontiguousarray(s) for s in np.split(x[:6], 3))),
                          SCARA.apriori)  # fmt: skip
    batch = pa.RecordBatch.from_arrays([doubles(row) for row in (*x[:6], *exact)], COLUMNS)
    meta = Metadata(kind="motion", period=PERIOD)
    result = found(Table("motion", batch.schema, meta, iter([batch])), "ml")
    np.testing.assert_allclose(column(result, "estimate"), SCARA.apriori, atol=1e-6)


def test_parameters_that_no_motion_tells_apart_are_named_and_nothing_else() -> None:
    """Each friction twice: with a delay and with what a low-pass makes of both."""
    again = [replace(p, name=f"{p.name} again") for p in SCARA.parameters if p.term.JUMPS]
    robot = replace(SCARA, parameters=(*SCARA.parameters, *again))
    with pytest.raises(BadData, match=r"the motion leaves (Fs\d( again)?( [-+] )?)+ undetermined"):
        identify(
            behind(motion(), 10.0, 4),
            robot,
            ESTIMATORS.load("wls")(),
            robot.apriori,
            treatment=Treatment(align=True),
        )


def test_barely_excited_rows_with_a_delay_get_a_verdict() -> None:
    """A quarter of a second, of which few rows are fast; the triangle is singular to rounding."""
    for rows in range(30, 80, 5):
        with suppress(BadData):  # a refusal, but never a failure of the algebra
            result = found(motion(rows=rows), "wls", slow=(0.1, 0.1), align=True)
            assert result.meta.extra["scaled_condition_number"] > 0.0


def behind(source: Table, bandwidth: float, order: int) -> Table:
    """The motion as if it had passed a two-sided low-pass of this bandwidth [Hz]."""
    return replace(source, meta=replace(source.meta, extra={"bandwidth": bandwidth, ORDER: order}))


@pytest.mark.parametrize("order", [0, 4])
def test_validation_applies_the_delay_that_was_fitted(order: int) -> None:
    """On the rows it was identified from, R2 is the one that identify reports.

    But for the two last samples, which have no torque of two samples later. What is fitted beside
    the parameters of the robot, the ringing of friction, predicts nothing.
    """
    parameters = found(behind(motion(late=2), 10.0, order), "wls", align=True)
    expected = [joint["r2"] for joint in parameters.meta.extra["joints"]]
    model = identified(parameters, SCARA)
    assert model.delay == parameters.meta.extra["delay"] < -5e-3
    late = column(validate(motion(late=2), model), "r2")
    np.testing.assert_allclose(late, expected, atol=1e-4)
    at_once = column(validate(motion(late=2), replace(model, delay=0.0)), "r2")
    assert np.all(at_once < late - 1e-3)


def test_a_long_record_in_parts_has_the_statistics_of_one_in_one() -> None:
    """The samples that are kept do not depend on where an estimation was saved and continued."""
    (batch,) = motion().batches
    long = pa.Table.from_batches([batch] * 12).combine_chunks().to_batches()[0]
    long = long.set_column(0, "t", doubles(PERIOD * np.arange(long.num_rows)))
    kept: list[Checkpoint] = []

    def go_on(part: pa.RecordBatch, before: Checkpoint | None) -> Checkpoint:
        table = Table("motion", long.schema, motion().meta, iter([part]))
        solver = ESTIMATORS.load("ls")()
        identify(table, SCARA, solver, SCARA.apriori, checkpoint=before, keep=kept.append)
        return kept[-1]

    whole, parts = go_on(long, None), None
    for start in range(0, long.num_rows, 5000):
        parts = go_on(long.slice(start, 5000), parts)
    assert parts
    assert not whole.subsample.complete
    np.testing.assert_array_equal(parts.subsample.rows().at, whole.subsample.rows().at)
    np.testing.assert_array_equal(parts.subsample.rows().W, whole.subsample.rows().W)


def test_rows_of_a_long_record_are_thinned_before_the_delay_is_fitted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """They hold the same: estimates differ by less than a tenth of their errors."""
    t = np.arange(16_001) / 1000.0
    q = np.array([0.8 * np.sin(2.1 * t) + 0.2 * np.cos(5.3 * t), 0.7 * np.sin(3.4 * t)])
    dq, ddq = np.gradient(q, t, axis=1), np.gradient(np.gradient(q, t, axis=1), t, axis=1)
    exact = SCARA.torques(SCARA.regressor(q, dq, ddq), SCARA.apriori)
    slow_noise = np.cumsum(np.random.default_rng(0).standard_normal(exact.shape), axis=1)
    x = np.concatenate((q, dq, ddq, exact + 1e-3 * slow_noise))
    batch = pa.RecordBatch.from_arrays([doubles(row) for row in (t, *x)], ["t", *COLUMNS])
    table = Table("motion", batch.schema, Metadata(kind="motion", period=1e-3), iter(()))

    def estimated() -> Table:
        return found(replace(table, batches=iter([batch])), "wls", align=True, slow=(0.1, 0.1))

    whole = estimated()
    monkeypatch.setattr(subsample, "MOST_HELD", 100_000)
    thinned = estimated()
    assert "thinned" not in whole.meta.extra
    assert thinned.meta.extra["thinned"] == 5
    assert whole.meta.extra["samples"] == thinned.meta.extra["samples"]
    apart = column(whole, "estimate") - column(thinned, "estimate")
    assert np.all(np.abs(apart) < 0.1 * column(whole, "robust_error"))


def test_rows_at_the_end_are_skipped_whether_settled_or_not() -> None:
    """The last ten of the table, of which a soft sensor left five unsettled."""
    batch = next(motion(rows=1000).batches)
    marks = np.ones(1000, dtype=np.int64)
    marks[-5:] = 0
    marked = batch.append_column("settled", pa.array(marks))
    result = found(Table("motion", marked.schema, motion().meta, iter([marked])), skip=(0, 10))
    assert result.meta.extra["samples"] == 990


def test_r2_of_a_long_record_is_that_of_all_rows() -> None:
    """The statistics keep a part of the rows; validate takes all of them."""
    (batch,) = motion().batches
    times = 8
    long = pa.Table.from_batches([batch] * times).combine_chunks().to_batches()[0]
    noise = np.random.default_rng(0).standard_normal((2, long.num_rows))
    noise[:, long.num_rows // 2 :] *= 3.0  # the subsample leaves out other parts than the noise
    for i in (1, 2):
        at = long.schema.get_field_index(f"tau{i}")
        tau = long.column(at).to_numpy() + 0.2 * noise[i - 1]
        long = long.set_column(at, f"tau{i}", doubles(tau))
    long = long.set_column(0, "t", doubles(PERIOD * np.arange(long.num_rows)))

    def source() -> Table:
        return Table("motion", long.schema, motion().meta, iter([long]))

    parameters = found(source(), "ls")
    assert parameters.meta.extra["samples"] == long.num_rows > 16_384
    expected = column(validate(source(), identified(parameters, SCARA)), "r2")
    r2 = [joint["r2"] for joint in parameters.meta.extra["joints"]]
    np.testing.assert_allclose(r2, expected, rtol=1e-9)


def test_essential_parameters_are_judged_by_their_own_figures() -> None:
    full = found(motion(), "wls", slow=(0.1, 0.1), align=True)
    reduced = found(motion(), "wls", slow=(0.1, 0.1), align=True, essential=True)
    extra = reduced.meta.extra
    assert extra["dropped"] == ["L1MY2"]
    assert 0.0 < extra["dropped_cost"] <= extra["dropped_allowed"]
    assert extra["condition_number"] < full.meta.extra["condition_number"]
    assert "of 7 parameters known" in " ".join(extra["reasons"])
    model = identified(reduced, SCARA)
    assert model.theta[SCARA.names.index("L1MY2")] == 0.0
    expected = column(validate(motion(), model, treatment=Treatment(slow=(0.1, 0.1))), "r2")
    np.testing.assert_allclose([joint["r2"] for joint in extra["joints"]], expected, atol=1e-6)


@pytest.mark.parametrize(("estimator", "holds"), [("rls", False), ("ls", False), ("irls", True)])
def test_estimators_that_hold_their_rows_are_judged_by_all_of_them(
    *, estimator: str, holds: bool
) -> None:
    """Others by a subsample of bounded size, and by sums over blocks."""
    kept: list[Checkpoint] = []
    solver = ESTIMATORS.load(estimator)()
    identify(motion(), SCARA, solver, SCARA.apriori, keep=kept.append)
    assert (kept[-1].blocks is None) == holds
    assert (kept[-1].subsample.covers > 0) == holds
