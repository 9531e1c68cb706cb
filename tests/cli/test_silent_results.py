"""Exit status 0 means the right result: what would be wrong without a word is refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import Result, refused

Run = Callable[..., Result]

N = 400
T = np.arange(N) / 200.0
Q = np.round(1000.0 * np.sin(3.0 * T)).astype(np.int64)


def written(path: Path, columns: dict[str, object]) -> Path:
    """The columns as a file in the format of its extension."""
    table = pa.table(columns)
    if path.suffix == ".parquet":
        pq.write_table(table, path)
    elif path.suffix == ".arrows":
        with pa.ipc.new_stream(path, table.schema) as stream:
            stream.write_table(table)
    else:
        rows = zip(*(np.asarray(column) for column in columns.values()), strict=True)
        lines = [",".join(columns), *(",".join(map(str, row)) for row in rows)]
        path.write_text("".join(f"{line}\n" for line in lines))
    return path


@pytest.mark.parametrize("ending", [".csv", ".parquet", ".arrows"])
@pytest.mark.parametrize(
    "command", ["filter", "differentiate --no-match", "resample --rate 100", "tune"]
)
def test_a_time_that_stands_still_is_refused(
    command: str, ending: str, scarid: Run, tmp_path: Path
) -> None:
    log = written(tmp_path / f"log{ending}", {"t": np.zeros(N), "q1": Q / 1000.0})
    result = scarid(*command.split(), log, "-o", tmp_path / "out.csv")
    refused(result, 65, "column t", "increas")


@pytest.mark.parametrize("ending", [".parquet", ".arrows"])
@pytest.mark.parametrize(
    "command", ["filter", "differentiate", "resample --rate 133", "resample --rate 60", "convert"]
)
def test_whole_numbers_in_columns_with_a_role_are_doubles_in_every_format(
    command: str, ending: str, scarid: Run, tmp_path: Path
) -> None:
    columns: dict[str, object] = {"t": T, "q1": Q, "tau1": Q // 7, "dq1_ref": Q // 3, "dq1": Q}
    if command == "differentiate":
        del columns["dq1"]
    given = scarid(*command.split(), written(tmp_path / f"log{ending}", columns))
    expected = scarid(*command.split(), written(tmp_path / "log.csv", columns))
    assert given.status == expected.status == 0
    assert given.out == expected.out


@pytest.mark.parametrize("values", [Q + 2**60 + 1, (Q % 7).astype(np.uint64) + np.uint64(2**63)])
@pytest.mark.parametrize("column", ["q1", "n"])
def test_a_whole_number_that_a_double_cannot_hold_is_not_rounded(
    column: str, values: object, scarid: Run, tmp_path: Path
) -> None:
    """Nor is one beyond 2^63 changed; a counter below it passes through exactly."""
    columns = {"t": T, "q1": Q / 1000.0, column: values}
    result = scarid("filter", written(tmp_path / "log.parquet", columns), "-o", tmp_path / "o.csv")
    if column == "n" and int(np.asarray(values)[0]) < 2**63:
        assert result.status == 0
        rows = (tmp_path / "o.csv").read_text().splitlines()[1:]
        assert [int(row.split(",")[2]) for row in rows] == np.asarray(values).tolist()
    else:
        refused(result, 65, f"column {column}", "does not fit")


def parquet(scarid: Run, path: Path, n: int) -> Path:
    """A Parquet file of our own writing, of n rows."""
    log = path.with_suffix(".source.parquet")
    t = np.arange(n) / 1000.0
    pq.write_table(pa.table({"t": t, "q1": np.sin(t), "tau1": np.cos(t)}), log)
    assert scarid("convert", log, "-o", path).status == 0
    return path


def test_a_flipped_bit_in_a_parquet_file_of_ours_is_noticed(scarid: Run, tmp_path: Path) -> None:
    """Wherever it is in the pages: their headers, and their content by its checksum."""
    file = parquet(scarid, tmp_path / "log.parquet", 3000)
    content = file.read_bytes()
    expected = scarid("convert", file).out
    footer = int.from_bytes(content[-8:-4], "little") + 8
    rng = np.random.default_rng(0)
    first = pq.ParquetFile(file).metadata.row_group(0).column(0).data_page_offset
    places = [*range(first, first + 24), *rng.integers(4, len(content) - footer, 40).tolist()]
    damaged = tmp_path / "damaged.parquet"
    for place in places:
        bad = bytearray(content)
        bad[place] ^= 1 << int(rng.integers(8))
        damaged.write_bytes(bad)
        result = scarid("convert", damaged, "-o", tmp_path / "out.csv")
        if result.status == 0:  # a part of a header without a meaning, such as a statistic
            assert (tmp_path / "out.csv").read_text() == expected
        else:
            refused(result, 65, "damaged.parquet")


def test_a_parquet_file_with_fewer_rows_than_it_states_is_refused(
    scarid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As when the header of a page has lost a bit, and its row group ends early."""
    file = parquet(scarid, tmp_path / "log.parquet", 70_000)
    batches = pq.ParquetFile.iter_batches
    monkeypatch.setattr(
        pq.ParquetFile,
        "iter_batches",
        lambda self, **given: batches(self, **given, row_groups=[0]),
    )
    result = scarid("convert", file, "-o", tmp_path / "out.csv")
    refused(result, 65, "log.parquet: found 65536 rows, expected 70000")


