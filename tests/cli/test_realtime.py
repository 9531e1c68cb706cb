"""`simulate --realtime`: the same rows, each at its time."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

SCARID = str(Path(sys.executable).with_name("scarid"))


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("realtime") / "reference.parquet"
    words = ["trajgen", "-q", "--seed", "1", "--duration", "2", "-o", str(path)]
    subprocess.run([SCARID, *words], check=True)
    return path


def started(*words: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [SCARID, "simulate", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


@pytest.mark.parametrize(
    "more", [(), ("--with", "sampling-jitter=0.0005", "--with", "lost-rows=0.05")]
)
def test_rows_are_the_same_and_none_comes_before_its_time(
    reference: Path, more: tuple[str, ...]
) -> None:
    words = [*more, str(reference)]
    at_once = subprocess.run([SCARID, "simulate", *words], capture_output=True, check=True).stdout
    with started("--realtime", *words) as run:
        assert run.stdout
        header, first = run.stdout.readline(), run.stdout.readline()
        start, lines, early = time.monotonic(), [header, first], []
        t0 = float(first.split(b",")[0])
        for line in run.stdout:
            lines.append(line)
            early.append(float(line.split(b",")[0]) - t0 - (time.monotonic() - start))
        assert run.wait() == 0
    assert b"".join(lines) == at_once
    assert len(lines) > 350
    # The first row is read a little after it is written: on this clock, others seem as early.
    assert sorted(early)[len(early) // 2] < 0.05
    assert time.monotonic() - start > 1.8


def test_a_signal_ends_the_log_which_is_whole(reference: Path) -> None:
    with started("--realtime", str(reference)) as run:
        assert run.stdout
        assert run.stderr
        head = [run.stdout.readline() for _ in range(20)]
        run.send_signal(signal.SIGINT)
        rest = run.stdout.read().splitlines()
        assert run.wait() == 0
        assert b"SIGINT ended the input" in run.stderr.read()
    assert all(line.count(b",") == head[0].count(b",") for line in rest)
    assert len(rest) < 200


def test_a_run_that_is_too_slow_says_by_how_much(reference: Path) -> None:
    words = ("--realtime", "--control-rate", "10000", "--substeps", "150", str(reference))
    with started(*words) as run:
        assert run.stderr
        said = run.communicate()[1].decode()
    assert "warning: too slow for real time: the last row came" in said
