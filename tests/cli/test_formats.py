"""The same input gives the same bytes: in any format, by path, redirection or pipe, in any cuts."""

from __future__ import annotations

import io
import os
import shlex
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import ALL, ROOT, Result, long
from hypothesis import given, settings
from hypothesis import strategies as st

from scarid_cli.__main__ import main
from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS
from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.csvio import CsvWriter
from scarid_cli.io.reader import open_table
from scarid_cli.io.table import METADATA_KEY, Metadata

Run = Callable[..., Result]
SAMPLE = ROOT / "samples" / "scara2.csv"
FORMATS = {"csv": "csv", "parquet": "parquet", "arrow": "arrows", "arrow-file": "arrow"}
CHAINS = [
    *[f"scarid differentiate --method {name} LOG" for name in DIFFERENTIATORS.names],
    *[
        f"scarid differentiate LOG | scarid identify -q --all-rows --estimator {name}"
        + (" --initial apriori" if ESTIMATORS.load(name).INITIAL else "")
        for name in ESTIMATORS.names
    ],
    "scarid filter LOG",
    "scarid filter --zero-phase LOG",
    "scarid differentiate LOG | scarid validate -q --all-rows --parameters"
    " $SAMPLES/scara2.parameters.csv",
]


# Run as processes too; these spend most of their time on imports
IN_A_SHELL = [
    pytest.param("scarid differentiate LOG", marks=long),
    pytest.param(
        "scarid differentiate LOG | scarid identify -q --all-rows --estimator ls", marks=long
    ),
    pytest.param(CHAINS[-3], marks=long),
    CHAINS[-1],
]


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """The sample in every format."""
    folder = tmp_path_factory.mktemp("logs")
    found = [folder / f"log.{extension}" for extension in FORMATS.values()]
    for name, path in zip(FORMATS, found, strict=True):
        assert main(["convert", "--format", name, str(SAMPLE), "-o", str(path)]) == 0
    return found


@contextmanager
def standard(number: int, file: IO[bytes]) -> Iterator[None]:
    """With the file as standard input (0) or output (1) of this process."""
    kept = os.dup(number)
    os.dup2(file.fileno(), number)
    try:
        yield
    finally:
        os.dup2(kept, number)
        os.close(kept)


def printed(chain: str, log: Path | str, source: IO[bytes]) -> bytes:
    """What a chain prints whose commands run one after the other in this process."""
    first, *others = chain.replace("LOG", str(log)).split(" | ")
    with TemporaryFile() as out:
        with standard(0, source), standard(1, out):
            assert main(shlex.split(first)[1:]) == 0
        out.seek(0)
        return printed(" | ".join(others), "", out) if others else out.read()


