"""Stages in one process: the bytes, the messages and the failures of a pipe."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pytest
from conftest import ROOT, Result, refused, seeds
from hypothesis import given, settings
from hypothesis import strategies as st

from scarid_cli.__main__ import main

Run = Callable[..., Result]
SCARID = Path(sys.executable).parent / "scarid"
LOG = ROOT / "samples" / "scara2.csv"
PARAMETERS = ROOT / "samples" / "scara2.parameters.csv"
FORMATS = ("csv", "parquet", "arrow", "arrow-file")
ON_LOGS = (
    "filter --cutoff 15",
    "filter --zero-phase --columns tau*",
    "filter --no-history",
    "resample --rate 80",
    "convert --unit 'tau1=N mm'",
    "tee beside.parquet",
)
LAST_ON_LOGS = ("tune --robot scara2 --method kalman", "identify --robot scara2", "info")
ON_MOTIONS = (
    "differentiate",
    "differentiate --method spline",
    "differentiate --method p2smd --no-match",
)
LAST_ON_MOTIONS = (
    "identify --robot scara2",
    "identify --estimator wls --align --robot scara2",
    "identify --require good --estimator irls --robot scara2",
    f"validate --parameters {PARAMETERS} --robot scara2",
    "convert",
)


@st.composite
def chains(draw: st.DrawFn) -> list[str]:
    """Stages from a log to a table, or to the description of one."""
    stages = draw(st.lists(st.sampled_from(ON_LOGS), min_size=1, max_size=3))
    last: tuple[str, ...] = LAST_ON_LOGS
    if draw(st.booleans()):
        stages.append(draw(st.sampled_from(ON_MOTIONS)))
        last = LAST_ON_MOTIONS
    return [*stages, draw(st.sampled_from(last))]


def redirected(words: list[str], source: int, sink: Path) -> int:
    """The status of a command with these standard streams."""
    saved = os.dup(0), os.dup(1)
    with sink.open("wb") as output:
        os.dup2(source, 0)
        os.dup2(output.fileno(), 1)
        try:
            return main(words)
        finally:
            for stream, descriptor in enumerate(saved):
                os.dup2(descriptor, stream)
                os.close(descriptor)


def piped(words: list[str], data: bytes, sink: Path) -> int:
    """The status of a command that reads the data from a pipe."""
    reading, writing = os.pipe()

    def feed() -> None:
        with os.fdopen(writing, "wb") as pipe:
            pipe.write(data)

    feeder = threading.Thread(target=feed)
    feeder.start()
    try:
        return redirected(words, reading, sink)
    finally:
        os.close(reading)
        feeder.join()


def format_of(stage: str, wanted: str) -> list[str]:
    return [] if stage == "info" else ["--format", wanted]


def by_a_pipe(stages: list[str], log: Path, wanted: str, folder: Path) -> tuple[int, bytes]:
    """What a pipe of separate commands writes, with Arrow between them."""
    sink = folder / "piped"
    last = len(stages) - 1
    for i, stage in enumerate(stages):
        words = [*shlex.split(stage), *format_of(stage, wanted if i == last else "arrow")]
        if i:
            status = piped(words, sink.read_bytes(), sink.with_suffix(".next"))
            sink.with_suffix(".next").replace(sink)
        else:
            status = redirected([*words[:1], str(log), *words[1:]], 0, sink)
        if i < last and status:  # the later ones would report a table that was cut short
            return status, b""
    return status, sink.read_bytes()


def in_one_process(stages: list[str], log: Path, wanted: str, folder: Path) -> tuple[int, bytes]:
    """What the chain of the same commands writes."""
    words = shlex.split(" then ".join(stages))
    words = [words[0], str(log), *words[1:], *format_of(stages[-1], wanted)]
    status = redirected(words, 0, folder / "chained")
    return status, (folder / "chained").read_bytes()


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The sample in every format."""
    folder = tmp_path_factory.mktemp("logs")
    paths = {
        wanted: folder / f"log{extension}"
        for wanted, extension in zip(
            FORMATS, (".csv", ".parquet", ".arrows", ".arrow"), strict=True
        )
    }
    for path in paths.values():
        assert main(["convert", str(LOG), "-o", str(path), "--no-history"]) == 0
    return paths


