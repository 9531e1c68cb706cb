"""Whatever the input is, a command ends by itself with the documented status and one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import Result, refused
from scipy.io import savemat

from scarid_cli.algorithms.choices.registry import ESTIMATORS
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.errors import UsageFault
from scarid_cli.stages.results.continuation import restored

Run = Callable[..., Result]

T = np.arange(50) / 100.0
OTHER = {
    "complex": T * 1j,
    "text": np.array(["a"] * 50),
    "three dimensions": np.zeros((50, 2, 2)),
    "whole numbers beyond 2^53": np.arange(50) + 2**60,
}


def saved(path: Path, arrays: dict[str, object]) -> Path:
    """The arrays as .npz or .mat."""
    if path.suffix == ".npz":
        np.savez(path, **arrays)  # type: ignore[arg-type]
    else:
        savemat(path, arrays)
    return path


@pytest.mark.parametrize("ending", [".npz", ".mat"])
@pytest.mark.parametrize("kind", OTHER)
def test_an_array_that_cannot_be_a_column_is_named(
    kind: str, ending: str, scarid: Run, tmp_path: Path
) -> None:
    log = saved(tmp_path / f"log{ending}", {"t": T, "q1": T**2, "extra": OTHER[kind]})
    refused(scarid("convert", log), 65, str(log), "column extra")


def test_dates_of_numpy_and_cells_of_matlab_are_named(scarid: Run, tmp_path: Path) -> None:
    dates = np.array(["2020-01-01"] * 50, dtype="datetime64[s]")
    log = saved(tmp_path / "log.npz", {"t": T, "q1": T, "day": dates})
    refused(scarid("convert", log), 65, "column day", "datetime64")
    cells = np.empty(50, dtype=object)
    cells[:] = [np.zeros(2)] * 50
    log = saved(tmp_path / "log.mat", {"t": T, "q1": T, "cells": cells})
    refused(scarid("convert", log), 65, "column cells")


def test_single_numbers_and_exact_whole_numbers_of_an_archive_are_taken(
    scarid: Run, tmp_path: Path
) -> None:
    for name in ("log.npz", "log.mat"):
        log = saved(tmp_path / name, {"t": T, "q": np.outer(T, [1, 2]), "n": np.arange(50), "h": 1})
        result = scarid("convert", log)
        assert result.status == 0
        assert result.out.startswith("t,q1,q2,n\n0,0,0,0\n")


@pytest.mark.parametrize("ending", [".npz", ".mat"])
def test_a_damaged_archive_is_refused_in_one_line(ending: str, scarid: Run, tmp_path: Path) -> None:
    """At whatever byte it was cut, and with whatever bit flipped."""
    rng = np.random.default_rng(0)
    content = saved(tmp_path / f"log{ending}", {"t": T, "q1": T**2}).read_bytes()
    damaged = tmp_path / f"damaged{ending}"
    cut = [content[:n] for n in rng.integers(0, len(content) - 1, 4)]
    flipped = [bytearray(content) for _ in range(4)]
    for bad in flipped:
        bad[rng.integers(len(bad))] ^= 1 << int(rng.integers(8))
    for bad in (*cut, *flipped):
        damaged.write_bytes(bad)
        result = scarid("convert", damaged)
        assert result.status in (0, 65)
        if result.status or bad in cut:
            refused(result, 65, str(damaged))


def test_a_crash_of_the_reader_of_mat_files_is_one_line(
    scarid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = saved(tmp_path / "log.mat", {"t": T, "q1": T})
    program = tmp_path / "crashing"
    program.write_text("#!/bin/sh\nkill -SEGV $$\n")
    program.chmod(0o755)
    monkeypatch.setattr("sys.executable", str(program))
    refused(scarid("convert", log), 65, str(log), "crashed")


def test_a_text_column_with_offsets_beyond_its_buffer_is_refused(
    shell: Run, tmp_path: Path
) -> None:
    """Reading it would read memory that belongs to others."""
    texts = pa.Array.from_buffers(
        pa.string(),
        3,
        [
            None,
            pa.py_buffer(np.array([0, 10**8, -7, 2], dtype=np.int32)),
            pa.py_buffer(b"ab"),
        ],
    )
    batch = pa.record_batch(
        [pa.array([0.0, 0.1, 0.2]), pa.array([0.0, 1.0, 2.0]), texts], list("txn")
    )
    with pa.ipc.new_stream(tmp_path / "log.arrows", batch.schema) as stream:
        stream.write_batch(batch)
    for command in ("convert log.arrows", "convert log.arrows -o out.parquet", "info log.arrows"):
        result = shell(f"scarid {command}")
        assert result.status == 65
        assert result.err.count("\n") == 1


STRANGE = {
    "list": pa.array([[1]] * 50),
    "structure": pa.array([{"a": 1}] * 50),
    "map": pa.array([[("a", 1)]] * 50, pa.map_(pa.string(), pa.int8())),
    "bytes": pa.array([b"a,\n"] * 50),
    "dictionary": pa.array(["a", "b"] * 25).dictionary_encode(),
    "uint64": pa.array([2**64 - 1] * 50, pa.uint64()),
    "time": pa.array([0] * 50, pa.timestamp("ns")),
    "interval": pa.array([(1, 1, 1)] * 50, pa.month_day_nano_interval()),
    "nothing": pa.nulls(50),
    "view": pa.array(["a"] * 50, pa.string_view()),
}


@pytest.mark.parametrize("kind", STRANGE)
@pytest.mark.parametrize("command", ["convert", "filter", "resample -q --rate 50", "info"])
def test_a_column_of_an_unusual_type_passes_or_is_refused_in_one_line(
    kind: str, command: str, scarid: Run, tmp_path: Path
) -> None:
    table = {"t": T, "q1": T**2, "other": STRANGE[kind]}
    try:
        pq.write_table(pa.table(table), tmp_path / "log.parquet")
    except pa.ArrowNotImplementedError:
        pytest.skip("Parquet has no such type")
    for output in ("out.csv", "out.arrow"):
        words = () if command == "info" else ("-o", tmp_path / output)
        result = scarid(*command.split(), tmp_path / "log.parquet", *words)
        assert result.status in (0, 65)
        assert result.err.count("\n") == bool(result.status)
        assert not result.status or "other" in result.err


@pytest.mark.parametrize("start", [b'0.06,"1,2\n', b'"', b"7"])
def test_csv_with_a_stray_quote_or_a_long_line_is_read_in_linear_time(
    start: bytes, tmp_path: Path
) -> None:
    """As many bytes are looked at as there are, whether they come in small pieces or large ones."""
    from scarid_cli.io import csvio

    class Bytes(bytes):
        looked = 0

        def count(self, *given: object) -> int:  # type: ignore[override]
            _, first, last = (*given, *(0, len(self))[len(given) - 1 :])
            Bytes.looked += int(last) - int(first)  # type: ignore[call-overload]
            return super().count(*given)  # type: ignore[arg-type]

        def __getitem__(self, key: object) -> Bytes:  # type: ignore[override]
            return Bytes(super().__getitem__(key))  # type: ignore[call-overload]

    tail = b"8" * 300_000 if start == b"7" else b"0.1,2,3\n" * 40_000
    content = start + tail

    class Pieces:
        name = "log.csv"

        def __init__(self) -> None:
            self.left = [Bytes(content[i : i + 4096]) for i in range(0, len(content), 4096)]

        def read_some(self) -> bytes:
            return self.left.pop(0) if self.left else b""

    found = list(csvio._complete_lines(Pieces()))  # type: ignore[arg-type]
    assert b"".join(found).rstrip(b"\n") == content.rstrip(b"\n")
    assert Bytes.looked <= 3 * len(content)


def test_a_quote_that_nothing_closes_is_reported(scarid: Run, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    rows = [f"{k / 100},{k},{k * 0.5}\n" for k in range(60_000)]
    rows[30_000] = '300.0,"30000,1\n'
    log.write_text("t,q1,tau1\n" + "".join(rows))
    result = scarid("filter", log, "-o", tmp_path / "out.csv")
    refused(result, 65, str(log))


def test_a_clock_of_the_smallest_steps_is_no_bug(scarid: Run, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text("t,q1\n" + "".join(f"{k}e-320,{k}\n" for k in range(20)))
    assert scarid("differentiate", log, "-o", tmp_path / "out.csv").status in (2, 65)


@pytest.mark.parametrize(
    "document",
    [
        b"[",
        b"[]",
        b"{}",
        b"[" * 100_000,
        b'{"history":[1]}',
        b'{"history":[],"kind":"../x"}',
        b'{"history":[],"period":"x"}',
        b'{"history":[],"robot":5}',
        b'{"history":[],"extra":{"delay":1e101}}',
        b'{"history":[],"extra":{"delay":true}}',
        b'{"history":[],"extra":{"delay":"1"}}',
        b"\xff",
    ],
)
def test_malformed_metadata_is_bad_data(document: bytes, scarid: Run, tmp_path: Path) -> None:
    table = pa.table({"t": T, "q1": T}).replace_schema_metadata({b"scarid": document})
    pq.write_table(table, tmp_path / "log.parquet")
    refused(scarid("info", tmp_path / "log.parquet"), 65, "metadata")


@pytest.mark.parametrize("error", [">&-", "/dev/full"])
def test_the_status_is_that_of_the_failure_when_standard_error_is_closed_or_full(
    error: str, users_shell: Run, tmp_path: Path
) -> None:
    (tmp_path / "bad.csv").write_text("t,q1\n0,1\n")
    words = "2>&-" if error == ">&-" else f"2> {error}"
    assert users_shell(f"scarid filter bad.csv {words}").status == 65
    assert users_shell(f"scarid trajgen --duration 3 {words}").status == 0


def test_a_damaged_state_is_bad_data(scarid: Run, samples: Path, tmp_path: Path) -> None:
    motion, state = tmp_path / "motion.parquet", tmp_path / "state.npz"
    assert scarid("differentiate", samples / "scara2.csv", "-o", motion).status == 0
    result = scarid("identify", motion, "--save", state, "-o", tmp_path / "p.csv")
    assert result.status == 0
    content = state.read_bytes()
    for n in np.random.default_rng(0).integers(0, len(content) - 1, 10):
        state.write_bytes(content[:n])
        refused(scarid("identify", motion, "--from", state), 65, "state.npz")


@pytest.mark.parametrize("rate", ["1e-9", "0.001", "133", "1e7"])
@pytest.mark.parametrize("step", [5e6, 1e-12])
def test_a_clock_in_other_units_is_refused_or_resampled_in_bounded_memory(
    rate: str, step: float, scarid: Run, tmp_path: Path
) -> None:
    """Such as nanoseconds, of which there would be 1e11 rows between two samples."""
    t = 1.7e18 + step * np.arange(100) if step > 1.0 else step * np.arange(100)
    pq.write_table(
        pa.table({"t": t, "q1": np.sin(T[:1] + np.arange(100))}), tmp_path / "log.parquet"
    )
    result = scarid(
        "resample", "-q", "--rate", rate, tmp_path / "log.parquet", "-o", tmp_path / "o.csv"
    )
    assert result.status in (0, 2, 65)
    assert result.err.count("\n") == bool(result.status)


def test_a_decimation_by_more_than_there_are_rows_is_refused(
    scarid: Run, samples: Path, tmp_path: Path
) -> None:
    motion = tmp_path / "motion.parquet"
    assert scarid("differentiate", samples / "scara2.csv", "-o", motion).status == 0
    refused(scarid("identify", motion, "--decimate", 10**9), 65, "1000000000")


def test_a_state_that_is_not_there_is_asked_for(scarid: Run, samples: Path, tmp_path: Path) -> None:
    with pytest.raises(UsageFault, match="no such file; make one with `scarid identify --save`"):
        restored(str(tmp_path / "state.npz"), {}, ESTIMATORS.load("ls")(), load("scara2"))
    motion = tmp_path / "motion.parquet"
    assert scarid("differentiate", samples / "scara2.csv", "-o", motion).status == 0
    refused(scarid("identify", motion, "--from", tmp_path / "state.npz"), 2, "no such file")


def test_a_column_that_may_no_longer_be_empty_is_damage(
    scarid: Run, samples: Path, tmp_path: Path
) -> None:
    """A bit of the footer says so; pyarrow would end the process when it reads its statistics."""
    log = tmp_path / "log.parquet"
    assert scarid("convert", samples / "scara2.csv", "-o", log).status == 0
    content = log.read_bytes()
    place = content.rindex(b"\x25\x02\x18\x08ddq1_ref") + 1  # of the 2, for optional
    log.write_bytes(content[:place] + b"\x00" + content[place + 1 :])
    refused(scarid("convert", log), 65, "column ddq1_ref: its schema is damaged")
