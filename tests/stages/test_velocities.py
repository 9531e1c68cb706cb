"""Velocities of the log itself: used for the motion, or kept beside the estimated ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import Result, refused
from hypothesis import given, settings
from hypothesis import strategies as st
from stages.tables import PERIOD, collected, motion, table
from unit.support import without_search

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.algorithms.processes.method import Matching
from scarid_cli.io.table import Table
from scarid_cli.stages.conversion.velocities import apart
from scarid_cli.stages.differentiate import differentiate, matched

Run = Callable[..., Result]
LINEAR = [n for n in DIFFERENTIATORS.names if DIFFERENTIATORS.load(n)().suits_velocities]
SIZES = st.lists(st.sampled_from([1, 2, 7, 64, 8192]), min_size=1, max_size=4)


def log(sizes: list[int] | None = None) -> Table:
    """A log with velocities, whose positions and torques are something else altogether."""
    columns = {name: x for name, x in motion().items() if name[:3] != "ddq"}
    return table(columns, sizes or ())


@pytest.mark.parametrize("name", LINEAR)
def test_velocities_pass_what_torques_pass_and_give_the_accelerations(name: str) -> None:
    """A velocity that is a copy of the torque comes out as the torque does; ddq is its slope."""
    columns = {name: x for name, x in motion().items() if name[:3] != "ddq"}
    columns |= {f"dq{i}": columns[f"tau{i}"] for i in (1, 2)}
    method = without_search(name)
    found = collected(matched(table(columns), [method] * 2, velocities=True))
    inner = np.flatnonzero(np.array(found.column("settled")))[1:-1]
    for i in (1, 2):
        dq, ddq, tau = (np.array(found.column(f"{x}{i}")) for x in ("dq", "ddq", "tau"))
        np.testing.assert_allclose(dq[inner], tau[inner], rtol=1e-6, atol=1e-6)
        if method.MATCHING is Matching.EXACT:
            slope = (dq[inner + 1] - dq[inner - 1]) / (2.0 * PERIOD)
            np.testing.assert_allclose(ddq[inner], slope, rtol=1e-6, atol=1e-4)


def test_without_matching_velocities_stay_and_are_differentiated() -> None:
    method = DIFFERENTIATORS.load("central")()
    found = collected(differentiate(log(), [method] * 2, velocities=True))
    dq = motion()["dq2"]
    np.testing.assert_array_equal(found.column("dq2"), dq)
    np.testing.assert_array_equal(found.column("ddq2"), over(method, dq, PERIOD)[0])


@pytest.mark.parametrize("stage", [differentiate, matched])
@given(sizes=SIZES)
@settings(max_examples=8, deadline=None)
def test_the_bits_are_the_same_however_the_rows_arrive(
    stage: Callable[..., Table], sizes: list[int]
) -> None:
    methods = [DIFFERENTIATORS.load("kalman")()] * 2
    found = collected(stage(log(sizes), methods, velocities=True))
    assert found.equals(collected(stage(log(), methods, velocities=True)))


def test_velocities_of_the_log_are_kept_beside_the_estimates() -> None:
    methods = [DIFFERENTIATORS.load("kalman")()] * 2
    measurement = replace(log(), meta=replace(log().meta, kind="measurement"))
    found = collected(matched(apart(measurement), methods))
    np.testing.assert_array_equal(found.column("dq1_measured"), motion()["dq1"])
    assert not np.array_equal(found.column("dq1"), motion()["dq1"])


@pytest.fixture
def with_velocities(tmp_path: Path) -> Path:
    """The log as a CSV."""
    path, columns = tmp_path / "log.csv", collected(log())
    rows = zip(*(column.to_pylist() for column in columns.columns), strict=True)
    lines = [columns.column_names, *([str(x) for x in row] for row in rows)]
    path.write_text("".join(",".join(line) + "\n" for line in lines))
    return path


def test_the_command_tells_what_becomes_of_them(with_velocities: Path, scarid: Run) -> None:
    kept = scarid("differentiate", with_velocities)
    assert "dq1_measured" in kept.out.splitlines()[0]
    assert "--velocity measured uses them" in kept.err
    used = scarid("differentiate", "--velocity", "measured", with_velocities)
    assert "_measured" not in used.out.splitlines()[0]
    assert used.status == 0
    names, rows = with_velocities.read_text("utf-8").split("\n", 1)
    for column in ("dq1", "dq2"):
        names = names.replace(f",{column},", f",{column}_measured,")
    with_velocities.write_text(f"{names}\n{rows}")
    assert scarid("differentiate", "--velocity", "measured", with_velocities).out == used.out


def test_a_log_with_velocities_only_is_a_measurement(with_velocities: Path, scarid: Run) -> None:
    result = scarid("identify", "--robot", "scara2", with_velocities)
    assert "velocities and accelerations are estimated from the positions" in result.err
    assert result.status == 0


def test_a_motion_has_its_estimates_replaced(samples: Path, tmp_path: Path, scarid: Run) -> None:
    motion, again = tmp_path / "motion.parquet", tmp_path / "again.csv"
    scarid("differentiate", samples / "scara2.csv", "-o", motion)
    assert scarid("differentiate", motion, "-o", again).status == 0
    assert "_measured" not in again.read_text("utf-8").splitlines()[0]


def test_what_does_not_suit_measured_velocities_is_refused(
    with_velocities: Path, samples: Path, scarid: Run
) -> None:
    measured = ("differentiate", "--velocity", "measured")
    refused(scarid(*measured, samples / "scara2.csv"), 65, "column dq1", "--velocity")
    refused(scarid(*measured, "--method", "p2smd", with_velocities), 2, "linear method")
