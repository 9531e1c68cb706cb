"""Samples that a logger holds while it waits for a slower sensor."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from stages.tables import collected, table

from scarid_cli.algorithms.processes.holding import FIRST, held_rows, intervals
from scarid_cli.algorithms.processes.resampling import Clock
from scarid_cli.arrays import Array
from scarid_cli.io.table import doubles
from scarid_cli.stages.records.holding import FirstIntervals
from scarid_cli.stages.resample import resample

Columns = dict[str, Any]


def held_log(sensor: float, rows: int = 3000) -> tuple[Columns, Array, Array]:
    """A log at 1000 Hz of a sensor with this period [s], with its instants and positions."""
    t = np.arange(rows) * 1e-3
    at = np.floor(t / sensor + 1e-9).astype(int)
    instants = np.arange(at[-1] + 1) * sensor
    q, tau = np.sin(2.0 * instants), np.cos(3.0 * instants) + 0.1 * np.sin(900.0 * instants)
    return {"t": t, "q1": q[at], "tau1": tau[at], "q1_ref": np.sin(2.0 * t)}, instants, q


def test_a_slower_sensor_is_interpolated_between_its_samples() -> None:
    columns, instants, q = held_log(8e-3)
    clocks: list[Clock] = []
    found = collected(resample(table(columns), 500.0, report=clocks.append))
    assert clocks[0].held == 3000 - len(instants)
    assert clocks[0].mean == pytest.approx(8e-3)
    assert clocks[0].gaps == 0
    np.testing.assert_allclose(found["q1"], np.interp(found["t"], instants, q), atol=1e-12)
    t = found["t"].to_numpy()
    error = np.sqrt(np.mean((found["q1"].to_numpy() - np.sin(2.0 * t)) ** 2))
    before = np.sqrt(np.mean((columns["q1"] - np.sin(2.0 * columns["t"])) ** 2))
    assert error < 0.01 * before


@pytest.mark.parametrize("sizes", [(1,), (7, 1, 300), (3000,)])
def test_the_first_row_of_each_is_kept_however_rows_arrive(sizes: tuple[int, ...]) -> None:
    """A sensor of 943 Hz: 5.7 % of the rows repeat, which numpy counts as well."""
    columns, _, _ = held_log(1.06e-3, rows=1500)
    repeats = np.append(False, (np.diff(columns["q1"]) == 0.0) & (np.diff(columns["tau1"]) == 0.0))
    clocks: list[Clock] = []
    found = collected(resample(table(columns, sizes), 1000.0, report=clocks.append))
    assert clocks[0].held == repeats.sum() > 80
    first = columns["t"][~repeats]
    for name in ("q1", "q1_ref"):
        expected = np.interp(found["t"], first, columns[name][~repeats])
        np.testing.assert_allclose(found[name], expected, atol=1e-12)


@pytest.mark.parametrize(("limit", "held"), [(5.0, True), (4.75, False)])
def test_an_interval_is_a_gap_when_it_exceeds_the_limit(limit: float, *, held: bool) -> None:
    """Without the rows that repeat the first one, five seconds are left until the next value."""
    values = np.array([[1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 3.0]] * 2)
    found, _ = held_rows(np.arange(7.0), values, np.zeros(7, dtype=np.int64), limit)
    assert found.tolist() == [False, *[held] * 4, False, False]


@pytest.mark.parametrize(("limit", "waiting"), [(5.0, 0), (4.75, 5)])
def test_rows_that_repeat_wait_for_their_end_until_they_are_a_gap(
    limit: float, waiting: int
) -> None:
    """Five seconds are the longest interval, or they are beyond it."""
    values = np.ones((2, 6))
    held = held_rows(np.arange(6.0), values, np.zeros(6, dtype=np.int64), limit)
    assert (held[0].any(), held[1]) == (False, waiting)


def test_rest_and_slow_encoders_are_no_held_samples() -> None:
    """A second at rest without noise, and two joints whose encoders change one after another."""
    t = np.arange(4000) * 1e-3
    moving = np.maximum(t - 1.0, 0.0)
    clocks: list[Clock] = []
    columns = {"t": t, "q1": np.sin(moving), "tau1": np.cos(moving)}
    found = collected(resample(table(columns), 1000.0, report=clocks.append))
    np.testing.assert_allclose(found["q1"], columns["q1"], atol=1e-12)
    steps = {f"q{i}": np.floor(t / 0.005 + i / 5.0) * 1e-4 for i in range(1, 6)}
    found = collected(resample(table({"t": t, **steps}), 1000.0, report=clocks.append))
    np.testing.assert_allclose(found["q3"], steps["q3"], atol=1e-12)
    assert [(clock.held, clock.gaps) for clock in clocks] == [(0, 0), (0, 0)]


@pytest.mark.parametrize("repeats", [1, 2, 3])
def test_a_log_that_ends_at_rest_keeps_its_last_rows(repeats: int) -> None:
    """They repeat the row before, but nothing else in the log does."""
    t = np.arange(500) * 1e-3
    moving = np.minimum(t, t[-1 - repeats])
    clocks: list[Clock] = []
    columns = {"t": t, "q1": np.sin(3.0 * moving), "tau1": np.cos(5.0 * moving)}
    found = collected(resample(table(columns), 1000.0, report=clocks.append))
    np.testing.assert_allclose(found["t"], t)
    np.testing.assert_allclose(found["q1"], columns["q1"], atol=1e-12)
    assert clocks[0].held == 0


def test_a_robot_at_rest_is_not_waited_for_without_end() -> None:
    """The first rows of a stream without an end arrive, in which no value ever changes."""
    rest = np.zeros(20_000)

    def batches() -> Iterator[pa.RecordBatch]:
        for start in itertools.count(0, len(rest)):
            t = (start + np.arange(len(rest))) * 1e-3
            columns = [doubles(x) for x in (t, *[rest] * 4)]
            yield pa.RecordBatch.from_arrays(columns, schema=stream.schema)

    names = ("t", "q1", "q2", "tau1", "tau2")
    stream = table(dict.fromkeys(names, rest))
    found = resample(replace(stream, batches=batches()), 1000.0)
    assert next(found.batches).num_rows > 0


@pytest.mark.parametrize("sizes", [(1,), (7, 1, 40), ()])
def test_the_period_of_a_slower_sensor_is_found_however_rows_arrive(sizes: tuple[int, ...]) -> None:
    """With a repeated time, and a rest before the first sample."""
    columns, _, _ = held_log(8e-3, rows=600)
    again = np.r_[np.zeros(50, dtype=int), np.arange(600)]
    again = np.insert(again, 300, again[300])
    columns = {name: values[again] for name, values in columns.items()}
    columns["t"] = np.insert(np.arange(650) * 1e-3, 300, 0.3)
    first = FirstIntervals(["q1", "tau1"])
    for batch in table(columns, sizes).batches:
        first.add(batch)
    values = np.array([columns["q1"], columns["tau1"]])
    every, new = intervals(columns["t"], values, np.zeros(651, dtype=np.int64))
    np.testing.assert_array_equal(first.every, every[:FIRST])
    np.testing.assert_array_equal(first.new, new[:FIRST])
