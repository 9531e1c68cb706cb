"""`scarid check`, the robot that is stated or assumed, and `identify --require`."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import Result, refused

Run = Callable[..., Result]
ASSUMED = "no robot is stated, scara2 is assumed (state it with --robot or SCARID_ROBOT)"


@pytest.fixture(autouse=True)
def no_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SCARID_ROBOT", raising=False)


@pytest.fixture
def log(samples: Path) -> Path:
    return samples / "scara2.csv"


def changed(log: Path, place: Path, change: Callable[[int, list[str]], list[str] | None]) -> Path:
    """The log with each row (from 1) changed or, for None, left out."""
    header, *lines = log.read_text().splitlines()
    rows = (change(row, line.split(",")) for row, line in enumerate(lines, start=1))
    place.write_text("\n".join([header, *(",".join(row) for row in rows if row)]) + "\n")
    return place


def negated(_row: int, cells: list[str]) -> list[str]:
    return [*cells[:3], *(str(-float(x)) for x in cells[3:5]), *cells[5:]]


def without_some(row: int, cells: list[str]) -> list[str] | None:
    return None if row % 50 == 7 else cells


def with_empty_cell(row: int, cells: list[str]) -> list[str]:
    return [*cells[:3], "", *cells[4:]] if row == 100 else cells


CASES = [
    (lambda _, cells: cells, [], 0, "ok"),
    (lambda _, cells: cells, ["--strict"], 0, "ok"),
    (without_some, [], 0, "warning"),
    (without_some, ["--strict"], 1, "warning"),
    (negated, [], 65, "failed"),
    (with_empty_cell, ["--strict"], 65, "failed"),
]


@pytest.mark.parametrize(("change", "options", "status", "worst"), CASES)
def test_the_exit_status_is_that_of_the_worst_finding(
    change: Callable[[int, list[str]], list[str] | None],
    options: list[str],
    status: int,
    worst: str,
    scarid: Run,
    log: Path,
    tmp_path: Path,
) -> None:
    spoiled = changed(log, tmp_path / "log.csv", change)
    result = scarid("check", "--robot", "scara2", "--json", *options, spoiled)
    document = json.loads(result.out)
    assert (result.status, document["status"], result.err) == (status, worst, "")
    plain = scarid("check", "--robot", "scara2", *options, spoiled)
    assert plain.status == status
    for found in document["checks"]:
        assert f"{found['status']:<7}  {found['name']}" in plain.out
        assert found["advice"] in plain.out
        assert bool(found["advice"]) == (found["status"] != "ok")


def test_a_table_without_positions_is_refused_in_one_line(scarid: Run, samples: Path) -> None:
    refused(scarid("check", samples / "scara2.parameters.csv"), 65, "column t")


def test_a_log_of_a_few_rows_fails_without_a_fit(scarid: Run, log: Path, tmp_path: Path) -> None:
    short = changed(log, tmp_path / "log.csv", lambda row, cells: cells if row < 20 else None)
    result = scarid("check", "--robot", "scara2", short)
    assert result.status == 65
    assert "19 rows, too few without a gap" in result.out


@pytest.mark.parametrize("rows", [0, 1])
def test_a_log_without_rows_fails(rows: int, scarid: Run, log: Path, tmp_path: Path) -> None:
    short = changed(log, tmp_path / "log.csv", lambda row, cells: cells if row <= rows else None)
    result = scarid("check", "--robot", "scara2", short)
    assert result.status == 65
    found = f"{rows} row{'' if rows == 1 else 's'}"
    assert result.out.splitlines() == [
        f"failed   length  {found}",
        "                 -> give a longer log",
        "0 ok, 0 warning, 1 failed",
    ]


def test_rows_in_no_order_are_one_fault(scarid: Run, log: Path, tmp_path: Path) -> None:
    names, *rows = log.read_text("utf-8").splitlines()
    shuffled = tmp_path / "log.csv"
    order = np.random.default_rng(1).permutation(len(rows))
    shuffled.write_text("\n".join([names, *(rows[k] for k in order), ""]))
    result = scarid("check", "--robot", "scara2", shuffled)
    assert re.findall(r"^failed +(.*?)  ", result.out, re.M) == ["time order"]
    assert "0 warning, 1 failed" in result.out


def test_an_assumed_robot_is_told_once_and_a_stated_one_is_not(
    scarid: Run, log: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert scarid("check", log).err == f"scarid check: {ASSUMED}\n"
    assert scarid("check", "--robot", "scara2", log).err == ""
    motion = tmp_path / "motion.arrow"
    assert scarid("differentiate", "-q", log, "-o", motion).status == 0
    assert scarid("identify", motion).err.count(ASSUMED) == 1
    monkeypatch.setenv("SCARID_ROBOT", "scara2")
    assert scarid("check", log).err == ""
    assert ASSUMED not in scarid("identify", motion).err


def test_metadata_come_before_the_environment(
    scarid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So that the first command of a binary pipe states the robot for all."""
    monkeypatch.setenv("SCARID_ROBOT", "scara2")
    reference, log = tmp_path / "reference.parquet", tmp_path / "log.parquet"
    assert scarid("trajgen", "-q", "--robot", "emps", "-o", reference).status == 0
    assert scarid("simulate", reference, "-o", log).status == 0
    assert json.loads(scarid("info", "--json", log).out)["robot"] == "emps"