@given(stages=chains(), read=st.sampled_from(FORMATS), wanted=st.sampled_from(FORMATS))
@settings(max_examples=len(seeds(12, 25)))
def test_a_chain_writes_the_bytes_of_a_pipe(
    stages: list[str], read: str, wanted: str, logs: dict[str, Path]
) -> None:
    """Status, columns, metadata and history included; the table beside it as well."""
    with tempfile.TemporaryDirectory() as name, pytest.MonkeyPatch.context() as patch:
        folder = Path(name)
        patch.chdir(folder)
        stages = [s for i, s in enumerate(stages) if i == 0 or s not in stages[:i]]
        if stages[0].startswith("tee"):  # it reads no file
            stages.insert(0, "filter")
        status, table = by_a_pipe(stages, logs[read], wanted, folder)
        beside = Path("beside.parquet")
        written = beside.read_bytes() if beside.exists() else None
        beside.unlink(missing_ok=True)
        assert in_one_process(stages, logs[read], wanted, folder) == (status, table)
        assert (beside.read_bytes() if beside.exists() else None) == written


def test_tee_writes_the_table_that_stands_there(scarid: Run, tmp_path: Path) -> None:
    for name in ("motion.csv", "motion.parquet", "motion.arrow", "motion.arrows"):
        alone, between = tmp_path / f"alone.{name}", tmp_path / name
        assert scarid("differentiate", LOG, "-o", alone).status == 0
        result = scarid("differentiate", LOG, "then", "tee", between, "then", "identify", "-q")
        assert result.status == 0
        assert between.read_bytes() == alone.read_bytes()
    assert result.out == scarid("identify", "-q", alone).out


def test_the_history_is_that_of_a_pipe(scarid: Run, tmp_path: Path) -> None:
    chain = "differentiate then filter --columns dq1 then info --json"
    history = scarid("filter", LOG, "then", *chain.split()).out
    assert '"command": "scarid differentiate"' in history
    assert '"inputs": {"<stdin>": null}' in history


