"""The commands as functions: `import scarid`."""

from __future__ import annotations

import html
import json
import pickle
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from conftest import ROOT, Result
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pyarrow import parquet

import scarid
from scarid import stubs

Run = Callable[..., Result]

# What may follow a measurement of scara2: the function, its options, the same on a command line.
STEPS: dict[str, list[tuple[dict[str, Any], str]]] = {
    "filter": [
        ({"cutoff": 30.0}, "--cutoff 30"),
        ({"cutoff": 12.5, "zero_phase": True}, "--cutoff 12.5 --zero-phase"),
        ({"cutoff": 20.0, "columns": ["q1", "q2"]}, "--cutoff 20 --columns q1,q2"),
    ],
    "differentiate": [
        ({}, ""),
        ({"method": "p2smd"}, "--method p2smd"),
        ({"method": "kalman", "set": {"noise": 1e-4}}, "--method kalman --set noise=0.0001"),
        ({"method": "rts", "match": True}, "--method rts --match"),
    ],
    "identify": [
        ({}, ""),
        ({"estimator": "wls", "all_rows": True}, "--estimator wls --all-rows"),
        ({"forgetting": [0.9999, "Fv1=0.999"]}, "--forgetting 0.9999,Fv1=0.999"),
        ({"skip": [50, 10], "drop_slow": 0.1}, "--skip 50,10 --drop-slow 0.1"),
    ],
}


@pytest.fixture(scope="module")
def log() -> scarid.Log:
    return scarid.simulate(scarid.trajgen(seed=2), seed=2)


def same(found: scarid.Log, written: pa.Table) -> None:
    """All columns and facts; the history names another command line."""
    table = found.to_arrow()
    assert table.schema.names == written.schema.names
    for name in table.schema.names:
        assert table.column(name).combine_chunks() == written.column(name).combine_chunks(), name
    facts = [json.loads(x.schema.metadata[b"scarid"]) for x in (table, written)]
    for fact in facts:
        del fact["history"]
    assert facts[0] == facts[1]


@st.composite
def lines(draw: st.DrawFn) -> list[tuple[str, dict[str, Any], str]]:
    """Some of the steps in their order, each with some of its options."""
    names = [name for name in ("filter", "differentiate") if draw(st.booleans())]
    names = [*names, *(["identify"] if "differentiate" in names and draw(st.booleans()) else [])]
    return [(name, *draw(st.sampled_from(STEPS[name]))) for name in names or ["filter"]]


@settings(max_examples=12, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(lines())
def test_functions_then_and_pipe_give_the_same_bits(
    tmp_path: Path, log: scarid.Log, scarid_line: Run, steps: list[tuple[str, dict[str, Any], str]]
) -> None:
    """The facts of a pipe are those of Arrow."""
    log.save(tmp_path / "log.parquet")
    found: scarid.Log = log
    for name, options, _ in steps:
        found = getattr(scarid, name)(found, **options)
    words = [f"{name} {text}" for name, _, text in steps]
    first, *rest = words
    then = " then ".join([f"{first} {tmp_path}/log.parquet", *rest])
    assert scarid_line(f"{then} -q -o {tmp_path}/then.parquet").status == 0
    same(found, parquet.read_table(tmp_path / "then.parquet"))


@pytest.fixture
def scarid_line() -> Run:
    """Run one command line in this process."""
    from scarid_cli.__main__ import main

    return lambda line: Result(main(line.split()), "", "")


def test_a_pipe_of_processes_gives_the_same_bits(
    tmp_path: Path, log: scarid.Log, shell: Run
) -> None:
    log.save(tmp_path / "log.parquet")
    done = shell(
        f"scarid filter --cutoff 30 {tmp_path}/log.parquet --format arrow | scarid differentiate"
        f" --format arrow | scarid identify -q -o {tmp_path}/pipe.parquet"
    )
    assert done.status == 0, done.err
    found = scarid.identify(scarid.differentiate(scarid.filter(log, cutoff=30)))
    same(found, parquet.read_table(tmp_path / "pipe.parquet"))


def test_a_result_has_its_verdict_its_estimates_and_what_was_said(log: scarid.Log) -> None:
    found = scarid.identify(log)
    assert found.verdict == "good"
    assert found["ZZ1R"] == found.estimates["ZZ1R"] == pytest.approx(3.42, abs=0.05)
    assert any("cut-off" in line for line in found.messages)
    assert "good: " in repr(found)
    assert "<svg" in found._repr_html_()
    assert scarid.validate(log, parameters=found).verdict == "unchanged"
    compared = scarid.compare(found, found)
    assert compared.verdict == "same"


@pytest.mark.parametrize(
    "kind", ["arrow", "batch", "columns", "path", "pandas", "polars", "reader"]
)
def test_tables_may_be_what_people_have(tmp_path: Path, log: scarid.Log, kind: str) -> None:
    table = log.to_arrow().replace_schema_metadata(None)
    given_: Any = table
    if kind == "batch":
        (given_,) = table.combine_chunks().to_batches()
    elif kind == "columns":
        given_ = {name: log[name] for name in log.columns}
    elif kind == "path":
        log.save(given_ := tmp_path / "log.csv")
    elif kind in ("pandas", "polars"):
        pytest.importorskip(kind)
        given_ = log.to_pandas() if kind == "pandas" else log.to_polars()
    elif kind == "reader":
        given_ = pa.RecordBatchReader.from_batches(table.schema, table.to_batches())
    found = scarid.filter(given_, cutoff=20)
    np.testing.assert_array_equal(found["q1"], scarid.filter(table, cutoff=20)["q1"])
    if kind != "reader":  # which is read once
        assert isinstance(scarid.check(given_).data["checks"], list)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda x: scarid.identify(x, robot="nope"), scarid.UsageFault, "unknown robot 'nope'"),
        (lambda x: scarid.identify(x, estimator="no"), scarid.UsageFault, "'no' is not one of"),
        (lambda x: scarid.identify(x, colour=1), scarid.UsageFault, "no option 'colour'; there"),
        (lambda _: scarid.identify("no.csv"), scarid.UsageFault, "no.csv: no such file"),
        (lambda _: scarid.identify(3), scarid.UsageFault, "int is no table; give a path"),
        (lambda _: scarid.identify(), scarid.UsageFault, "give a table or the path of one"),
        (lambda x: scarid.trajgen(x), scarid.UsageFault, "trajgen takes no table"),
        (lambda _: scarid.identify({"t": [0.0, 1.0]}), scarid.BadData, "expected q1"),
        (lambda x: scarid.identify(x, rows="1:20"), scarid.BadData, "too few rows"),
    ],
)
def test_errors_are_those_of_the_commands(
    log: scarid.Log, call: Callable[[Any], Any], error: type[Exception], words: str
) -> None:
    with pytest.raises(error, match=words):
        call(log)


