"""`scarid report` on tables that it cannot report, and on files that it cannot write."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from conftest import Result, refused
from reports import result_tables, write

Run = Callable[..., Result]


@pytest.fixture
def tables(tmp_path: Path) -> list[Path]:
    return result_tables(tmp_path)


def test_a_trajectory_is_no_result(tmp_path: Path, scarid: Run) -> None:
    path = tmp_path / "reference.csv"
    assert scarid("trajgen", "-q", "--duration", 2, "-o", path).status == 0
    refused(scarid("report", path), 2, str(path), "trajectory", "parameters, trace, metrics, ")


@pytest.mark.parametrize("kind", [None, "recipe"])
def test_a_table_of_unknown_kind_is_bad_data(kind: str | None, tmp_path: Path, scarid: Run) -> None:
    path = write(tmp_path / "x.parquet", kind, {"a": [1.0]})
    refused(scarid("report", path), 65, str(path), "expected")


def test_a_table_given_twice_is_refused(tables: list[Path], scarid: Run) -> None:
    refused(scarid("report", tables[0], tables[0]), 2, str(tables[0]), "twice")
    refused(scarid("report", "-", "-"), 2, "- is given twice")


def test_two_documents_in_one_file_are_refused(tables: list[Path], scarid: Run) -> None:
    refused(scarid("report", tables[0], "--html", "x", "--markdown", "x"), 2, "two files")


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({"t": [0.0, 1.0], "p": [1.0, float("nan")]}, ["row 2", "column p", "finite"]),
        ({"t": [0.0, 1.0], "p": pa.array([None, 1.0])}, ["row 1", "column p", "empty"]),
        ({"t": [0.0, 1.0], "p": ["a", "b"]}, ["column p", "string"]),
        ({"t": [0.0, 1.0]}, ["column t alone"]),
        ({"t": [1.0, 0.0], "p": [1.0, 1.0]}, ["row 2", "column t"]),
    ],
)
def test_a_bad_trace_is_refused_with_its_row_and_column(
    columns: dict[str, Any], words: list[str], tmp_path: Path, scarid: Run
) -> None:
    path = write(tmp_path / "m.trace.parquet", "trace", columns)
    refused(scarid("report", path), 65, str(path), *words)


def test_a_prediction_that_lacks_a_joint_is_refused(tmp_path: Path, scarid: Run) -> None:
    columns = {"t": [0.0, 1.0], "tau1": [1.0, 1.0], "tau1_pred": [1.0, 1.0], "tau2": [1.0, 1.0]}
    path = write(tmp_path / "m.parquet", "prediction", columns)
    refused(scarid("report", path), 65, str(path), "tau2_pred")


def test_parameters_without_rows_are_refused(tmp_path: Path, scarid: Run) -> None:
    path = tmp_path / "m.csv"
    path.write_text("parameter,unit,estimate\n")
    refused(scarid("report", path), 65, str(path), "no rows")


def test_a_failure_leaves_what_was_there(tables: list[Path], tmp_path: Path, scarid: Run) -> None:
    old, new = tmp_path / "old.html", tmp_path / "new.md"
    old.write_text("kept")
    bad = write(tmp_path / "z.trace.parquet", "trace", {"t": [0.0, 1.0], "p": [1.0, np.inf]})
    before = sorted(tmp_path.iterdir())
    refused(scarid("report", *tables, bad, "--html", old, "--markdown", new), 65, str(bad))
    assert old.read_text() == "kept"
    assert sorted(tmp_path.iterdir()) == before


def test_a_path_that_cannot_be_written_is_reported_first(tables: list[Path], scarid: Run) -> None:
    refused(scarid("report", __file__, "--html", "/nowhere/r.html"), 74, "/nowhere/r.html")
    refused(scarid("report", tables[0], "--html", "/dev/full"), 74, "/dev/full")
