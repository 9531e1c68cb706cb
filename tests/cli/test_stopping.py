"""A live pipe that is stopped keeps its result: the first signal ends the input."""

from __future__ import annotations

import contextlib
import os
import random
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from conftest import seeds

from scarid_cli.io.stop import Stop, Terminated

SCARID = str(Path(sys.executable).with_name("scarid"))
SIGNALS = (signal.SIGINT, signal.SIGTERM)
STEP = 0.001  # s between rows of the producer


def start(line: str, source: object, **more: object) -> subprocess.Popen[bytes]:
    """A command with default signals: a run in the background of a script ignores SIGINT."""
    return subprocess.Popen(
        [SCARID, *line.split()],
        stdin=source,  # type: ignore[call-overload]
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        **more,  # type: ignore[arg-type]
    )


@contextmanager
def producing(rows: list[bytes], write: object) -> Iterator[threading.Event]:
    """Rows that are written one by one until the test says stop; the writer does not end."""
    over = threading.Event()

    def produce() -> None:
        try:
            for row in rows:
                if over.wait(STEP):
                    return
                write(row)  # type: ignore[operator]
        except OSError:
            return

    thread = threading.Thread(target=produce)
    thread.start()
    try:
        yield over
    finally:
        over.set()
        thread.join()


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> list[bytes]:
    log = tmp_path_factory.mktemp("log") / "log.csv"
    line = f"{SCARID} trajgen -q --seed 1 | {SCARID} simulate -q -o {log}"
    subprocess.run(line, shell=True, check=True)
    return log.read_bytes().splitlines(keepends=True)


def wait_for_estimates(folder: Path) -> None:
    """Until identify has written rows of its trace, which it does as they come."""
    deadline = time.monotonic() + 60
    while not any(part.stat().st_size > 2000 for part in folder.glob(".trace.csv.*")):
        assert time.monotonic() < deadline
        time.sleep(0.02)


def wait_for_output(folder: Path) -> None:
    """Until the file of an output is open."""
    deadline = time.monotonic() + 60
    while not list(folder.glob(".*")):
        assert time.monotonic() < deadline
        time.sleep(0.01)


@pytest.mark.parametrize("number", SIGNALS)
@pytest.mark.parametrize("form", ["csv", "arrow"])
@pytest.mark.parametrize("seed", seeds(1, 2))
def test_a_pipe_that_is_stopped_at_any_time_keeps_its_result(
    seed: int, form: str, number: int, rows: list[bytes], tmp_path: Path
) -> None:
    """The producer is stopped with the commands, as by Ctrl-C, even in the middle of a row."""
    environment = {**os.environ, "SCARID_FORMAT": form}
    first = start("filter -q --cutoff 40", subprocess.PIPE, env=environment)
    second = start("differentiate -q", first.stdout, env=environment)
    third = start(
        "identify --robot scara2 --trace trace.csv -o p.parquet", second.stdout, cwd=tmp_path
    )
    stages = (first, second, third)
    for stage in stages[:2]:
        stage.stdout.close()
    rng = random.Random(seed)
    with producing(rows, lambda row: (first.stdin.write(row), first.stdin.flush())) as over:
        wait_for_estimates(tmp_path)
        time.sleep(rng.uniform(0.0, 0.4))
        for stage in rng.sample(stages, 3):
            stage.send_signal(number)
        over.set()
    first.stdin.write(rows[7][: rng.randrange(1, 20)])
    first.stdin.close()
    said = third.stderr.read().decode()
    assert [stage.wait(30) for stage in stages] == [0, 0, 0], said
    assert f"{signal.Signals(number).name} ended the input" in said
    assert any(f"identify: {grade}" in said for grade in ("good", "rough", "doubtful")), said
    assert pq.read_table(tmp_path / "p.parquet").num_rows == 8
    for stage in stages:
        stage.stderr.close()
    third.stdout.close()


