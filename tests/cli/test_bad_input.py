"""Bad data: exit 65 and one line that says where, what was found, what was expected, what to do."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import Result

from scarid_cli.algorithms.robots.reading import ROBOTS

Run = Callable[..., Result]

GOOD = ["t,q1,tau1"] + [f"{k / 100},{k},{k * 0.5}" for k in range(20)]


def with_line(number: int, line: str) -> list[str]:
    """The good log with one line replaced; line 0 is the header, so line k is row k."""
    return [*GOOD[:number], line, *GOOD[number + 1 :]]


CASES = {
    "NaN": (with_line(5, "0.04,nan,2"), "row 5, column q1: found nan, expected a finite number"),
    "infinity": (with_line(5, "0.04,1,-inf"), "row 5, column tau1: found -inf, expected a finite"),
    "empty cell": (with_line(5, "0.04,,2"), "row 5, column q1: found no value, expected a"),
    "mark for a missing value": (
        with_line(5, "0.04,n/a,2"),
        "row 5, column q1: found no value, expected a",
    ),
    "text": (with_line(5, "0.04,1.2.3,2"), "row 5, column q1: found '1.2.3', expected a number"),
    "short row": (with_line(5, "0.04,1"), "row 5: found 2 values, expected 3"),
    "long row": (with_line(5, "0.04,1,2,3"), "row 5: found 4 values, expected 3"),
    "repeated time": (with_line(5, "0.03,4,2"), "row 5, column t: found 0.03 after 0.03, expected"),
    "time that stands still at the start": (
        [GOOD[0], "0,1,2", *GOOD[1:]],
        "row 2, column t: found 0.0 after 0, expected time to increase",
    ),
    "time since 1970 with too few digits": (
        [GOOD[0], *(f"1.76389e+09,{k},2" for k in range(4))],
        "row 2, column t: found 1763890000.0 after 1763890000, expected time to increase from row "
        "to row; write it with at least 14 digits; `scarid check` says whether rows are repeated",
    ),
    "time running back": (with_line(5, "0.01,4,2"), "row 5, column t: found 0.01 after 0.03"),
    "rows in reverse order": (
        [*GOOD[:5], GOOD[7], GOOD[6], GOOD[5], *GOOD[8:]],
        "row 6, column t: found 0.05 after 0.06, expected time to increase",
    ),
    "jitter": (
        with_line(5, "0.042,4,2"),
        "row 5, column t: found an interval of 0.012 s, expected",
    ),
    "gap": (
        [*GOOD[:5], *GOOD[6:]],
        "row 5, column t: found an interval of 0.02 s, expected 0.01 s",
    ),
    "missing column": (["t,position,tau1", *GOOD[1:]], "column q1: found the columns t, position"),
    "no time": (["time,q1,tau1", *GOOD[1:]], "column t: found the columns time, q1, tau1"),
    "duplicate column": (
        ["t,q1,q1", *GOOD[1:]],
        "row 2, column q1: found 2 columns of this name, with other values",
    ),
    "nameless column": (["t,q1,", *GOOD[1:]], "row 1, column 3: found '0.0', expected nothing, as"),
    "other separator": (["t;q1;tau1", "0;1;2"], "found the single column 't;q1;tau1', expected"),
    "white space": (["t q1 tau1", "0 1.5 2e-3"], "found the single column 't q1 tau1', expected"),
    "one row": (GOOD[:2], "found 1 row, expected at least 2 samples; give a longer log"),
    "header only": (GOOD[:1], "found no rows, expected at least 2 samples; give a longer log"),
    "comments only": (["# a", "# b"], "found no rows, expected a CSV header; is the file empty"),
    "nothing": ([], "found no rows, expected a CSV header; is the file empty, or did"),
}


@pytest.mark.parametrize("name", CASES)
def test_a_bad_log_is_reported_in_one_line(name: str, scarid: Run, tmp_path: Path) -> None:
    lines, message = CASES[name]
    log = tmp_path / "log.csv"
    log.write_text("".join(f"{line}\n" for line in lines))
    output = tmp_path / "out.csv"
    output.write_text("kept")
    result = scarid("filter", "--cutoff", 10, log, "-o", output)
    assert result.status == 65
    assert result.err.startswith(f"scarid filter: {log}")
    assert message in result.err
    assert result.err.count("\n") == 1
    assert output.read_text() == "kept"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["log.csv", "out.csv"]


def write_parquet(path: Path, fields: list[pa.Field], rows: int = 20) -> None:
    t = np.arange(rows) / 100
    columns = [t if f.name == "t" else t.astype(f.type.to_pandas_dtype()) for f in fields]
    pq.write_table(pa.table(columns, schema=pa.schema(fields)), path)


@pytest.mark.parametrize("command", ["filter", "differentiate"])
def test_whole_numbers_are_as_good_as_others(command: str, scarid: Run, tmp_path: Path) -> None:
    """A log of encoder counts, say, whose columns are integers."""
    log, numbers = tmp_path / "log.parquet", tmp_path / "log.csv"
    k = np.arange(300)
    pq.write_table(pa.table({"t": k / 100, "q1": k**2 // 500, "n": k}), log)
    assert scarid("convert", log, "-o", numbers).status == 0
    result = scarid(command, log)
    assert result.status == 0
    assert result.out == scarid(command, numbers).out


@pytest.mark.parametrize(
    ("column", "values", "message"),
    [
        ("note", ["a", "b", "c"], "column note: found type string, expected double; convert"),
        ("volt", [1.0, 2.0, np.nan], "row 3, column volt: found nan, expected a finite number"),
        ("count", [1, 2, 5], None),
    ],
)
def test_a_column_that_no_schema_knows_can_be_filtered_if_it_holds_numbers(
    column: str, values: list[object], message: str | None, scarid: Run, tmp_path: Path
) -> None:
    log = tmp_path / "log.parquet"
    pq.write_table(pa.table({"t": [0.0, 0.01, 0.02], "q1": [0.0, 1.0, 2.0], column: values}), log)
    result = scarid("filter", "-c", column, log)
    assert result.status == (65 if message else 0)
    assert (message or "") in result.err
    if not message:
        numbers = [float(line.split(",")[2]) for line in result.out.splitlines()[1:]]
        assert numbers[0] == 1.0
        assert 1.0 < numbers[2] < 5.0


BEYOND = {
    "unread": ("differentiate --no-match", 0),
    "read": ("differentiate --match", 65),
    "interpolated": ("resample --rate 200", 65),
}


@pytest.mark.parametrize("name", BEYOND)
def test_values_are_checked_in_the_columns_that_a_command_reads(
    name: str, scarid: Run, tmp_path: Path
) -> None:
    """The others pass as they are."""
    log = tmp_path / "log.csv"
    lines = with_line(5, "0.04,4,nan")
    log.write_text("".join(f"{line}\n" for line in lines))
    command, status = BEYOND[name]
    result = scarid(*command.split(), log)
    assert result.status == status
    if status:
        assert "row 5, column tau1: found nan, expected a finite number" in result.err
    else:
        assert result.out.splitlines()[5].startswith("0.04,4,nan,")


def test_a_wrong_unit_is_reported(scarid: Run, tmp_path: Path) -> None:
    log = tmp_path / "log.parquet"
    degrees = pa.field("q1", pa.float64(), metadata={"unit": "deg"})
    write_parquet(log, [pa.field("t", pa.float64()), degrees])
    result = scarid("differentiate", log)
    assert result.status == 65
    assert f"{log}, column q1: found unit deg, expected rad or m; convert" in result.err


def test_text_in_a_typed_column_is_reported(scarid: Run, tmp_path: Path) -> None:
    log = tmp_path / "log.parquet"
    write_parquet(log, [pa.field("t", pa.float64()), pa.field("q1", pa.float64())])
    table = pq.read_table(log)
    words = pa.array(["x"] * table.num_rows)
    pq.write_table(table.set_column(1, "q1", words), log)
    result = scarid("differentiate", log)
    assert result.status == 65
    assert "column q1: found type string, expected double" in result.err


def test_parameters_of_another_robot_are_reported(
    scarid: Run, samples: Path, tmp_path: Path
) -> None:
    log = tmp_path / "log.csv"
    log.write_text("t,q1,dq1,ddq1,tau1\n0,1,2,3,4\n0.1,1,2,3,4\n")
    parameters = samples / "scara2.parameters.csv"
    result = scarid("validate", "--robot", "emps", "--parameters", parameters, log)
    assert result.status == 65
    assert "expected those of emps: M, Fv, Fc, offset" in result.err


@pytest.mark.parametrize("extension", ["parquet", "arrow", "arrows"])
@pytest.mark.parametrize("part", [0.3, 0.9, 0.99])
def test_a_cut_binary_file_is_reported(
    extension: str, part: float, scarid: Run, samples: Path, tmp_path: Path
) -> None:
    whole = tmp_path / f"log.{extension}"
    assert scarid("convert", samples / "scara2.csv", "-o", whole).status == 0
    data = whole.read_bytes()
    whole.write_bytes(data[: int(part * len(data))])
    result = scarid("filter", whole, "-o", tmp_path / "out.csv")
    assert result.status == 65
    assert result.err.startswith(f"scarid filter: {whole}: ")
    assert result.err.count("\n") == 1
    assert not (tmp_path / "out.csv").exists()


@pytest.mark.parametrize("data", [b"a\rb\0c\n" * 9, b"x" * 200_000], ids=["binary", "one line"])
def test_what_is_no_table_is_reported(data: bytes, scarid: Run, tmp_path: Path) -> None:
    log = tmp_path / "log"
    log.write_bytes(data)
    result = scarid("info", log)
    assert result.status == 65
    assert result.err == f"scarid info: {log}: neither CSV nor Parquet nor Arrow; is it a table?\n"


@pytest.mark.parametrize(
    ("method", "setting", "message"),
    [
        ("kalman-lag", "delay=6", "a lag of 600 samples is longer than the log of 501 rows"),
        ("savgol", "window=1003", "a lag of 501 samples is longer than the log of 501 rows"),
        ("savgol", "window=503", "window of 503 samples is longer than the log of 501 rows"),
    ],
)
def test_a_lag_longer_than_the_log_leaves_no_output(
    method: str, setting: str, message: str, scarid: Run, samples: Path, tmp_path: Path
) -> None:
    """Which can only be known at its end."""
    out = tmp_path / "motion.csv"
    log = samples / "scara2.csv"
    words = ["--no-match", "--method", method, "--set", setting]
    result = scarid("differentiate", *words, log, "-o", out)
    assert result.status == 65
    assert message in result.err
    assert result.err.count("\n") == 1
    assert not out.exists()


def test_via_points_that_break_the_bounds_are_refused(scarid: Run, tmp_path: Path) -> None:
    via = tmp_path / "via.csv"
    via.write_text("t,q1,q2\n0,0,0\n0.5,1,0\n2,0,0\n")
    result = scarid("trajgen", "--via", via)
    assert result.status == 2
    assert "segment 1: joint 1 would reach" in result.err
    assert "give the segment at least 0.5373 s instead of 0.5 s" in result.err


def test_joints_without_bounds_are_named(scarid: Run, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    first, rest = (ROBOTS / "scara2.toml").read_text("utf-8").split("acceleration_limit", 1)
    path.write_text(f"{first}# a{rest}")
    result = scarid("trajgen", "--robot", path)
    assert result.status == 2
    assert "has no limits of acceleration (joint 1): type `--ddq-max NUMBERS`" in result.err


def test_a_robot_without_bounds_needs_them_as_options(scarid: Run, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    text = (ROBOTS / "emps.toml").read_text("utf-8")
    path.write_text(text.replace("velocity_limit", "# v").replace("acceleration_limit", "# a"))
    result = scarid("trajgen", "--robot", path)
    assert result.status == 2
    assert "has no limits of velocity, acceleration: type `--dq-max NUMBERS --dd" in result.err
    assert scarid("trajgen", "--robot", path, "--dq-max", 0.1, "--ddq-max", 1, "-q").status == 0


def test_a_loop_that_blows_up_is_an_error_and_not_a_table(scarid: Run, tmp_path: Path) -> None:
    reference = tmp_path / "ref.csv"
    assert scarid("trajgen", "--duration", 2, "-o", reference).status == 0
    output = tmp_path / "log.csv"
    result = scarid("simulate", "--kp", "800,25", "--kd", "1e5,1e5", reference, "-o", output)
    assert result.status == 65
    assert "became unstable at t = " in result.err
    assert not output.exists()
