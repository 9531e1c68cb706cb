"""Torques, or positions, of a sensor that is slower than the logger."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.interpolate import lagrange
from stages.tables import collected, table

from scarid_cli.algorithms.processes.resampling import Clock
from scarid_cli.stages.resample import resample

ROWS = 2000
PERIOD = 0.005  # s, of the rows
HELD = 4  # rows that each reading of the torques lasts


def log(held: int = HELD) -> dict[str, Any]:
    """Two joints, whose torques are read every fourth row."""
    t = np.arange(ROWS) * PERIOD
    read = t[np.arange(ROWS) // held * held]
    columns = {f"q{i}": np.sin(i * t) for i in (1, 2)}
    return {"t": t, **columns, **{f"tau{i}": np.cos(9.0 * i * read) for i in (1, 2)}}


def resampled(columns: dict[str, Any], *sizes: int) -> tuple[Any, Clock]:
    clocks: list[Clock] = []
    given = table(columns, sizes) if sizes else table(columns)
    return collected(resample(given, 1.0 / PERIOD, report=clocks.append)), clocks[0]


def test_torques_are_interpolated_between_their_readings() -> None:
    """With a hundredth of the error that they had, and as scipy's polynomials give them."""
    columns = log()
    found, clock = resampled(columns)
    t = columns["t"]
    inner = slice(HELD, -2 * HELD)
    for i in (1, 2):
        true = np.cos(9.0 * i * t)
        before = np.abs(columns[f"tau{i}"] - true)[inner].max()
        assert np.abs(found[f"tau{i}"] - true)[inner].max() < 0.01 * before
        np.testing.assert_array_equal(found[f"q{i}"], columns[f"q{i}"])
    nodes = np.array([40, 44, 48, 52])
    polynomial = lagrange(t[nodes], columns["tau1"][nodes])
    np.testing.assert_allclose(found["tau1"][45:48], polynomial(t[45:48]), atol=1e-6)
    assert clock.filled == (("torques", pytest.approx(0.02), ROWS - ROWS // HELD - 3),)


@pytest.mark.parametrize("sizes", [(1,), (7, 1, 300), (ROWS,)])
def test_the_same_values_however_rows_arrive(sizes: tuple[int, ...]) -> None:
    whole, part = resampled(log())[0], resampled(log(), *sizes)[0]
    assert whole.equals(part)


def test_rows_after_the_last_reading_before_a_gap_are_left_alone() -> None:
    columns = log()
    kept = np.r_[0:803, 1001:ROWS]
    found, clock = resampled({name: values[kept] for name, values in columns.items()})
    assert clock.gaps == 1
    tau = found["tau1"].to_numpy()
    np.testing.assert_array_equal(tau[800:803], columns["tau1"][800])
    np.testing.assert_allclose(tau[4:797], np.cos(9.0 * columns["t"][4:797]), atol=1e-3)


def test_coarse_torques_and_torques_of_every_row_are_left_alone() -> None:
    columns = log(held=1)
    columns |= {f"tau{i}": np.round(columns[f"tau{i}"], 1) for i in (1, 2)}
    found, clock = resampled(columns)
    assert not clock.filled
    np.testing.assert_array_equal(found["tau1"], columns["tau1"])


@pytest.mark.parametrize("sizes", [(1,), (401, 202, 1), (ROWS + 2,)])
def test_a_reading_at_the_time_of_the_row_before_is_left_out(sizes: tuple[int, ...]) -> None:
    """Other values at the time of a reading and of a row that repeats it."""
    columns = log()
    again = np.insert(np.arange(ROWS), [401, 602], [400, 601])
    twice = {name: values[again] for name, values in columns.items()}
    for i in (1, 2):
        twice[f"tau{i}"][[401, 603]] += 0.01
    found, clock = resampled(twice, *sizes)
    inner = slice(HELD, -2 * HELD)
    true = np.cos(9.0 * columns["t"])
    assert clock.repeated == 2
    assert found.equals(resampled(twice)[0])
    assert np.abs(found["tau1"] - true)[inner].max() < 1e-3


def test_a_long_rest_before_the_first_reading_hides_no_slower_sensor() -> None:
    """Positions that rest for 1500 rows, and then are read every thirtieth row."""
    t = np.arange(3 * ROWS) * PERIOD
    at = t[np.arange(3 * ROWS) // 30 * 30]
    noise = 0.1 * np.random.default_rng(0).standard_normal((2, 3 * ROWS))
    columns = {"t": t} | {f"q{i}": np.sin(np.maximum(at - 1500 * PERIOD, 0.0)) for i in (1, 2)}
    _, clock = resampled(columns | {f"tau{i}": noise[i - 1] for i in (1, 2)})
    assert [(name, interval) for name, interval, _ in clock.filled] == [
        ("positions", pytest.approx(30 * PERIOD))
    ]
