"""Commands as processes: exit status, signals, standard streams, failure down the pipe."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import Result

Shell = Callable[..., Result]
SCARID = Path(sys.executable).parent / "scarid"


def test_the_readme_pipe_prints_eight_parameters(users_shell: Shell) -> None:
    result = users_shell(
        "scarid trajgen --robot scara2 --seed 1 | scarid simulate | scarid filter |"
        " scarid differentiate --method p2smd | scarid identify | column -s, -t"
    )
    assert result.status == 0
    lines = result.out.splitlines()
    assert [line.split()[0] for line in lines[1:]] == [
        "ZZ1R", "Fv1", "Fs1", "ZZ2", "L1MX2", "L1MY2", "Fv2", "Fs2",
    ]  # fmt: skip


def test_a_reader_that_leaves_ends_the_writer_in_silence(users_shell: Shell) -> None:
    result = users_shell("scarid trajgen -q --duration 2000 | head -1; echo ${PIPESTATUS[0]}")
    assert result.out.splitlines()[1] == "141"
    assert result.err == ""


@pytest.mark.parametrize("command", ["trajgen", "trajgen --help", "--version"])
def test_a_full_disk_is_one_line_and_74(command: str, users_shell: Shell) -> None:
    result = users_shell(f"scarid {command} > /dev/full")
    assert result.status == 74
    assert result.err.count("\n") == 1
    assert "No space left on device" in result.err


@pytest.mark.parametrize("command", ["trajgen", "--version"])
def test_a_closed_standard_output_is_74(command: str, users_shell: Shell) -> None:
    result = users_shell(f"scarid {command} >&-")
    assert result.status == 74
    assert result.err.count("\n") == 1


def test_a_closed_standard_output_does_not_matter_with_an_output_file(users_shell: Shell) -> None:
    assert users_shell("scarid trajgen -q --duration 2 -o t.csv >&- && test -s t.csv").status == 0


def test_a_directory_that_is_not_there_is_74(users_shell: Shell) -> None:
    result = users_shell("scarid trajgen -o nowhere/t.csv")
    assert result.status == 74
    assert result.err.count("\n") == 1


def test_standard_input_cannot_be_two_tables(users_shell: Shell) -> None:
    result = users_shell("scarid validate --parameters - < $SAMPLES/scara2.parameters.csv")
    assert result.status == 2
    assert "standard input can be read only once" in result.err


def test_devices_are_written_directly(users_shell: Shell) -> None:
    assert users_shell("scarid trajgen -o /dev/null && test -c /dev/null").status == 0
    assert users_shell("scarid trajgen -o /dev/full").status == 74


def test_a_bad_row_stops_every_later_stage_of_a_csv_pipe(
    users_shell: Shell, tmp_path: Path
) -> None:
    rows = [f"{k / 200},0.1,0.2,1,1" for k in range(100_000)]
    rows[90_000] = "200,nan,0.2,1,1"
    (tmp_path / "log.csv").write_text("\n".join(["t,q1,q2,tau1,tau2", *rows, ""]))
    result = users_shell(
        "scarid filter log.csv | scarid differentiate | scarid identify -o parameters.csv;"
        " echo ${PIPESTATUS[@]}"
    )
    assert result.out == "65 65 65\n"
    assert "row 90001, column q1: found nan" in result.err
    assert result.err.count("cut short") == 2
    assert not (tmp_path / "parameters.csv").exists()


def test_a_stage_killed_in_a_binary_pipe_fails_every_later_one(
    tmp_path: Path, samples: Path
) -> None:
    """The killed stage has sent whole batches, so its stream is cut where pyarrow sees no harm."""
    environment = {**os.environ, "SCARID_FORMAT": "arrow"}
    lines = (samples / "scara2.csv").read_bytes().splitlines(keepends=True)

    def stage(*words: str, source: object) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [SCARID, *words],
            stdin=source,  # type: ignore[call-overload]
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment,
        )

    filtering = stage("filter", source=subprocess.PIPE)
    differentiating = stage("differentiate", source=filtering.stdout)
    output = tmp_path / "parameters.parquet"
    identifying = stage("identify", "-o", str(output), source=differentiating.stdout)
    for process in (filtering, differentiating, identifying):
        process.stdout.close()
    filtering.stdin.write(b"".join(lines[:200]))
    filtering.stdin.flush()
    deadline = time.monotonic() + 30
    while not list(tmp_path.glob(".parameters*")) and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(0.5)  # let the first batches travel down
    filtering.kill()
    assert filtering.wait(30) == -signal.SIGKILL
    assert differentiating.wait(30) == 65
    assert identifying.wait(30) == 65
    assert b"cut short" in identifying.stderr.read()
    assert list(tmp_path.iterdir()) == []
    for process in (filtering, differentiating, identifying):
        process.stderr.close()
    filtering.stdin.close()


def test_rows_leave_as_they_arrive(samples: Path) -> None:
    """A live log: every stage passes on what has come, and waits for no block to fill."""
    lines = (samples / "scara2.csv").read_bytes().splitlines(keepends=True)
    first = subprocess.Popen(
        [SCARID, "filter"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0
    )
    second = subprocess.Popen(
        [SCARID, "differentiate"], stdin=first.stdout, stdout=subprocess.PIPE, bufsize=0
    )
    with first, second:
        first.stdin.write(b"".join(lines[:3]))
        received = [second.stdout.readline() for _ in range(3)]
        assert received[0].startswith(b"t,q1,q2,")
        assert received[2].startswith(b"0.01,")
        first.stdin.write(lines[3])
        assert second.stdout.readline().startswith(b"0.02,")
        first.stdin.close()
        first.stdout.close()
        assert second.stdout.read() == b""


def test_sigterm_leaves_nothing_behind(tmp_path: Path) -> None:
    output = tmp_path / "out.parquet"
    process = subprocess.Popen([SCARID, "filter", "-o", output], stdin=subprocess.PIPE)
    with process:
        deadline = time.monotonic() + 30
        while not list(tmp_path.iterdir()) and time.monotonic() < deadline:
            time.sleep(0.02)
        assert list(tmp_path.iterdir())
        process.send_signal(signal.SIGTERM)
        assert process.wait(30) == -signal.SIGTERM
    assert list(tmp_path.iterdir()) == []


def test_binary_is_not_written_to_a_terminal() -> None:
    main, terminal = os.openpty()
    try:
        done = subprocess.run(
            [SCARID, "trajgen", "--format", "arrow"],
            stdout=terminal, stderr=subprocess.PIPE, text=True, check=False,
        )  # fmt: skip
    finally:
        os.close(terminal)
        os.close(main)
    assert done.returncode == 2
    assert "arrow is binary and the output is a terminal" in done.stderr
