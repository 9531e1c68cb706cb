"""Windows of logs, rows without values, and several logs as one."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stages.tables import PERIOD, SCARA, collected, motion, table

from scarid_cli.algorithms.choices.registry import ESTIMATORS
from scarid_cli.errors import BadData
from scarid_cli.io.facts import ORDER
from scarid_cli.io.reader import checked
from scarid_cli.io.selection import Lacking, Selection, within
from scarid_cli.io.table import Table, number
from scarid_cli.stages.identify import identify
from scarid_cli.stages.records.several import joined

ROWS = 60
SIZES = st.lists(st.sampled_from([1, 2, 7, 8192]), min_size=1, max_size=4)
BOUND = st.none() | st.floats(-0.1, 0.4)


def log(sizes: list[int] | None = None) -> Table:
    t = np.arange(ROWS) * PERIOD
    return table({"t": t, "q1": np.sin(t), "q2": np.cos(t)}, sizes or ())


def patched(places: dict[str, list[int]], sizes: list[int] | None = None) -> Table:
    """The log without values in these rows, counted from 0, of these columns."""
    columns = {name: np.array(x) for name, x in zip(["t", "q1", "q2"], _values(), strict=True)}
    for name, rows in places.items():
        columns[name][rows] = np.nan
    return table(columns, sizes or ())


def _values() -> list[np.ndarray]:
    return [np.array(column) for column in collected(log()).columns]


@given(SIZES, BOUND, BOUND, st.integers(1, 70), st.none() | st.integers(1, 70))
@settings(max_examples=60, deadline=None)
def test_a_window_has_the_same_rows_however_they_arrive(
    sizes: list[int], start: float | None, end: float | None, first: int, last: int | None
) -> None:
    """They are those that a comparison of whole columns gives, and know their number in the log."""
    t, number = np.arange(ROWS) * PERIOD, np.arange(1, ROWS + 1)
    inside = (number >= first) & (number <= (last or ROWS))
    inside &= (t >= (-1.0 if start is None else start)) & (t < (9.0 if end is None else end))
    found = within(log(sizes), Selection(start, end, first, last))
    if not inside.any():
        with pytest.raises(BadData, match="in the window"):
            collected(found)
        return
    expected = collected(log()).filter(pa.array(inside))
    assert collected(found).equals(expected.combine_chunks())
    assert [found.row(1), found.row(int(inside.sum()))] == [*number[inside][[0, -1]]]


@given(SIZES, st.sets(st.integers(0, ROWS - 1), max_size=20), st.sampled_from(["q1", "q2", "t"]))
@settings(max_examples=60, deadline=None)
def test_rows_without_a_value_are_left_out_and_begin_a_segment(
    sizes: list[int], rows: set[int], column: str
) -> None:
    source = patched({column: sorted(rows)}, sizes)
    lacking = Lacking(["t", "q1", "q2"], split=True)
    removed = lacking.removed(source)
    found = collected(removed)
    kept = np.array([row for row in range(ROWS) if row not in rows])
    assert lacking.count == len(rows)
    np.testing.assert_array_equal(found.column("q1"), _values()[1][kept])
    np.testing.assert_array_equal(
        found.column("segment"), np.cumsum(np.diff(kept, prepend=kept[0]) > 1)
    )
    assert [removed.row(i) for i in range(1, len(kept) + 1)] == [*(kept + 1)]


def test_dropped_rows_leave_the_columns_as_they_are() -> None:
    lacking = Lacking(["q1"], split=False)
    found = collected(lacking.removed(patched({"q1": [3, 4], "q2": [7]})))
    assert found.column_names == ["t", "q1", "q2"]
    assert found.num_rows == ROWS - 2


def test_a_log_without_a_complete_row_is_refused() -> None:
    source = patched({"q1": list(range(30)), "q2": list(range(30, ROWS))})
    with pytest.raises(BadData, match="60 rows lacks a value"):
        collected(Lacking(["q1", "q2"], split=True).removed(source))


@pytest.mark.parametrize("sizes", [[1], [7], [8192]])
def test_errors_name_rows_by_their_number_in_the_log(sizes: list[int]) -> None:
    """Also where a window begins later, and rows without a value were left out before."""
    source = patched({"q1": [20, 40], "q2": [30, 31]}, sizes)
    source = Lacking(["q2"], split=True).removed(within(source, Selection(first=22)))
    with pytest.raises(BadData, match="row 41, column q1"):
        collected(checked(source, "measurement"))


def test_the_clock_is_checked_within_the_window_only() -> None:
    t = np.concatenate(([0.0, 0.3], 1.0 + np.arange(40) * PERIOD, [9.0]))
    source = table({"t": t, "q1": np.sin(t)}, [7])
    found = checked(within(source, Selection(1.0, 5.0)), "measurement")
    assert found.period == pytest.approx(PERIOD)
    assert collected(found).num_rows == 40


def logs(count: int = 3) -> list[dict[str, np.ndarray]]:
    """Motions of which each begins at time 0."""
    return [motion(150, seed) for seed in range(count)]


def marked(columns: dict[str, np.ndarray], segment: np.ndarray) -> Table:
    """A table with a column of segments."""
    plain = table(columns)
    batch = next(plain.batches)
    schema = plain.schema.append(pa.field("segment", pa.int64()))
    whole = pa.RecordBatch.from_arrays([*batch.columns, pa.array(segment)], schema=schema)
    return replace(plain, schema=schema, batches=iter([whole]))


@given(SIZES)
@settings(max_examples=10, deadline=None)
def test_each_log_is_a_segment_and_time_goes_on(sizes: list[int]) -> None:
    found = collected(joined([table(columns, sizes) for columns in logs()]))
    np.testing.assert_array_equal(found.column("segment"), np.repeat([0, 1, 2], 150))
    assert np.all(np.diff(found.column("t")) > 0.0)
    for name in ("q1", "tau2"):
        whole = np.concatenate([columns[name] for columns in logs()])
        np.testing.assert_array_equal(found.column(name), whole)


def test_segments_of_the_logs_are_numbered_on() -> None:
    parts = [marked(columns, np.repeat([4, 7], [50, 100])) for columns in logs(2)]
    found = collected(joined(parts))
    expected = np.repeat([0, 3, 4, 7], [50, 100, 50, 100])
    np.testing.assert_array_equal(found.column("segment"), expected)


@pytest.mark.parametrize(
    ("own", "other", "alike"),
    [("rad", "rad", True), ("rad", "m", False), ("rad", None, True), (None, None, True)],
)
def test_logs_are_joined_unless_they_state_different_units(
    own: str | None, other: str | None, *, alike: bool
) -> None:
    units = (own, other)
    parts = [replace(log(), schema=log().schema.set(1, number("q1", u))) for u in units]
    with nullcontext() if alike else pytest.raises(BadData, match="unit m, expected rad"):
        joined(parts)


@pytest.mark.parametrize(("other", "common"), [((8.0, 4), 4), ((9.0, 4), None), ((8.0, 3), None)])
def test_logs_behind_different_low_passes_have_none_in_common(
    other: tuple[float, int], common: int | None
) -> None:
    parts = [
        replace(own := log(), meta=replace(own.meta, extra={"bandwidth": hertz, ORDER: order}))
        for hertz, order in ((8.0, 4), other)
    ]
    extra = joined(parts).meta.extra
    assert extra.get(ORDER) == common
    assert extra["bandwidth"] == 8.0


def test_estimates_from_several_logs_are_those_of_all_their_rows() -> None:
    """The rows of all logs in one least-squares problem, which numpy solves."""
    several = identify(
        joined([table(columns, [64]) for columns in logs()]),
        SCARA,
        ESTIMATORS.load("ls")(),
        np.zeros(8),
    )
    rows = {k: np.concatenate([columns[k] for columns in logs()]) for k in logs()[0]}
    q, dq, ddq, tau = (
        np.vstack([rows[f"{s}{i}"] for i in (1, 2)]) for s in ("q", "dq", "ddq", "tau")
    )
    W = SCARA.regressor(q, dq, ddq).reshape(-1, 8)
    expected = np.linalg.lstsq(W, tau.T.ravel(), rcond=None)[0]
    np.testing.assert_allclose(collected(several).column("estimate"), expected, rtol=1e-9)
