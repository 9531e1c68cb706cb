"""`scarid listen`: what is sent to a port, by sockets of Python's own."""

from __future__ import annotations

import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from scarid_cli.io.losses import BLOCK, GAP, Losses, Parts

SCARID = str(Path(sys.executable).with_name("scarid"))
HOST = "127.0.0.1"
HEADER = b"t,q1,tau1\n"


class Listener:
    """A running `scarid listen`, which has said that it waits."""

    def __init__(self, *words: str, udp: bool = False) -> None:
        kind = socket.SOCK_DGRAM if udp else socket.SOCK_STREAM
        with socket.socket(socket.AF_INET, kind) as free:
            free.bind((HOST, 0))
            self.port = free.getsockname()[1]
        self.kind = kind
        self.run = subprocess.Popen(
            [SCARID, "listen", "--port", str(self.port), *(["--udp"] if udp else []), *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )
        assert self.run.stderr
        assert b"waits at" in self.run.stderr.readline()

    def source(self) -> socket.socket:
        """A source that is connected."""
        found = socket.socket(socket.AF_INET, self.kind)
        found.connect((HOST, self.port))
        return found

    def line(self) -> bytes:
        """The next line of the table."""
        assert self.run.stdout
        return self.run.stdout.readline()

    def ended(self) -> tuple[list[bytes], str]:
        """The lines that are left, and what was said."""
        out, err = self.run.communicate(timeout=30)
        return out.splitlines(keepends=True), err.decode()


@contextmanager
def listening(*words: str, udp: bool = False) -> Iterator[Listener]:
    found = Listener(*words, udp=udp)
    try:
        yield found
    finally:
        found.run.kill()
        found.run.communicate()


def rows(times: Iterable[int]) -> list[bytes]:
    """Rows every 4 ms, in binary fractions of which CSV loses nothing."""
    return [f"{k / 256:.10g},0.5,-0.25\n".encode() for k in times]


def test_each_row_is_passed_on_at_once_and_a_signal_ends_the_table() -> None:
    with listening() as listener, listener.source() as source:
        first, *more = rows(range(1, 20))
        source.sendall(HEADER + first)
        assert [listener.line(), listener.line()] == [HEADER, first]
        for row in more:
            source.sendall(row)
            assert listener.line() == row
        listener.run.send_signal(signal.SIGINT)
        said = listener.ended()[1]
        assert listener.run.returncode == 0
        assert "19 rows; none lost, repeated or out of order" in said
        assert "SIGINT ended the input" in said


def test_a_source_that_was_killed_in_the_middle_of_a_row_goes_on() -> None:
    with listening("--idle", "0.5") as listener:
        with listener.source() as source:
            source.sendall(HEADER + b"".join(rows(range(30))) + b"0.1171875,0.")
        with listener.source() as source:
            source.sendall(HEADER + b"".join(rows(range(40, 60))))
        lines, said = listener.ended()
    assert lines == [HEADER, *rows(range(30)), *rows(range(40, 60))]
    assert "50 rows; about 10 lost in 1 gap of t (the longest 0.043 s); 1 cut short" in said


def test_a_gap_begins_a_part_of_the_record_where_it_is_split() -> None:
    with listening("--idle", "0.5", "--split") as listener:
        with listener.source() as source:
            source.sendall(HEADER + b"".join(rows(range(30))))
        with listener.source() as source:
            source.sendall(HEADER + b"".join(rows(range(40, 60))))
        lines, _ = listener.ended()
    parts = [line.strip() + b",%d\n" % (k >= 30) for k, line in
             enumerate([*rows(range(30)), *rows(range(40, 60))])]  # fmt: skip
    assert lines == [b"t,q1,tau1,segment\n", *parts]
    with listening("--idle", "0.5", "--split") as listener:
        with listener.source() as source:
            source.sendall(b"x,q1\n1,2\n")
        _, said = listener.ended()
    assert "expected t, and no segment yet; leave out --split" in said


def test_a_time_that_begins_again_is_counted_on_where_it_is_split() -> None:
    """As of a robot that is started again: the stages that follow take its rows."""
    with listening("--idle", "0.5", "--split") as listener:
        for count in (30, 20, 10):
            with listener.source() as source:
                source.sendall(HEADER + b"".join(rows(range(count))))
        lines, said = listener.ended()
    table = np.loadtxt(lines[1:], delimiter=",")
    assert table[:, -1].tolist() == [0] * 30 + [1] * 20 + [2] * 10
    steps = np.diff(table[:, 0])
    np.testing.assert_allclose(steps[[29, 49]], 1.0, rtol=1e-12)
    np.testing.assert_allclose(np.delete(steps, [29, 49]), steps[0], rtol=1e-6)
    assert "the time began again 2 times and is counted on" in said


@pytest.mark.parametrize("named", [False, True])
def test_lost_late_and_repeated_packets_are_counted(*, named: bool) -> None:
    times = [*range(1, 50), 53, 52, *range(54, 80), 79, *range(80, 100)]  # without 50 and 51
    words = ("--columns", "t,q1,tau1") if named else ()
    with listening("--idle", "0.5", *words, udp=True) as listener, listener.source() as source:
        packets = [*([] if named else [HEADER]), *rows(times), b"1.5,junk\n"]
        for packet in packets:
            source.send(packet)
        lines, said = listener.ended()
    assert lines == [HEADER, *rows(times)]
    found = re.search(
        r"(\d+) rows; about (\d+) lost .*; (\d+) out of .*; (\d+) rep.*; (\d+) cut", said
    )
    assert found, said
    assert [int(x) for x in found.groups()] == [len(times), 2, 1, 1, 1]


def test_a_port_that_is_taken_is_said_in_one_line() -> None:
    with listening() as listener:
        words = [SCARID, "listen", "--port", str(listener.port)]
        second = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (second.returncode, second.stdout) == (74, "")
    assert second.stderr.count("\n") == 1
    assert "another program listens at this port; give another --port" in second.stderr


@pytest.mark.parametrize(
    ("sent", "reason"),
    [
        (b"", "nothing came within 0.2 s"),
        (b"0.0,1.0\n", "numbers in the first line"),
        (HEADER + rows([1])[0] + b"t,q1,q2,tau1,tau2\n", "found a source with the columns t,q1,q2"),
    ],
)
def test_what_is_no_table_is_refused(sent: bytes, reason: str) -> None:
    with listening("--idle", "0.2") as listener:
        with listener.source() as source:
            source.sendall(sent)
        said = listener.ended()[1]
        assert listener.run.returncode == 65
    assert reason in said
    assert said.count("\n") == 1


def test_gaps_are_counted_over_many_rows_whose_clock_jitters() -> None:
    """Steps of 0.9 to 1.1 periods are no gaps; those of 3 periods have lost two rows each."""
    losses, lost = Losses(), 0
    for k in range(3 * BLOCK + 7):
        if k % 100 in (50, 51):
            lost += 1
            continue
        losses.row(1e-3 * (k + 0.05 * (-1) ** k))
    losses.judge()
    assert losses.lost == lost
    assert (losses.out_of_order, losses.repeated, losses.restarts) == (0, 0, 0)


def following(path: Path, *words: str) -> subprocess.Popen[bytes]:
    """A running `scarid listen --follow`, which has said that it waits."""
    run = subprocess.Popen(
        [SCARID, "listen", "--follow", str(path), *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    assert run.stderr
    assert b"waits at" in run.stderr.readline()
    return run


def test_a_growing_file_gives_its_whole_lines_as_they_come(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(HEADER + b"0,1,2\n")
    with following(path) as run:
        assert run.stdout
        assert run.stdout.readline() == HEADER
        assert run.stdout.readline() == b"0,1,2\n"
        with path.open("ab", buffering=0) as file:
            file.write(b"0.01,1,2\n0.02,1.2")
            assert run.stdout.readline() == b"0.01,1,2\n"
            file.write(b"5,2\n0.03,1,")
            assert run.stdout.readline() == b"0.02,1.25,2\n"
        run.send_signal(signal.SIGINT)
        assert run.stdout.read() == b""
        assert run.stderr
        told = run.stderr.read().decode()
        assert run.wait() == 0
    assert "3 rows; none lost, repeated or out of order; 1 cut short or broken, left out" in told


@pytest.mark.parametrize("how", ["cut", "replaced"])
def test_a_file_that_begins_anew_is_read_anew(tmp_path: Path, how: str) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(HEADER + b"5,1,2\n5.01,1,2\n")
    with following(path, "--idle", "0.5") as run:
        assert run.stdout
        for _ in range(3):
            run.stdout.readline()
        if how == "replaced":
            other = tmp_path / "other"
            other.write_bytes(HEADER + b"0,3,4\n")
            other.rename(path)
        else:
            path.write_bytes(HEADER + b"0,3,4\n")
        assert run.stdout.readline() == b"0,3,4\n"
        assert run.stderr
        told = run.stderr.read().decode()
        assert run.wait() == 0
    assert "the time began again 1 time; read anew once" in told


@pytest.mark.parametrize("words", [(), ("--port", "5999", "--follow", "log.csv")])
def test_a_port_or_a_file_is_listened_to(words: tuple[str, ...], tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_bytes(HEADER)
    run = subprocess.run([SCARID, "listen", *words], capture_output=True, cwd=tmp_path, check=False)
    assert run.returncode == 2
    assert b"give --port N or --follow FILE, and not both" in run.stderr


def test_parts_begin_behind_gaps_and_nowhere_else() -> None:
    rng = np.random.default_rng(3)
    steps = 1e-3 * (1.0 + 0.3 * rng.uniform(-1.0, 1.0, 2000))
    gaps = [500, 501, 1700]
    steps[gaps] = 2.0 * GAP * 1e-3
    parts, t = Parts(), np.cumsum(steps)
    numbers = [parts.of(float(x)) for x in t]
    assert numbers == np.cumsum(np.isin(np.arange(2000), gaps)).tolist()
