"""A small file does not become a large one in memory: it is read in parts, or refused."""

from __future__ import annotations

import gzip
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import Result, refused
from scipy.io import savemat

from scarid_cli.io.parts import PART, parts

Run = Callable[..., Result]

ROWS = 5_000_000  # at a ceiling of 20 MB; `make faults` has bombs of gigabytes, and measures memory
ZEROS = np.zeros(ROWS)
LIMIT = 1 << 30  # bytes of memory


def arrow(path: Path, batch: pa.RecordBatch) -> None:
    made = pa.ipc.new_file if path.suffix == ".arrow" else pa.ipc.new_stream
    with made(path, batch.schema, options=pa.ipc.IpcWriteOptions(compression="zstd")) as file:
        file.write_batch(batch)


def zeros(path: Path) -> None:
    """One batch of 120 MB in some kilobytes."""
    column = pa.array(np.zeros(ROWS))
    arrow(path, pa.record_batch([column] * 3, ["t", "q1", "tau1"]))


def repeated(path: Path) -> None:
    """One text of a megabyte, in each of 20,000 rows."""
    t = np.arange(20_000) / 1000.0
    texts = pa.DictionaryArray.from_arrays(np.zeros(20_000, np.int32), pa.array(["x" * 1_000_000]))
    if path.suffix == ".parquet":
        pq.write_table(pa.table({"t": t, "q1": t, "text": texts}), path, compression="zstd")
    else:
        arrow(path, pa.record_batch([t, t, texts], ["t", "q1", "text"]))


def listed(path: Path) -> None:
    """One row with a list of millions of numbers."""
    column = pa.array(ZEROS)
    lists = pa.ListArray.from_arrays([0, len(column)], column)
    pq.write_table(pa.table({"t": [0.0], "list": lists}), path, compression="zstd")


def unzipped(path: Path) -> None:
    """One row of 60 MB."""
    with gzip.open(path, "wb", compresslevel=1) as file:
        file.write(b"t,q1\n0,")
        for _ in range(60):
            file.write(b"8" * 1_000_000)


def archived(path: Path) -> None:
    (np.savez_compressed if path.suffix == ".npz" else saved)(path, t=ZEROS, q1=ZEROS)


def saved(path: Path, **arrays: object) -> None:
    savemat(path, arrays, do_compression=True)


BOMBS = [
    (zeros, "log.arrows"),
    (zeros, "log.arrow"),
    (repeated, "log.parquet"),
    (repeated, "log.arrows"),
    (repeated, "log.arrow"),
    (listed, "log.parquet"),
    (unzipped, "log.csv.gz"),
    (archived, "log.npz"),
    (archived, "log.mat"),
]


def limited() -> None:
    resource.setrlimit(resource.RLIMIT_DATA, (LIMIT, LIMIT))


@pytest.mark.parametrize(("made", "name"), BOMBS, ids=lambda x: x if isinstance(x, str) else "")
def test_what_unfolds_to_gigabytes_is_refused_in_one_line(
    made: Callable[[Path], None], name: str, tmp_path: Path
) -> None:
    made(tmp_path / name)
    assert (tmp_path / name).stat().st_size < 1_000_000
    done = subprocess.run(
        [str(Path(sys.executable).parent / "scarid"), "convert", name, "-o", "out.parquet"],
        cwd=tmp_path,
        env={**os.environ, "SCARID_MAX_BATCH": "20"},
        capture_output=True,
        preexec_fn=limited,
        check=False,
    )
    assert done.returncode == 65
    assert done.stderr.count(b"\n") == 1
    assert b"SCARID_MAX_BATCH" in done.stderr
    assert os.listdir(tmp_path) == [name]  # noqa: PTH208


@pytest.mark.parametrize("name", ["log.arrows", "log.arrow"])
def test_the_ceiling_is_that_of_the_environment(
    name: str, scarid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A batch of 2.4 MB, as a user may have it who knows the memory of the machine."""
    t = np.arange(100_000) / 1000.0
    arrow(tmp_path / name, pa.record_batch([t, t, np.sin(t)], ["t", "q1", "tau1"]))
    expected = scarid("convert", tmp_path / name)
    assert expected.status == 0
    monkeypatch.setenv("SCARID_MAX_BATCH", "2")
    refused(scarid("filter", tmp_path / name, "-o", "out.csv"), 65, name, "SCARID_MAX_BATCH")
    monkeypatch.setenv("SCARID_MAX_BATCH", "20")
    assert scarid("convert", tmp_path / name).out == expected.out
    for value in ("0", "-1", "1.5", "much", "1" * 20):
        monkeypatch.setenv("SCARID_MAX_BATCH", value)
        refused(scarid("convert", tmp_path / name), 2, f"SCARID_MAX_BATCH={value}")


def test_a_large_batch_and_long_texts_arrive_whole(scarid: Run, tmp_path: Path) -> None:
    """In parts, which nothing shows in the result."""
    t = np.arange(30_000) / 1000.0
    texts = pa.array([f"{k % 7}" * (5000 if k % 100 == 0 else 3) for k in range(30_000)])
    plain = pa.record_batch([t, t, texts], ["t", "q1", "text"])
    folded = pa.record_batch([t, t, texts.dictionary_encode()], ["t", "q1", "text"])
    viewed = pa.record_batch([t, t, texts.cast(pa.string_view())], ["t", "q1", "text"])
    arrow(tmp_path / "plain.arrows", plain)
    expected = scarid("convert", tmp_path / "plain.arrows").out
    assert expected.count("\n") == 30_001
    for name, batch in (("folded", folded), ("viewed", viewed)):
        for ending in ("arrows", "arrow"):
            arrow(tmp_path / f"{name}.{ending}", batch)
            assert scarid("convert", tmp_path / f"{name}.{ending}").out == expected
        pq.write_table(pa.Table.from_batches([batch]), tmp_path / f"{name}.parquet")
        assert scarid("convert", tmp_path / f"{name}.parquet").out == expected


@pytest.mark.parametrize("type_", [pa.string(), pa.string_view()], ids=str)
def test_a_long_text_is_a_part_by_itself_and_its_neighbours_stay_together(
    type_: pa.DataType,
) -> None:
    texts = pa.array(["a", "b", "c" * (PART + 1), "d"]).cast(type_)
    found = [part.num_rows for part in parts(pa.record_batch([texts], ["text"]), "log")]
    assert found == [2, 1, 1]


def test_a_broken_message_of_an_arrow_table_is_refused(scarid: Run, tmp_path: Path) -> None:
    t = np.arange(50) / 1000.0
    for ending in ("arrows", "arrow"):
        arrow(tmp_path / f"log.{ending}", pa.record_batch([t, t], ["t", "q1"]))
        content = (tmp_path / f"log.{ending}").read_bytes()
        bad = tmp_path / f"bad.{ending}"
        rng = np.random.default_rng(0)
        for place in rng.integers(8, len(content) - 1, 60).tolist():
            bad.write_bytes(content[:place] + b"\xff\xff\xff\x7f" + content[place + 4 :])
            result = scarid("convert", bad, "-o", tmp_path / "out.csv")
            assert result.status in (0, 65)
            assert result.err.count("\n") == bool(result.status)