def test_metadata_is_kept_although_the_formats_in_between_are_csv(
    scarid: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SCARID_FORMAT", "csv")
    said = scarid("trajgen", "--duration", 3, "then", "simulate", "--format", "csv", "then", "info")
    assert "robot     scara2" in said.out


def test_messages_come_in_the_order_of_the_stages(scarid: Run, tmp_path: Path) -> None:
    """Although the last stage ends first: its verdict remains the last line."""
    rows = [f"{k / 20},{k % 40 / 40},{k % 7}" for k in range(200)]
    log = tmp_path / "log.csv"
    log.write_text("\n".join(["t,q1,tau1", *rows, ""]))
    identify = ["identify", "--robot", "emps", "--estimator", "ls"]
    said = scarid("differentiate", log, "then", *identify).err.splitlines()
    assert "the default settings hardly suit this log" in said[0]
    assert {line.split()[1] for line in said[1:]} == {"identify:"}
    assert "R2" in said[-1]


def test_the_status_is_that_of_the_last_stage_that_has_one(scarid: Run, tmp_path: Path) -> None:
    chain = [
        "identify",
        "--robot",
        "scara2",
        "--estimator",
        "ls",
        "--all-rows",
        "--require",
        "good",
    ]
    motion = ["filter", "--cutoff", 1, LOG, "then", "differentiate", "--method", "central", "then"]
    result = scarid(*motion, *chain)
    assert result.status == 3
    assert result.out.startswith("parameter,")
    assert scarid(*motion, *chain, "-q", "then", "convert").status == 3


@pytest.mark.parametrize("stage", [0, 1, 2])
def test_an_error_is_one_line_that_names_its_stage(stage: int, scarid: Run, tmp_path: Path) -> None:
    stages = [
        "filter log.csv",
        "convert",
        f"differentiate -o {tmp_path}/m.csv",
    ]
    stages[stage] += [" -c q7", " --map q1=nothing", " --settings none.toml"][stage]
    (tmp_path / "log.csv").write_bytes(LOG.read_bytes())
    words = " then ".join(stages).replace("log.csv", str(tmp_path / "log.csv"))
    result = scarid(*words.split())
    refused(result, 2, f"scarid {stages[stage].split()[0]}: ")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["log.csv"]


def test_bad_data_are_reported_by_the_stage_that_read_them(scarid: Run, tmp_path: Path) -> None:
    """A pipe also says of every later stage that its table was cut short."""
    rows = [f"{k / 200},0.1,0.2,1,1" for k in range(50_000)]
    rows[40_000] = "200,nan,0.2,1,1"
    log, beside, output = (tmp_path / name for name in ("log.csv", "f.arrows", "p.parquet"))
    log.write_text("\n".join(["t,q1,q2,tau1,tau2", *rows, ""]))
    chain = f"filter {log} then tee {beside} then differentiate then identify -o {output}"
    refused(scarid(*chain.split()), 65, f"scarid filter: {log}, row 40001, column q1: found nan")
    assert list(tmp_path.iterdir()) == [log]


@pytest.mark.parametrize(
    ("chain", "reported"),
    [
        ("filter LOG then check then identify", "scarid check: writes no table"),
        ("filter LOG then trajgen", "scarid trajgen: reads no table"),
        ("filter LOG then methods", "scarid methods: reads no table"),
        ("filter LOG then differentiate LOG", "scarid differentiate: reads "),
        ("filter LOG -o f.csv then differentiate", "write it with `then tee f.csv`"),
        ("filter LOG then", "a command is missing before or after `then`"),
        ("then filter LOG", "a command is missing before or after `then`"),
        ("filter LOG then then info", "a command is missing before or after `then`"),
        ("filter LOG then differentiat", "did you mean differentiate?"),
        ("filter LOG then differentiate --cutoff 3", "no such option: --cutoff; filter has it"),
        ("identify LOG --robot scara2 --trace - then info", "two outputs cannot share it"),
    ],
)  # fmt: skip
def test_what_cannot_be_joined_is_refused(chain: str, reported: str, scarid: Run) -> None:
    refused(scarid(*chain.replace("LOG", str(LOG)).split()), 2, reported)


def test_other_inputs_than_the_log_come_from_the_chain(scarid: Run, tmp_path: Path) -> None:
    motion = tmp_path / "motion.parquet"
    assert scarid("differentiate", LOG, "-o", motion).status == 0
    identify = ["identify", motion, "-q", "--robot", "scara2", "then"]
    assert scarid(*identify, "report").out.startswith("Verdict")
    assert scarid(*identify, "validate", "-q", motion, "--parameters", "-").status == 0


def test_rows_leave_a_chain_as_they_arrive() -> None:
    lines = LOG.read_bytes().splitlines(keepends=True)
    words = [SCARID, *shlex.split("filter then differentiate then convert")]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0) as chain:
        assert chain.stdin
        assert chain.stdout
        chain.stdin.write(b"".join(lines[:3]))
        received = [chain.stdout.readline() for _ in range(3)]
        assert received[2].startswith(b"0.01,")
        chain.stdin.write(lines[3])
        assert chain.stdout.readline().startswith(b"0.02,")
        chain.stdin.close()


def test_a_reader_that_leaves_ends_the_chain_in_silence() -> None:
    words = [SCARID, *shlex.split("trajgen -q --duration 2000 then convert then tee /dev/null")]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as chain:
        assert chain.stdout
        assert chain.stderr
        chain.stdout.readline()
        chain.stdout.close()
        assert chain.wait(60) == -13  # SIGPIPE
        assert chain.stderr.read() == b""


def test_a_type_that_a_pipe_would_change_is_changed_in_a_chain_too(
    scarid: Run, tmp_path: Path
) -> None:
    """Whole numbers of 32 bits become those of 64 bits where a table is read."""
    import pyarrow.parquet as pq

    log = tmp_path / "log.parquet"
    t = pa.array([k / 100 for k in range(50)])
    pq.write_table(pa.table({"t": t, "q1": t, "n": pa.array(range(50), pa.int32())}), log)
    said = scarid("convert", log, "then", "convert", "then", "info").out
    assert "int64" in said
