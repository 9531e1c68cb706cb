"""Clocks as people have them: in two columns, since 1970, begun late or anew."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.io.echoed import joint_state_names
from scarid_cli.io.signals import Series
from scarid_cli.io.table import Metadata, Table
from scarid_cli.stages.conversion.adapt import adapted
from scarid_cli.stages.conversion.recorded import recorded
from scarid_cli.stages.conversion.seconds import clock_columns, with_one_clock

START = 1_695_196_914_311_943_531  # ns since 1970
PERIOD = 10_000_000  # ns


def table(**columns: Any) -> Table:
    batch = pa.record_batch(columns)
    return Table("log", batch.schema, Metadata(), iter([batch.slice(0, 7), batch.slice(7)]))


def column(found: Table, name: str) -> np.ndarray[Any, Any]:
    parts = [batch.column(name).to_numpy() for batch in found.batches]
    return np.concatenate(parts)


@given(st.integers(0, 2**31 - 100), st.integers(0, 10**9 - 1), st.integers(1, 10**8))
def test_seconds_and_nanoseconds_are_one_clock(seconds: int, rest: int, period: int) -> None:
    ticks = [seconds * 10**9 + rest + k * period for k in range(20)]
    log = table(
        **{
            "header.stamp.sec": [tick // 10**9 for tick in ticks],
            "header.stamp.nanosec": [tick % 10**9 for tick in ticks],
            "q": [0.0] * 20,
        }
    )
    columns = clock_columns(log.columns)
    assert columns == ("header.stamp.sec", "header.stamp.nanosec", 1e-9)
    found = with_one_clock(log, columns)
    assert found.columns == ["t", "q"]
    np.testing.assert_allclose(
        column(found, "t"), 1e-9 * period * np.arange(20), rtol=1e-12, atol=1e-9
    )


def test_the_stamp_of_the_header_comes_before_other_clocks() -> None:
    names = ["sec", "nanosec", "header.stamp.secs", "header.stamp.nsecs", "q1"]
    assert clock_columns(names) == ("header.stamp.secs", "header.stamp.nsecs", 1e-9)
    assert clock_columns(["time.sec", "other.nanosec"]) is None


@pytest.mark.parametrize("unit", [10**9, 10**6, 10**3])
@pytest.mark.parametrize("kind", ["text", "integer", "number"])
def test_times_since_1970_are_told_by_their_size(kind: str, unit: int) -> None:
    ticks = [(START + k * PERIOD) // (10**9 // unit) for k in range(20)]
    values = {
        "text": pa.array(map(str, ticks)),
        "integer": pa.array(ticks, pa.int64()),
        "number": pa.array(map(float, ticks), pa.float64()),
    }[kind]
    found = column(adapted(table(stamp=values), {"t": "stamp"}, [], None), "t")
    rounding = 256 / unit if kind == "number" else 1.0 / unit
    np.testing.assert_allclose(found, 0.01 * np.arange(20), atol=1.01 * rounding)


@pytest.mark.parametrize("first", [0.0, 1.7e9, 1e5])
def test_seconds_are_left_as_they_are(first: float) -> None:
    t = first + 0.01 * np.arange(20)
    assert column(adapted(table(t=t), {}, [], None), "t").tolist() == t.tolist()


def series(stamps: list[int], efforts: float = 1.0) -> Series:
    rows = len(stamps)
    columns = {"q{i}": np.arange(float(rows))[:, None], "tau{i}": np.full((rows, 1), efforts)}
    received = START + 10**9 * np.arange(rows)
    return Series("/joints", ("one",), np.array(stamps), received, columns, 0)


def test_stamps_that_begin_late_leave_out_the_messages_before() -> None:
    found, notes = recorded(
        "bag", series([0, 0, 0, *(START + PERIOD * k for k in range(20))]), None, ""
    )
    np.testing.assert_allclose(column(found, "t"), 0.01 * np.arange(20), atol=1e-9)
    assert notes == ["3 messages of /joints left out: their stamps are 0 (the clock had not begun)"]


def test_the_clock_of_the_recorder_is_used_only_where_stamps_lack() -> None:
    found, notes = recorded("bag", series([0] * 20), None, "")
    assert "/joints has no stamps" in notes[0]
    np.testing.assert_allclose(column(found, "t"), np.arange(20.0), atol=1e-9)
    _, notes = recorded("bag", series([0] * 15 + [START] * 5), None, "")
    assert "only 5 of 20 messages of /joints have stamps" in notes[0]


def test_two_runs_in_one_recording_are_not_interleaved() -> None:
    run = [START + PERIOD * k for k in range(100)]
    found, notes = recorded("bag", series([*run, *run]), None, "")
    q, t = column(found, "q1"), None
    assert q.tolist() == list(range(200))
    assert "go back 1 time: 2 runs, put one after the other" in notes[0]
    again, _ = recorded("bag", series([*run, *run]), None, "")
    t = column(again, "t")
    assert np.argmax(np.diff(t)) == 99
    assert np.diff(t).max() == pytest.approx(0.2)


def test_a_late_message_is_put_back_in_order() -> None:
    stamps = [START + PERIOD * k for k in range(100)]
    stamps[50], stamps[51] = stamps[51], stamps[50]
    found, notes = recorded("bag", series(stamps), None, "")
    assert column(found, "q1").tolist() == [*range(50), 51, 50, *range(52, 100)]
    assert "1 messages of /joints put back" in notes[0]


def test_efforts_that_are_nan_are_told() -> None:
    found, notes = recorded("bag", series([START + k for k in range(20)], np.nan), None, "")
    assert "tau1" not in found.columns
    assert "have nan for every effort: the log has positions only" in notes[0]


def test_echoed_messages_have_names_by_their_arrays() -> None:
    row = ["1695", "311", "", "a", "b", "0.1", "0.2", "1.0", "2.0", "-3", "4e-1"]
    assert joint_state_names(row) == (
        "sec", "nanosec", "frame_id", "name1", "name2", "a_position", "b_position",
        "a_velocity", "b_velocity", "a_effort", "b_effort",
    )  # fmt: skip
    assert joint_state_names(row[:7]) == (*joint_state_names(row)[:7],)
    for other in (
        row[:-1],
        row[5:],
        ["t", *row],
        [*row, "5", "6"],
        ["1695", "311", "", "a", "a", "1", "2"],
    ):
        assert joint_state_names(other) == ()