@pytest.mark.parametrize("chain", CHAINS)
def test_every_format_and_way_in_gives_the_same_bytes(
    chain: str, logs: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    other = 2 + CHAINS.index(chain) % (len(logs) - 2)  # by turns, as a log in any format is read
    own = logs if ALL else [logs[0], logs[other]]
    chain = chain.replace("$SAMPLES", str(SAMPLE.parent))
    with Path(os.devnull).open("rb") as nothing, logs[1].open("rb") as file:
        found = [printed(chain, log, nothing) for log in own]
        found.append(printed(chain, "", file))
        with subprocess.Popen(["cat", logs[1]], stdout=subprocess.PIPE) as cat:
            assert cat.stdout
            found.append(printed(chain, "", cat.stdout))
        monkeypatch.setenv("SCARID_FORMAT", "arrow")
        found.append(printed(f"{chain} | scarid convert --format csv", logs[0], nothing))
    assert found[0].count(b"\n") >= 3
    assert set(found) == {found[0]}


@pytest.mark.parametrize("chain", IN_A_SHELL)
def test_processes_give_the_same_bytes_too(chain: str, users_shell: Run) -> None:
    formats = FORMATS if ALL else {"csv": "csv", "parquet": "parquet"}
    made = [
        f"scarid convert --format {name} $SAMPLES/scara2.csv -o log.{extension}"
        for name, extension in formats.items()
    ]
    ways = [chain.replace("LOG", f"log.{extension}") for extension in formats.values()]
    ways += [chain.replace("LOG", "< log.parquet")]
    ways += [f"cat log.parquet | {chain.replace('LOG', '')}"]
    ways += [f"export SCARID_FORMAT=arrow; {chain.replace('LOG', 'log.csv')} | scarid convert"
             " --format csv"]  # fmt: skip
    script = " && ".join([*made, *(f"({way}) > {k}.out" for k, way in enumerate(ways))])
    result = users_shell(f"{script} && cat *.out | wc -l && sha256sum *.out | cut -c1-64 | sort -u")
    assert result.status == 0, result.err
    lines, *digests = result.out.splitlines()
    assert int(lines) >= 3 * len(ways)
    assert len(digests) == 1


def test_a_binary_pipe_ends_like_one_of_csv(shell: Run) -> None:
    pipe = (
        "scarid trajgen -q --duration 3 | scarid simulate | scarid filter | scarid differentiate"
        " | scarid identify -q --all-rows"
    )
    binary = shell(f"{pipe} --format csv", SCARID_FORMAT="arrow")
    assert binary.status == 0, binary.err
    assert binary.out == shell(pipe).out


@pytest.mark.parametrize("format_", ["parquet", "arrow-file"])
@pytest.mark.parametrize("size", [1, 7, 8192])
def test_files_have_the_same_bytes_however_their_rows_came(
    format_: str, size: int, scarid: Run, samples: Path, tmp_path: Path
) -> None:
    whole, batched = tmp_path / "whole.arrows", tmp_path / "batched.arrows"
    assert scarid("convert", samples / "scara2.csv", "-o", whole).status == 0
    table = pa.ipc.open_stream(whole.read_bytes()).read_all()
    with pa.ipc.new_stream(batched, table.schema) as writer:
        writer.write_table(table, max_chunksize=size)
    out, expected = (tmp_path / f"{name}.{FORMATS[format_]}" for name in ("out", "expected"))
    assert scarid("filter", "--no-history", whole, "-o", expected).status == 0
    assert scarid("filter", "--no-history", batched, "-o", out).status == 0
    assert out.read_bytes() == expected.read_bytes()


numbers = st.floats(allow_nan=False, allow_infinity=False)


@given(st.lists(numbers, min_size=1, max_size=50))
@settings(max_examples=200, deadline=None)
def test_csv_keeps_every_bit_of_a_number(values: list[float]) -> None:
    schema = pa.schema([("x", pa.float64())])
    text = io.BytesIO()
    writer = CsvWriter(text.write, schema)
    writer.write(pa.RecordBatch.from_arrays([pa.array(values)], schema=schema))
    read = [float(line) for line in text.getvalue().decode().splitlines()[1:]]
    assert np.array(read).tobytes() == np.array(values).tobytes()


@given(st.lists(st.tuples(st.text(st.characters(codec="utf-8", exclude_characters="\0")), numbers)))
@settings(max_examples=100, deadline=None)
def test_csv_keeps_text_with_quotes_commas_and_line_breaks(
    tmp_path_factory: pytest.TempPathFactory, rows: list[tuple[str, float]]
) -> None:
    # An empty text is an empty cell, and a lone carriage return ends a line for CSV readers.
    rows = [(f"a{text}".replace("\r", ""), x) for text, x in rows]
    schema = pa.schema([("parameter", pa.string()), ("estimate", pa.float64())])
    path = tmp_path_factory.mktemp("csv") / "table.csv"
    with path.open("wb") as file:
        writer = CsvWriter(file.write, schema)
        for text, x in rows:
            writer.write(
                pa.RecordBatch.from_arrays([pa.array([text]), pa.array([x])], schema=schema)
            )
    source = ByteSource.open(str(path))
    batches = list(open_table(source).batches)
    source.close()
    assert [(r["parameter"], r["estimate"]) for b in batches for r in b.to_pylist()] == rows


def test_the_header_may_follow_comments_and_a_byte_order_mark(scarid: Run, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text("\ufeffx,y\n1,a\n", "utf-8")
    assert scarid("convert", log).out == "x,y\n1,a\n"
    log.write_text("# rig 7\n# calm day\nx,y\r\n1,a\r\n\r\n2,b")
    assert scarid("convert", log).out == "x,y\n1,a\n2,b\n"


def test_unknown_columns_are_typed_by_their_first_row(scarid: Run, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text("stamp,mode,volt\n1687000000000000001,idle,0\n1687000000000000002,run,0.5\n")
    out = tmp_path / "log.parquet"
    assert scarid("convert", log, "-o", out).status == 0
    table = pq.read_table(out)
    assert table.schema.types == [pa.string(), pa.string(), pa.float64()]
    assert scarid("convert", out).out == log.read_text()


@given(
    robot=st.none() | st.text(),
    period=st.none() | st.floats(1e-6, 1.0),
    command=st.text(),
    extra=st.dictionaries(st.text().map("x-{}".format), st.floats(allow_nan=False)),
)
@settings(deadline=None)
def test_metadata_survive_their_json(
    robot: str | None, period: float | None, command: str, extra: dict[str, float]
) -> None:
    meta = Metadata(
        "motion",
        1,
        robot,
        period,
        ({"command": command, "version": "1", "inputs": {"a": None}},),
        extra,
    )
    assert Metadata.from_json(meta.to_json()) == meta


def test_history_names_every_stage_with_a_digest_and_no_clock(
    shell: Run, tmp_path: Path, samples: Path
) -> None:
    pipe = (
        "scarid filter --format arrow --cutoff 15 $SAMPLES/scara2.csv |"
        " scarid differentiate --method 2smd --set eta0=9,10 --per-joint -o motion.parquet"
    )
    assert shell(pipe).status == 0
    first = (tmp_path / "motion.parquet").read_bytes()
    meta = Metadata.from_json(pq.read_schema(tmp_path / "motion.parquet").metadata[METADATA_KEY])
    log = str(samples / "scara2.csv")
    commands = [entry["command"] for entry in meta.history]
    assert commands == [
        f"scarid filter {log} --cutoff 15.0",
        "scarid differentiate --method 2smd --set eta0=9,10 --per-joint",
    ]
    digest = shell("sha256sum $SAMPLES/scara2.csv | cut -d' ' -f1").out.strip()
    assert [entry["inputs"] for entry in meta.history] == [{log: digest}, {"<stdin>": None}]
    assert shell(pipe).status == 0
    assert (tmp_path / "motion.parquet").read_bytes() == first


def test_no_history_leaves_it_out(scarid: Run, samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "log.parquet"
    assert scarid("filter", "--no-history", samples / "scara2.csv", "-o", out).status == 0
    assert Metadata.from_json(pq.read_schema(out).metadata[METADATA_KEY]).history == ()


def test_the_extension_and_the_environment_choose_the_format(shell: Run, tmp_path: Path) -> None:
    starts = {"a.parquet": b"PAR1", "b.arrow": b"ARROW1", "c.arrows": b"\xff\xff\xff\xff"}
    for name, start in starts.items():
        assert shell(f"scarid convert $SAMPLES/scara2.csv -o {name}").status == 0
        assert (tmp_path / name).read_bytes().startswith(start)
    assert shell("scarid convert $SAMPLES/scara2.csv > d", SCARID_FORMAT="parquet").status == 0
    assert (tmp_path / "d").read_bytes().startswith(b"PAR1")
    assert shell("scarid convert $SAMPLES/scara2.csv", SCARID_FORMAT="json").status == 2


def test_where_side_tables_go_is_not_part_of_the_history(shell: Callable[..., Result]) -> None:
    """The same input gives the same bytes."""
    result = shell(
        "scarid differentiate $SAMPLES/scara2.csv -o m.parquet;"
        " scarid identify -q m.parquet -o a.parquet; scarid identify -q m.parquet --trace t.parquet"
        " --save s.npz -o b.parquet; cmp a.parquet b.parquet"
    )
    assert (result.status, result.out) == (0, "")
