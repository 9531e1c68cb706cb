"""`scarid compare`: what differs is named, and what cannot be compared is refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from conftest import Result

Run = Callable[..., Result]
OPTIONS = ("--estimator", "wls", "--drop-slow", 0.1)


@pytest.fixture
def tables(scarid: Run, samples: Path, tmp_path: Path) -> list[Path]:
    """The parameters of the sample log, and of the same log with torques of joint 2 10 % larger."""
    log = (samples / "scara2.csv").read_text().splitlines()
    place = log[0].split(",").index("tau2")
    rows = [line.split(",") for line in log[1:]]
    for row in rows:
        row[place] = repr(1.1 * float(row[place]))
    other = tmp_path / "other.csv"
    other.write_text("\n".join([log[0], *(",".join(row) for row in rows)]) + "\n")
    found = []
    for name, source in (("a", samples / "scara2.csv"), ("b", other)):
        motion, table = tmp_path / f"{name}.motion.parquet", tmp_path / f"{name}.parquet"
        assert scarid("differentiate", source, "-o", motion).status == 0
        assert scarid("identify", *OPTIONS, motion, "-o", table).status == 0
        found.append(table)
    return found


def refused(scarid: Run, *words: object, status: int = 65) -> str:
    result = scarid("compare", *words)
    assert (result.status, result.out) == (status, "")
    assert result.err.count("\n") == 1
    return result.err


def test_what_differs_is_named(scarid: Run, tables: list[Path], tmp_path: Path) -> None:
    result = scarid("compare", *tables, "-o", tmp_path / "c.parquet")
    assert "differ: " in result.err
    assert "L1MX2" in result.err
    rows = pq.read_table(tmp_path / "c.parquet").to_pylist()
    assert {row["parameter"] for row in rows if row["p_value"] < 0.05} >= {"ZZ2", "L1MX2"}


def test_a_table_agrees_with_itself(scarid: Run, tables: list[Path]) -> None:
    result = scarid("compare", tables[0], tables[0])
    assert "same: the estimates are at most 0 errors apart" in result.err
    assert len(result.out.splitlines()) == 10


def test_three_tables_have_a_trend(scarid: Run, tables: list[Path]) -> None:
    result = scarid("compare", tables[0], tables[0], tables[1])
    assert len(result.out.splitlines()) == 19
    assert "trend over the 3 tables" in result.err.splitlines()[-1]


def test_csv_has_no_covariance_and_this_is_reported(
    scarid: Run, tables: list[Path], tmp_path: Path
) -> None:
    assert scarid("convert", tables[0], "-o", tmp_path / "a.csv").status == 0
    result = scarid("compare", tmp_path / "a.csv", tables[1])
    assert "no joint test" in result.err.splitlines()[0]
    assert "differ: " in result.err


def test_one_table_is_not_enough(scarid: Run, tables: list[Path]) -> None:
    assert "at least two" in refused(scarid, tables[0], status=2)


def test_another_robot_and_other_units_are_refused(
    scarid: Run, tables: list[Path], tmp_path: Path
) -> None:
    assert scarid("convert", tables[0], "-o", tmp_path / "a.csv").status == 0
    text = (tmp_path / "a.csv").read_text()
    wrong = tmp_path / "wrong.csv"
    wrong.write_text(text.replace("kg m2", "g m2"))
    assert "found ZZ1R in g m2, expected kg m2" in refused(scarid, tables[0], wrong)
    wrong.write_text(text.replace("ZZ1R", "M"))
    assert "found other parameters (M, ZZ1R)" in refused(scarid, tables[0], wrong)
