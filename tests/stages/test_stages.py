"""What each stage does with a table, beyond the mathematics of its algorithm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from stages.tables import PERIOD, SCARA, Kept, collected, cut, motion, table

from scarid_cli.algorithms.differentiators.central import Differentiator as Central
from scarid_cli.algorithms.differentiators.p2smd import Differentiator as P2smd
from scarid_cli.algorithms.differentiators.zero_phase import Differentiator as ZeroPhase
from scarid_cli.algorithms.estimators.ls import Estimator as LeastSquares
from scarid_cli.algorithms.filters.butterworth import Butterworth
from scarid_cli.algorithms.processes.method import Method
from scarid_cli.errors import BadData
from scarid_cli.io.facts import ORDER
from scarid_cli.io.table import Table, doubles, number
from scarid_cli.stages.differentiate import PASSED, differentiate, matched
from scarid_cli.stages.filter import filtered
from scarid_cli.stages.identify import identify
from scarid_cli.stages.resample import resample
from scarid_cli.stages.results.parameters import Identified
from scarid_cli.stages.validate import validate


def consistent(rows: int = 2000) -> dict[str, np.ndarray]:
    """A motion whose torques are exactly those of the robot's a priori parameters."""
    columns = motion(rows)
    q, dq, ddq = (np.array([columns[f"{s}{i}"] for i in (1, 2)]) for s in ("q", "dq", "ddq"))
    tau = np.einsum("kjp,p->jk", SCARA.regressor(q, dq, ddq), SCARA.apriori)
    return {**columns, "tau1": tau[0], "tau2": tau[1]}


def test_columns_a_stage_does_not_know_pass_untouched_and_in_order() -> None:
    t = np.arange(30) * PERIOD
    schema = pa.schema([number("t"), pa.field("note", pa.string()), number("q1"), number("volt")])
    notes = pa.array([None if k % 3 else f"n{k}" for k in range(30)])
    batch = pa.RecordBatch.from_arrays(
        [doubles(t), notes, doubles(np.sin(t)), doubles(t * 7)], schema=schema
    )
    source = table({"t": t})
    source = Table("test", schema, source.meta, cut(batch, [4]))
    result = collected(differentiate(filtered(source, {"q1": Butterworth(20.0)}), [Central()]))
    assert result.column_names == ["t", "note", "q1", "volt", "dq1", "ddq1"]
    assert result.column("note").combine_chunks().equals(notes)
    assert result.column("volt").combine_chunks().equals(batch.column("volt"))


def test_a_method_that_looks_ahead_keeps_each_row_with_its_time() -> None:
    columns = {"t": np.arange(50) * PERIOD, "q1": np.random.default_rng(0).standard_normal(50)}
    result = collected(differentiate(table(columns, [3]), [Central()]))
    velocity = np.gradient(columns["q1"], PERIOD)
    np.testing.assert_array_equal(result.column("t"), columns["t"])
    np.testing.assert_array_equal(result.column("q1"), columns["q1"])
    np.testing.assert_allclose(result.column("dq1"), velocity, rtol=1e-13)


def test_a_motion_states_the_order_of_the_only_low_pass_that_it_has_passed() -> None:
    def order(*methods: Method, of: Table | None = None) -> int | None:
        found = matched(of or table(motion()), list(methods))
        return found.meta.extra.get(ORDER)

    slow, fast = ZeroPhase(cutoff=5.0), ZeroPhase(cutoff=20.0, order=3)
    assert order(slow, slow) == 4
    assert order(fast, fast) == 3
    assert order(slow, replace(slow, cutoff=20.0)) is None
    assert order(slow, fast) is None
    once = matched(table(motion()), [slow, slow])
    assert differentiate(once, [Central()] * 2).meta.extra.keys().isdisjoint(PASSED)
    for again in (filtered(once, {"q1": Butterworth(20.0)}), resample(once, 100.0)):
        assert ORDER not in again.meta.extra
        assert again.meta.extra["bandwidth"] == once.meta.extra["bandwidth"]


def test_differentiating_again_replaces_the_derivatives() -> None:
    once = collected(differentiate(table(motion()), [Central()] * 2))
    columns = {name: once.column(name).to_numpy() for name in once.column_names}
    twice = collected(differentiate(table(columns), [Central()] * 2))
    assert twice.equals(once)


def test_units_follow_from_those_of_the_position() -> None:
    schema = pa.schema([number("t", "s"), number("q1", "m")])
    batch = pa.RecordBatch.from_arrays(
        [doubles(np.arange(4.0)), doubles(np.ones(4))], schema=schema
    )
    source = Table("test", schema, table({"t": np.arange(4.0)}).meta, iter([batch]))
    result = differentiate(source, [Central()])
    assert (result.unit("dq1"), result.unit("ddq1")) == ("m/s", "m/s2")


def test_a_method_that_diverges_is_an_error_with_its_row() -> None:
    columns = motion(20000)
    fast = P2smd(gamma0=1e4, gamma1=1e4)
    with pytest.raises(BadData, match=r"row \d+, column dq1.*diverged.*lower its gains"):
        collected(differentiate(table(columns), [fast, fast]))


def test_exact_torques_give_the_parameters_back() -> None:
    result = collected(identify(table(consistent()), SCARA, LeastSquares(), np.zeros(8)))
    assert result.column("parameter").to_pylist() == SCARA.names
    np.testing.assert_allclose(result.column("estimate"), SCARA.apriori, atol=1e-10)


def test_parameters_a_motion_does_not_determine_are_named() -> None:
    columns = consistent()
    for name in ("dq2", "ddq2"):
        columns[name] = np.zeros_like(columns[name])
    columns["q2"] = np.zeros_like(columns["q2"])
    with pytest.raises(BadData, match=r"not identifiable.*(Fv2|Fs2)"):
        identify(table(columns), SCARA, LeastSquares(), np.zeros(8))


def test_the_true_parameters_predict_exact_torques() -> None:
    kept = Kept()
    result = validate(table(consistent()), Identified(SCARA, SCARA.apriori, 0.0), predictions=kept)
    metrics = collected(result).to_pydict()
    assert metrics["samples"] == [2000, 2000]
    np.testing.assert_allclose(metrics["r2"], 1.0, atol=1e-12)
    np.testing.assert_allclose(metrics["rmse"], 0.0, atol=1e-12)
    np.testing.assert_allclose(kept.table.column("tau1"), kept.table.column("tau1_pred"))