def test_the_result_is_that_of_the_rows_that_had_arrived(rows: list[bytes], tmp_path: Path) -> None:
    line = (
        "differentiate -q - then tee motion.arrow then "
        "identify -q --robot scara2 --trace trace.csv -o p.parquet"
    )
    run = start(line, subprocess.PIPE, cwd=tmp_path)
    with producing(rows, lambda row: (run.stdin.write(row), run.stdin.flush())) as over:
        wait_for_estimates(tmp_path)
        run.send_signal(signal.SIGTERM)
        over.set()
    run.stdin.close()
    assert run.wait(30) == 0, run.stderr.read()
    again = "identify -q --robot scara2 motion.arrow -o q.parquet"
    subprocess.run([SCARID, *again.split()], cwd=tmp_path, check=True)
    live, later = (pq.read_table(tmp_path / name) for name in ("p.parquet", "q.parquet"))
    assert live.column("estimate").to_pylist() == later.column("estimate").to_pylist()
    run.stderr.close()
    run.stdout.close()


@pytest.mark.parametrize("transport", ["pipe", "fifo", "socket"])
def test_a_writer_that_goes_on_is_left_behind(
    transport: str, rows: list[bytes], tmp_path: Path
) -> None:
    """Neither end of the input nor silence: the signal alone ends it."""
    words = "identify -q --robot scara2 --trace trace.csv -o p.parquet"
    if transport == "socket":
        ours, theirs = socket.socketpair()
        run = start(f"differentiate -q - then {words}", theirs, cwd=tmp_path)
        theirs.close()
        write: object = ours.sendall
    elif transport == "fifo":
        os.mkfifo(tmp_path / "rows")
        run = start(f"differentiate -q rows then {words}", subprocess.DEVNULL, cwd=tmp_path)
        file = (tmp_path / "rows").open("wb", buffering=0)
        write = file.write
    else:
        run = start(f"differentiate -q - then {words}", subprocess.PIPE, cwd=tmp_path, bufsize=0)
        write = run.stdin.write
    with producing(rows, write):
        wait_for_estimates(tmp_path)
        begun = time.monotonic()
        run.send_signal(signal.SIGINT)
        assert run.wait(30) == 0, run.stderr.read()
        assert time.monotonic() - begun < 15.0
    assert (tmp_path / "p.parquet").exists()
    for end in (run.stdin, run.stdout, run.stderr):
        if end:
            end.close()
    if transport == "socket":
        ours.close()
    if transport == "fifo":
        file.close()


def test_a_second_signal_stops_at_once(rows: list[bytes], tmp_path: Path) -> None:
    line = "differentiate - then identify --robot scara2 --trace trace.csv -o p.parquet"
    run = start(line, subprocess.PIPE, cwd=tmp_path)
    with producing(rows, lambda row: (run.stdin.write(row), run.stdin.flush())):
        wait_for_estimates(tmp_path)
        run.send_signal(signal.SIGINT)
        time.sleep(0.2)
        run.send_signal(signal.SIGINT)
        assert run.wait(30) == -signal.SIGINT
    assert list(tmp_path.iterdir()) == []
    with contextlib.suppress(BrokenPipeError):
        run.stdin.close()
    run.stdout.close()
    run.stderr.close()


@pytest.mark.parametrize("number", SIGNALS)
def test_a_run_on_a_file_stops_at_once(number: int, rows: list[bytes], tmp_path: Path) -> None:
    """Half of a file is not what was asked for."""
    log = tmp_path / "log.csv"
    longer = [rows[0], *(row for row in rows[1:] for _ in range(1))]
    log.write_bytes(b"".join(longer))
    run = start("identify --robot scara2 log.csv -o p.parquet", subprocess.DEVNULL, cwd=tmp_path)
    wait_for_output(tmp_path)
    run.send_signal(number)
    assert run.wait(30) == -number
    assert [path.name for path in tmp_path.iterdir()] == ["log.csv"]
    run.stdout.close()
    run.stderr.close()


def test_a_stop_waits_for_the_end_of_what_must_not_be_torn() -> None:
    stop, done = Stop(), []
    with pytest.raises(KeyboardInterrupt), stop.postponed():  # noqa: PT012
        with stop.postponed():
            stop.asked(signal.SIGINT, None)
        done.append("all of the block")
    assert done
    with pytest.raises(Terminated):
        Stop().asked(signal.SIGTERM, None)