def test_another_robot_than_in_the_metadata_is_a_warning(scarid: Run, tmp_path: Path) -> None:
    reference = tmp_path / "reference.parquet"
    assert scarid("trajgen", "-q", "--robot", "scara2", "-o", reference).status == 0
    result = scarid("simulate", "--robot", "planar2-gravity", reference, "-o", tmp_path / "o.csv")
    assert result.status == 0
    assert "is a table of robot scara2 by its metadata, and not of planar2-gravity" in result.err


def test_more_columns_than_joints_are_a_warning(scarid: Run, log: Path, tmp_path: Path) -> None:
    wide = tmp_path / "log.csv"
    header, *lines = log.read_text().splitlines()
    wide.write_text("\n".join([f"{header},q3", *(f"{line},0.5" for line in lines)]) + "\n")
    result = scarid("check", "--robot", "scara2", wide)
    assert "has the column q3, but scara2 has only 2 joints: is it another robot" in result.err


def test_units_of_another_kind_of_joint_are_an_error(
    scarid: Run, log: Path, tmp_path: Path
) -> None:
    table = tmp_path / "log.parquet"
    assert scarid("convert", log, "-o", table).status == 0
    found = pq.read_table(table)
    metres = pa.field("q1", pa.float64(), metadata={"unit": "m"})
    pq.write_table(found.set_column(1, metres, found["q1"]), table)
    said = "column q1: found unit m, expected rad, as joint 1 of scara2 is revolute"
    refused(scarid("identify", "--robot", "scara2", table), 65, said)


REQUIRED = [("good", 0, 3), ("not-biased", 0, 0), ("identifiable", 0, 0)]


@pytest.mark.parametrize(("required", "clean", "reversed_"), REQUIRED)
def test_a_worse_verdict_than_required_exits_with_3_and_writes_the_table(
    required: str, clean: int, reversed_: int, scarid: Run, log: Path, tmp_path: Path
) -> None:
    spoiled = changed(log, tmp_path / "reversed.csv", negated)
    for source, status in ((log, clean), (spoiled, reversed_)):
        words = ("identify", "--robot", "scara2", source)
        plain, found = scarid(*words), scarid(*words, "--require", required)
        assert (plain.status, found.status) == (0, status)
        assert found.out == plain.out
        extra = found.err.removeprefix(plain.err)
        expected = (
            f"scarid identify: the verdict is doubtful, which is worse than --require {required}\n"
        )
        assert extra == (expected if status else "")
    assert "all friction that is known is negative: the torques' sign seems reversed" in plain.err


def test_identify_tells_of_degrees_and_of_held_samples(
    scarid: Run, log: Path, tmp_path: Path
) -> None:
    def degrees(_row: int, cells: list[str]) -> list[str]:
        return [cells[0], *(str(57.29578 * float(x)) for x in cells[1:3]), *cells[3:]]

    result = scarid("identify", "--robot", "scara2", changed(log, tmp_path / "a.csv", degrees))
    assert "doubtful: positions: joints 1, 2 up to 8" in result.err
    assert "positions seem to be in degrees: `scarid convert --unit" in result.err
    last: list[list[str]] = []

    def held(row: int, cells: list[str]) -> list[str]:
        last[:] = last if row % 10 == 0 else [cells]
        return [cells[0], *last[0][1:]]

    result = scarid("identify", "--robot", "scara2", changed(log, tmp_path / "b.csv", held))
    assert "warning: held samples: 50 rows" in result.err
    assert "warning" not in scarid("identify", "--robot", "scara2", log).err


def test_info_shows_extremes_and_missing_values(scarid: Run, log: Path, tmp_path: Path) -> None:
    spoiled = changed(log, tmp_path / "log.csv", with_empty_cell)
    columns = json.loads(scarid("info", "--json", spoiled).out)["columns"]
    assert [column["missing"] for column in columns[:5]] == [0, 0, 0, 1, 0]
    q1 = [float(line.split(",")[1]) for line in log.read_text().splitlines()[1:]]
    assert (columns[1]["minimum"], columns[1]["maximum"]) == (min(q1), max(q1))
    line = next(x for x in scarid("info", spoiled).out.splitlines() if x.startswith("  tau1"))
    assert ", 1 missing  Torque" in line


def test_an_unknown_command_suggests_the_nearest(scarid: Run) -> None:
    refused(scarid("identfy"), 2, "no such command 'identfy'; did you mean identify?")
