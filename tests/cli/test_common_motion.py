"""Soft sensors of a real log are compared with the common motion, for want of the truth."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest
from conftest import Result

Run = Callable[..., Result]
COLUMNS = ("dq1", "ddq1", "dq2", "ddq2")


@pytest.fixture
def folder(tmp_path: Path, scarid: Run, samples: Path) -> Path:
    """The motions of a log by two soft sensors, and the common one."""
    log = samples / "scara2.csv"
    options = ("--method", "zero-phase", "--set", "cutoff=8", "--match")
    assert (
        scarid("differentiate", *options, log, "-o", tmp_path / "common.motion.parquet").status == 0
    )
    for method in ("kalman", "p2smd"):
        out = tmp_path / f"{method}.motion.parquet"
        assert scarid("differentiate", "--method", method, log, "-o", out).status == 0
    return tmp_path


def reported(scarid: Run, *files: Path) -> str:
    result = scarid("report", *files)
    assert result.status == 0, result.err
    return result.out


def test_errors_are_those_of_rows_at_the_same_time(folder: Path, scarid: Run) -> None:
    files = [folder / f"{name}.motion.parquet" for name in ("kalman", "common", "p2smd")]
    text = reported(scarid, *files)
    assert "difference from the common motion" in text
    assert not re.search(r"^common ", text, re.MULTILINE)
    common, own = (
        table.filter(pc.equal(table["settled"], 1)) if "settled" in table.column_names else table
        for table in (
            pq.read_table(folder / f"{name}.motion.parquet") for name in ("common", "p2smd")
        )
    )
    joined = own.join(common, "t", right_suffix="_common", join_type="inner")
    assert joined.num_rows > 300
    row = next(line for line in text.splitlines() if line.startswith("p2smd"))
    for column, cell in zip(COLUMNS, row.split()[1:], strict=True):
        x, y = (joined[name].to_numpy() for name in (f"{column}_common", column))
        expected = 100.0 * np.sqrt(np.sum((y - x) ** 2) / np.sum((x - x.mean()) ** 2))
        assert float(cell) == pytest.approx(expected, rel=1e-3)


def test_the_page_draws_the_differences(folder: Path, scarid: Run) -> None:
    html = folder / "report.html"
    reported(scarid, *sorted(folder.glob("*.motion.parquet")), "--html", html)
    page = html.read_text("utf-8")
    assert page.count("Error (estimate minus common motion) of") == len(COLUMNS)
    assert "Estimates of dq1" not in page


def test_the_truth_counts_where_it_is_known(tmp_path: Path, scarid: Run) -> None:
    log = tmp_path / "log.parquet"
    path = tmp_path / "path.parquet"
    assert scarid("trajgen", "--duration", 5, "-o", path).status == 0
    assert scarid("simulate", "--truth", path, "-o", log).status == 0
    files = [tmp_path / f"{name}.motion.parquet" for name in ("common", "kalman")]
    for file in files:
        assert scarid("differentiate", log, "-o", file).status == 0
    text = reported(scarid, *files)
    assert "difference from the truth" in text
    assert re.search(r"^common ", text, re.MULTILINE)


def test_a_common_motion_of_another_log_is_refused(folder: Path, scarid: Run) -> None:
    other, path = folder / "other.parquet", folder / "path.parquet"
    assert scarid("trajgen", "--seed", 9, "--duration", 5, "--rate", 100, "-o", path).status == 0
    assert scarid("simulate", "--log-rate", 100, path, "-o", other).status == 0
    common = folder / "common.motion.parquet"
    assert scarid("differentiate", other, "-o", common).status == 0
    result = scarid("report", common, folder / "kalman.motion.parquet")
    assert (result.status, result.out) == (65, "")
    assert "common.motion.parquet: found other positions at the same time" in result.err
    assert "expected a motion of the same log" in result.err
    assert result.err.count("\n") == 1
