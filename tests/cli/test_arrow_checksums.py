"""Damage to Arrow of our own writing ends every command with 65, and leaves no output file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from conftest import Result, refused

Run = Callable[..., Result]
ROWS, BATCH = 2000, 500


@pytest.fixture(params=["arrows", "arrow"])
def damaged(request: pytest.FixtureRequest, scarid: Run, tmp_path: Path) -> Path:
    """A log whose last value of q1 has lost a bit."""
    t = np.arange(ROWS) / 100.0
    log = pa.table({"t": t, "q1": np.sin(t), "tau1": np.cos(t)})
    with pa.ipc.new_stream(tmp_path / "given.arrows", log.schema) as stream:
        stream.write_table(log, max_chunksize=BATCH)
    path = tmp_path / f"log.{request.param}"
    assert scarid("convert", tmp_path / "given.arrows", "-o", path).status == 0
    content = bytearray(path.read_bytes())
    content[content.index(np.sin(t[-1]).tobytes())] ^= 1
    path.write_bytes(content)
    return path


@pytest.mark.parametrize("command", ["convert", "filter", "resample -q --rate 50"])
def test_a_flipped_bit_is_refused_in_one_line(command: str, damaged: Path, scarid: Run) -> None:
    found = scarid(*command.split(), damaged, "-o", damaged.with_name("out.csv"))
    refused(found, 65, str(damaged), "checksum", "write it again")
    assert not damaged.with_name("out.csv").exists()
    refused(scarid("info", damaged), 65, str(damaged), "checksum")


def test_the_message_says_after_which_row(damaged: Path, scarid: Run) -> None:
    whole = ROWS - BATCH if damaged.suffix == ".arrows" else 0  # a file has fewer, longer batches
    where = f"of the rows after row {whole}" if whole else "of the first rows"
    assert where in scarid("filter", damaged, "-o", damaged.with_name("out.csv")).err


def test_a_pipe_fails_in_which_the_damage_is_late(
    damaged: Path, shell: Run, tmp_path: Path
) -> None:
    pipe = f"cat {damaged} | scarid filter --format arrow | scarid filter -o {tmp_path}/out.arrows"
    found = shell(f"set -o pipefail; {pipe}")
    assert found.status == 65
    assert "the checksum of the" in found.err
    assert not (tmp_path / "out.arrows").exists()


def test_checksums_do_not_travel_into_the_metadata(scarid: Run, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("t,q1\n" + "".join(f"{k / 10},{k}\n" for k in range(20)))
    for before, after in (
        ("log.csv", "a.arrow"),
        ("a.arrow", "b.arrows"),
        ("b.arrows", "c.parquet"),
    ):
        assert scarid("convert", tmp_path / before, "-o", tmp_path / after).status == 0
    assert b"crc32" not in (tmp_path / "c.parquet").read_bytes()
    assert "crc32" not in scarid("info", tmp_path / "a.arrow").out