def test_what_is_not_as_required_is_in_the_error(log: scarid.Log) -> None:
    found = scarid.identify(log)
    other = {name: log[name] * (1.2 if name == "tau1" else 1.0) for name in log.columns}
    with pytest.raises(scarid.RequirementError, match="not unchanged as --require asks") as raised:
        scarid.validate(other, parameters=found, require="unchanged")
    assert raised.value.result.verdict == "changed"


def test_the_stub_is_that_of_the_commands() -> None:
    """Otherwise: python -m scarid.stubs > scarid/__init__.pyi"""
    assert (ROOT / "scarid" / "__init__.pyi").read_text() == stubs.text()


def test_every_function_has_its_help_and_its_options() -> None:
    for name in scarid.__all__:
        assert hasattr(scarid, name), name
    assert "estimator" in scarid.identify.__doc__
    assert "Options:" in scarid.trajgen.__doc__


def test_the_notebook_runs() -> None:
    """Its cells, one after the other, in one namespace."""
    notebook = json.loads((ROOT / "docs" / "notebook.ipynb").read_text())
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    names: dict[str, Any] = {}
    for cell in cells:
        exec(compile(cell, "notebook.ipynb", "exec"), names)
    assert names["found"].verdict == "good"
    assert names["checked"]["status"] == "ok"
    assert names["change"].verdict == "changed"
    assert any("joint 1" in reason for reason in names["change"].reasons)


def test_threads_have_results_and_texts_of_their_own(log: scarid.Log) -> None:
    """Nothing of them is printed, and what others print is left alone."""
    alone = scarid.check(log)
    before = sys.stdout
    with ThreadPoolExecutor(3) as pool:
        texts = list(pool.map(lambda _: scarid.check(log), range(6)))
        found = list(pool.map(lambda _: scarid.identify(log).to_arrow(), range(3)))
    assert texts == [alone] * 6
    assert sys.stdout is before
    assert found[0].equals(found[1])
    assert found[0].equals(found[2])


def test_an_error_goes_from_process_to_process(log: scarid.Log) -> None:
    error = pickle.loads(pickle.dumps(scarid.RequirementError("not good", 3, log)))
    assert (str(error), error.status) == ("not good", 3)
    assert error.result.to_arrow().equals(log.to_arrow())


def test_check_tells_of_a_bad_log_and_raises_if_strict(log: scarid.Log) -> None:
    bad = {**{name: log[name] for name in log.columns}, "tau1": -log["tau1"]}
    found = scarid.check(bad, robot="scara2")
    assert found.status == found.data["status"] == "failed"
    assert [x for x in found.data["checks"] if x["status"] != "ok"] == found.findings
    wrong = found.findings[0]
    assert f"failed   {wrong['name']}" in repr(found)
    assert repr(found).endswith(" failed")
    assert html.escape(wrong["figure"]) in found._repr_html_()
    with pytest.raises(scarid.RequirementError, match="joint 1"):
        scarid.check(bad, robot="scara2", strict=True)


