"""Small files that unfold to gigabytes, and files whose reading must not take time beyond measure."""

from __future__ import annotations

import gzip
import math
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from faults.trials import Trial, ended, folder_of, removed

N = 60_000_000
SIZES = (500_000, 2_000_000, 8_000_000)  # bytes
SHORT = 1.0  # s: shorter runs are repeated more often


def zeros(path: Path) -> None:
    """A batch of 1.4 GB."""
    column = pa.array(np.zeros(N))
    write(path, pa.record_batch([column] * 3, ["t", "q1", "tau1"]))


def repeated(path: Path) -> None:
    """One text of a megabyte in each of 20,000 rows."""
    t = np.arange(20_000) / 1000.0
    texts = pa.DictionaryArray.from_arrays(np.zeros(20_000, np.int32), pa.array(["x" * 1_000_000]))
    write(path, pa.record_batch([t, t, texts], ["t", "q1", "text"]))


def write(path: Path, batch: pa.RecordBatch) -> None:
    """The batch, compressed, in the format of the extension."""
    if path.suffix == ".parquet":
        table = pa.Table.from_batches([batch])
        pq.write_table(table, path, compression="zstd", row_group_size=len(table))
        return
    made = pa.ipc.new_file if path.suffix == ".arrow" else pa.ipc.new_stream
    with made(path, batch.schema, options=pa.ipc.IpcWriteOptions(compression="zstd")) as file:
        file.write_batch(batch)


def archive(path: Path) -> None:
    """Two arrays of half a gigabyte."""
    np.savez_compressed(path, t=np.zeros(N), q1=np.zeros(N))


def zipped(row: bytes) -> Callable[[Path], None]:
    """A gigabyte of text after a header."""

    def made(path: Path) -> None:
        with gzip.open(path, "wb", compresslevel=9) as file:
            file.write(b"t,q1\n")
            for _ in range(1000):
                file.write(row * (1_000_000 // len(row)))

    return made


BOMBS = (
    *((zeros, f"log.{ending}") for ending in ("arrows", "arrow", "parquet")),
    *((repeated, f"log.{ending}") for ending in ("arrows", "arrow", "parquet")),
    (archive, "log.npz"),
    *((zipped(row), "log.csv.gz") for row in (b"8", b"\n", b"#\n", b'"', b",")),
)


def bombs() -> Iterator[Trial]:
    """Each bomb through convert, which passes tables on row by row."""
    for made, name in BOMBS:
        folder = folder_of({})
        made(folder / name)
        words = ("convert", name, "-o", "out.csv")
        yield Trial(f"{name} of {(folder / name).stat().st_size:,} bytes", words, folder)
        removed(folder)


def rows(size: int) -> bytes:
    return b"t,q1\n" + b"".join(b"%d.5,1\n" % k for k in range(size // 9))


TEXTS: dict[str, Callable[[int], bytes]] = {
    "rows": rows,
    "a stray quote": lambda size: b't,q1\n0,"1\n' + b"0.1,2.5\n" * (size // 8),
    "quoted texts": lambda size: b"t,q1,a\n" + b'0.1,2.5,"a, b"\n' * (size // 15),
    "a long line": lambda size: b"t,q1\n0," + b"8" * size,
    "wide rows": lambda size: b"\n".join(
        [b",".join(b"c%d" % k for k in range(size // 20))] + [b"1," * (size // 20 - 1) + b"1"] * 2
    ),
    "comments": lambda size: b"#x\n" * (size // 3) + b"t,q1\n0,1\n",
}


def exponents() -> Iterator[tuple[str, list[float], float]]:
    """How the time of reading grows with the size: kinds of text, seconds at SIZES, exponent."""
    for name, made in TEXTS.items():
        times = []
        for size in SIZES:
            folder = folder_of({"log.csv": made(size)})
            trial = Trial(name, ("convert", "log.csv", "-o", "out.arrows"), folder)
            first = _seconds(trial)
            runs = 6 if first < SHORT else 1
            times.append(min(first, *(_seconds(trial) for _ in range(runs))))
            removed(folder)
        base = _seconds_of_nothing()
        own = [max(t - base, 1e-3) for t in times]
        yield name, times, math.log(own[-1] / own[-2]) / math.log(SIZES[-1] / SIZES[-2])


def _seconds(trial: Trial) -> float:
    start = time.perf_counter()
    ended(trial)
    return time.perf_counter() - start


def _seconds_of_nothing() -> float:
    folder = folder_of({"log.csv": b"t,q1\n0,1\n"})
    least = min(
        _seconds(Trial("", ("convert", "log.csv", "-o", "out.arrows"), folder)) for _ in range(3)
    )
    removed(folder)
    return least