ABSURD = [
    *(f"simulate {gain} {value}" for gain in ("--kp", "--kd", "--ki") for value in ("nan", "inf")),
    *(f"simulate --{noise}-noise {x}" for noise in ("position", "torque") for x in ("nan", "inf")),
    *(f"simulate --{rate}-rate {x}" for rate in ("log", "control") for x in ("nan", "inf", "0")),
    *(f"simulate --bandwidth {x}" for x in ("nan", "inf", "0")),
    "simulate --control-rate 1e12",
    "simulate --substeps 2147483648",
    *(f"trajgen --{x} 1e12" for x in ("duration", "rate")),
    *(f"trajgen --{x} nan" for x in ("duration", "rate", "approach", "home", "q-max", "dq-max")),
    "trajgen --segment nan nan",
    "trajgen --segment 1e-9 1e-9",
    "trajgen --repeat 1000000000000",
    "trajgen --rate 1e6 --duration 1e5",
    "trajgen --expected e.csv --torque-noise inf",
    "trajgen --optimise --starts 1000000000",
    "trajgen --optimise --budget inf",
    *(f"filter --cutoff {x}" for x in ("nan", "inf", "0", "-1")),
    "filter --natural-frequency nan",
    *(f"filter {x} --cutoff {y}" for x in ("--zero-phase", "-q") for y in ("1e-300", "1e-9")),
    *(f"resample --rate {x}" for x in ("nan", "inf", "0", "1e15")),
    *(f"resample --rate 100 --max-gap {x}" for x in ("nan", "inf")),
    *(f"identify --{x} nan" for x in ("p0", "bandwidth", "smooth-sign", "skip", "decimate")),
    *(f"identify --{x} inf" for x in ("p0", "bandwidth", "smooth-sign", "skip", "drop-slow")),
    *(f"tune --to-time {x}" for x in ("nan", "inf")),
    "differentiate --method algebraic --set window=1e6",
    "differentiate --method savgol --set window=1000001",
    "differentiate --method savgol-end --set window=1e6",
]


@pytest.mark.parametrize("command", ABSURD)
def test_a_number_that_no_command_can_mean_is_refused_in_one_line(
    command: str, scarid: Run, samples: Path, tmp_path: Path
) -> None:
    """Before anything is written; those for which the command would run for hours as well."""
    name, *words = command.split()
    if name != "trajgen":
        words.append(
            str(tmp_path / "reference.csv" if name == "simulate" else samples / "scara2.csv")
        )
    if name == "simulate":
        assert scarid("trajgen", "--duration", 3, "-o", words[-1]).status == 0
    result = scarid(name, *words, "-o", tmp_path / "out.csv")
    refused(result, 2)
    assert not (tmp_path / "out.csv").exists()


EMPTY = [
    "identify --from=",
    "identify --save=",
    "identify --robot=",
    "identify --initial=",
    "filter -o=",
    "filter --columns=",
    "convert --map=",
    "convert --separator=",
    "differentiate --settings=",
    "differentiate --set=",
]


@pytest.mark.parametrize("command", EMPTY)
def test_an_empty_option_value_is_refused(command: str, scarid: Run, samples: Path) -> None:
    """It is that of a shell variable that is not set: --from "$STATE" would start afresh."""
    name, option = command.removesuffix("=").split()
    refused(scarid(name, samples / "scara2.csv", option, ""), 2)
