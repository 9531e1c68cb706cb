"""`scarid watch`: what it shows, and that its parameters are those of `identify`."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import Result

from scarid_cli.algorithms.regression.information import NotIdentifiableError
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array
from scarid_cli.cli.running.board import Board
from scarid_cli.errors import BadData
from scarid_cli.io.table import Table
from scarid_cli.stages.identify import SoFar

Run = Callable[..., Result]
SCARID = str(Path(sys.executable).with_name("scarid"))
ROBOT = load("scara2")
LINE = re.compile(r"scarid watch: t = [\d.]+ s, [\d,]+ rows, \d+ rows/s, the last [\d.]+ s ago, ")


@pytest.fixture
def motion(scarid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    words = ("trajgen", "-q", "--robot", "scara2", "--seed", 1, "--duration", 5)
    chain = (*words, "then", "simulate", "-q", "then", "differentiate", "-q", "-o", "motion.csv")
    assert scarid(*chain).status == 0
    return tmp_path / "motion.csv"


def test_the_parameters_are_those_of_identify(scarid: Run, motion: Path) -> None:
    watched = scarid("watch", motion, "-o", "watched.parquet")
    known = scarid("identify", motion, "-o", "known.parquet")
    assert watched.status == known.status == 0
    assert pq.read_table("watched.parquet").equals(pq.read_table("known.parquet"))
    assert watched.err.splitlines()[-1] == known.err.splitlines()[-1].replace("identify", "watch")


def test_a_verdict_that_is_worse_is_an_exit_status(scarid: Run, motion: Path) -> None:
    short = motion.read_text("utf-8").splitlines(keepends=True)[:400]
    Path("short.csv").write_text("".join(short), encoding="utf-8")
    found = scarid("watch", "-q", "--robot", "scara2", "--require", "good", "short.csv")
    assert found.status in (0, 3)
    known = scarid("identify", "-q", "--robot", "scara2", "--require", "good", "short.csv")
    assert found.status == known.status


def test_a_measurement_is_refused(scarid: Run, samples: Path) -> None:
    found = scarid("watch", "--robot", "scara2", samples / "scara2.csv")
    assert found.status == 2
    assert "let `scarid differentiate` estimate its velocities" in found.err


def started(motion: Path, *words: str, err: int) -> subprocess.Popen[bytes]:
    command = [SCARID, "watch", "--robot", "scara2", "--every", "0.2", "-o", "p.parquet", *words]
    variables = {**os.environ, "TERM": "xterm", "COLUMNS": "100"}
    return subprocess.Popen(
        command, stdin=subprocess.PIPE, stderr=err, env=variables, cwd=motion.parent
    )


def test_lines_are_told_while_rows_come_and_while_none_does(motion: Path) -> None:
    """The age of the last row grows; a signal ends the input, and what has come is kept."""
    with started(motion, err=subprocess.PIPE) as process:
        assert process.stdin
        assert process.stderr
        process.stdin.write(motion.read_bytes())
        process.stdin.flush()
        lines: list[str] = []
        while sum(bool(LINE.match(line)) for line in lines) < 4:
            lines.append(process.stderr.readline().decode())
        process.send_signal(signal.SIGINT)
        process.stdin.close()
        rest = process.stderr.read().decode()
        assert process.wait() == 0
    shown = [line for line in lines if LINE.match(line)]
    ages = [float(re.findall(r"the last ([\d.]+) s", line)[0]) for line in shown]
    assert ages == sorted(ages)
    assert ages[-1] > ages[0]
    assert "ZZ1R 3." in shown[-1]
    assert "scara2, rls, " in rest
    assert (motion.parent / "p.parquet").exists()


def test_a_terminal_is_drawn(motion: Path) -> None:
    main, terminal = os.openpty()
    with started(motion, err=terminal) as process:
        os.close(terminal)
        assert process.stdin
        process.stdin.write(motion.read_bytes())
        process.stdin.flush()
        time.sleep(1.5)
        process.stdin.close()
        parts = []
        while True:
            try:
                data = os.read(main, 1 << 16)
            except OSError:  # Linux reports the end of a terminal as an error
                break
            if not data:
                break
            parts.append(data)
        assert process.wait() == 0
    os.close(main)
    shown = re.sub(r"\x1b\[[\d;?]*[a-zA-Z]", "", b"".join(parts).decode())
    assert "parameter" in shown
    assert re.search(r"ZZ1R +3\.\d+ ", shown)
    assert "rows/s" in shown


class Clock:
    """A clock that tells what it is told."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def batch(*t: float) -> pa.RecordBatch:
    return pa.record_batch({"t": pa.array(t, pa.float64())})


def known(*t: float, table: Callable[[], Table] | None = None) -> SoFar:
    def none() -> Table:
        raise BadData("4 rows, expected more than the 8 parameters")

    def estimates() -> Array:
        return np.arange(8.0)

    return SoFar(batch(*t), estimates, table or none)


def test_rows_are_counted_and_late_ones_are_seen() -> None:
    clock = Clock()
    board = Board(1.0, clock)
    watch = board.watched(ROBOT)
    assert board.line() == "no row yet"
    for k in range(100):
        clock.now = 100.0 + 0.01 * k
        watch(known(0.01 * k))
    assert board.rows == 100
    assert board.rate == pytest.approx(100.0, rel=0.2)
    clock.now += 0.5
    assert board.age == pytest.approx(0.5)
    watch(known(1.0))  # half a second later than the others
    assert 0.4 < board.late < 0.6
    assert "late" in board.state()
    assert board.losses_told() is None
    watch(known(1.5, 1.51))
    board.losses.judge()
    assert "lost in 1 gap" in (board.losses_told() or "")
    clock.now += 10.0
    assert board.rate < 20.0


def test_the_verdict_takes_no_more_than_its_part_of_the_time() -> None:
    """One that takes half a second is renewed after ten at the earliest."""
    clock = Clock()
    board = Board(1.0, clock)
    watch = board.watched(ROBOT)
    asked: list[float] = []

    def slow() -> Table:
        asked.append(clock.now)
        clock.now += 0.5
        raise BadData("not enough")

    for k in range(3000):
        clock.now = max(clock.now, 100.0 + 0.01 * k)
        watch(known(0.01 * k, table=slow))
        board.settled()
    assert len(asked) == 3
    assert min(np.diff(asked)) >= 10.0
    assert board.reason == "not enough"


def test_rows_do_not_wait_for_a_verdict() -> None:
    clock, over = Clock(), threading.Event()
    board = Board(1.0, clock)
    watch = board.watched(ROBOT)

    def endless() -> Table:
        over.wait()
        raise BadData("at last")

    for k in range(300):
        clock.now = 100.0 + 0.01 * k
        watch(known(0.01 * k, table=endless))
    assert board.judging
    assert board.rows == 300
    assert board.reason == "no verdict yet"
    over.set()
    board.settled()
    assert board.reason == "at last"
    assert 100 <= board.asked < 300  # the rows that were there when it began


def test_rows_that_do_not_determine_the_parameters_show_none() -> None:
    board = Board(1.0, Clock())
    watch = board.watched(ROBOT)

    def never() -> Array:
        raise NotIdentifiableError(np.ones(8))

    watch(SoFar(batch(0.0), never, lambda: pytest.fail("no verdict without estimates")))
    assert list(board.values()) == []
    assert board.line().endswith("no verdict yet")