def test_what_is_masked_is_missing(log: scarid.Log) -> None:
    columns = {name: log[name] for name in log.columns}
    columns["tau1"] = np.ma.masked_greater(columns["tau1"], np.quantile(columns["tau1"], 0.9))
    with pytest.raises(scarid.BadData, match="tau1: found no value"):
        scarid.identify(columns, robot="scara2")


@pytest.mark.parametrize("axis", [0, 1])
def test_columns_of_two_dimensions_are_numbered(log: scarid.Log, axis: int) -> None:
    """Joints by rows, or rows by joints; a single number is no column."""
    own = {x: np.stack([log[f"{x}1"], log[f"{x}2"]], axis) for x in ("q", "tau")}
    found = scarid.filter({"t": log["t"], **own, "dt": 0.005}, cutoff=20)
    plain = {name: log[name] for name in ("t", "q1", "q2", "tau1", "tau2")}
    np.testing.assert_array_equal(found["q2"], scarid.filter(plain, cutoff=20)["q2"])


@pytest.mark.parametrize("kind", ["named", "dates", "durations", "column", "nanoseconds"])
def test_a_frame_has_its_time_in_the_index_or_as_durations(log: scarid.Log, kind: str) -> None:
    pandas = pytest.importorskip("pandas")
    frame = log.to_pandas()[["t", "q1", "q2", "tau1", "tau2"]]
    t = frame["t"]
    if kind == "named":
        frame = frame.set_index("t")
    elif kind in ("dates", "durations"):
        make = pandas.to_datetime if kind == "dates" else pandas.to_timedelta
        frame = frame.drop(columns="t").set_axis(make(t.to_numpy(), unit="s"))
    elif kind == "column":
        frame["t"] = pandas.to_timedelta(t, unit="s")
    else:
        frame["t"] = (1e9 * t).round().astype("int64") + 1_700_000_000_000_000_000
    np.testing.assert_allclose(scarid.read(frame)["t"], log["t"], atol=1e-6)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda x: scarid.identify(x, all_rows="no"), "all_rows is 'no'; give True or False"),
        (lambda x: scarid.identify(x, trace=True), "trace is True; give a value"),
        (lambda _: scarid.identify({"t": [1, 2], "q1": [1]}), "dict: cannot become a table"),
        (lambda _: scarid.identify({"t": [1, 2], "q1": [[1], [1, 2]]}), "cannot become a table"),
        (lambda _: scarid.identify({"t": [1], "q": np.ones((1, 2, 3))}), "q has 3 dimensions"),
    ],
)
def test_values_that_cannot_be_are_told(
    log: scarid.Log, call: Callable[[Any], Any], words: str
) -> None:
    with pytest.raises(scarid.UsageFault, match=words):
        call(log)


def test_options_take_several_tables_settings_and_numbers(log: scarid.Log) -> None:
    found, other = scarid.identify(log), scarid.identify(log, estimator="wls")
    assert scarid.validate(log, parameters=[found, other]).verdict == "unchanged"
    assert len(scarid.trajgen(segment=(1, 2))) > 2
    noisy = {"torque-noise": [0.1, 0.2], "friction-drift": 0.1}
    assert len(scarid.simulate(scarid.trajgen(duration=3), with_=noisy)) > 100


def test_no_result_has_the_path_of_a_table_in_memory(log: scarid.Log) -> None:
    found = scarid.identify(log)
    robot = ROOT / "samples" / "robots" / "ur10e.toml"
    assert "scarid-" not in scarid.compare(found, found)["table"][0]
    with pytest.raises(scarid.ScaridError) as raised:
        scarid.export(robot, parameters=found, to="c")
    assert "scarid-" not in str(raised.value)


def test_parameters_have_torques_and_a_covariance() -> None:
    """Those of a single axis are a line of its parameters."""
    log = scarid.simulate(scarid.trajgen(robot="emps", seed=1, duration=10), seed=1)
    found = scarid.identify(log)
    m, fv, fs, offset = (found.estimates[x] for x in ("M", "Fv", "Fc", "offset"))
    motion = np.array([[0.1], [0.0]]), np.array([[0.2], [-0.3]]), np.array([[1.5], [2.0]])
    expected = m * motion[2] + fv * motion[1] + fs * np.sign(motion[1]) + offset
    np.testing.assert_allclose(found.torques(*motion), expected, rtol=1e-12)
    np.testing.assert_array_equal(found.torques(*(x[1] for x in motion)), expected[1])
    assert found.covariance.shape == (4, 4)
    assert np.all(np.linalg.eigvalsh(found.covariance) > 0.0)
    with pytest.raises(scarid.UsageFault, match=r"give \(samples, 1\)"):
        found.torques([1.0, 2.0], [0.0, 0.0], [0.0, 0.0])
