"""Inputs made to break a reader: refused in one line, soon, and with little memory."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from conftest import Result
from hypothesis import given
from hypothesis import strategies as st

Run = Callable[..., Result]
NAME = os.fsdecode(b"x\xff\xc3y")


@pytest.fixture
def motion(scarid: Run, tmp_path: Path) -> Path:
    path = tmp_path / "motion.parquet"
    text = "trajgen -q --seed 1 --duration 4 then simulate -q then differentiate -q -o"
    words = text.split(" ")
    assert scarid(*words, path).status == 0
    return path


def test_an_estimate_that_is_no_number_is_refused_with_its_row(
    scarid: Run, motion: Path, tmp_path: Path
) -> None:
    good, bad = tmp_path / "good.csv", tmp_path / "bad.csv"
    assert scarid("identify", "-q", motion, "-o", good).status == 0
    header, *lines = good.read_text().splitlines()
    at = header.split(",").index("estimate")
    commands = (
        ("validate", motion, "--parameters", bad),
        ("compare", bad, good),
        ("report", bad),
        ("identify", motion, "--estimator", "rls", "--initial", bad),
    )
    for row in (0, len(lines) - 1):
        for value in ("", "nan", "-inf", "1e308", "-1e200"):
            cells = lines[row].split(",")
            cells[at] = value
            bad.write_text("\n".join([header, *lines[:row], ",".join(cells), *lines[row + 1 :]]))
            for command in commands:
                done = scarid(*command)
                assert done.status == 65, (command, value, done.err)
                assert f"row {row + 1}, column estimate: found" in done.err
                assert done.err.count("\n") == 1


def test_names_that_are_not_utf8_are_read_written_and_shown(
    scarid: Run, motion: Path, tmp_path: Path
) -> None:
    log, table = tmp_path / f"{NAME}.parquet", tmp_path / f"p{NAME}.parquet"
    log.write_bytes(motion.read_bytes())
    assert scarid("identify", "-q", log, "-o", table).status == 0
    out = tmp_path / f"c{NAME}.parquet"
    for words in (
        ("compare", table, table, "-o", out),
        ("report", table, "--html", tmp_path / f"r{NAME}.html"),
        ("validate", "-q", log, "--parameters", table, "-o", tmp_path / "v.parquet"),
        ("info", log),
    ):
        done = scarid(*words)
        assert done.status == 0, done.err
    with out.open("rb") as file:
        (written,) = set(pq.read_table(file).column("table").to_pylist())
    assert written.endswith("px\\xff\\xc3y.parquet")


@given(
    kept=st.integers(0, 2),
    name=st.sampled_from(["readme.txt", "q1", "folder/", "q1.npy.bak", "\x1b[2J"]),
    content=st.binary(max_size=40).filter(lambda x: not x.startswith(b"\x93NUMPY")),
)
def test_an_archive_with_other_members_is_refused(
    tmp_path_factory: pytest.TempPathFactory, kept: int, name: str, content: bytes
) -> None:
    from scarid_cli.errors import BadData
    from scarid_cli.io.foreign import read_archive

    path = tmp_path_factory.mktemp("archive") / "log.npz"
    np.savez(path, **{f"q{i}": np.arange(5.0) for i in range(kept)})
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(name, b"" if name.endswith("/") else content)
    with pytest.raises(BadData, match=r"log\.npz: not a readable \.npz file .*; save it again"):
        read_archive(str(path))


def test_many_columns_are_read_and_written(scarid: Run, tmp_path: Path) -> None:
    """The time grows with the number of columns, and not with its square."""
    names = ["t", *(f"c{i}" for i in range(16_000))]
    path = tmp_path / "wide.csv"
    path.write_text("\n".join([",".join(names), *[",".join(["1"] * len(names))] * 2]) + "\n")
    done = scarid("convert", "-q", path, "-o", tmp_path / "out.csv")
    assert done.status == 0, done.err
    assert (tmp_path / "out.csv").read_text().split("\n")[0] == ",".join(names)
