"""What a person sees on a terminal, and a pipe does not."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest
from conftest import Result

import scarid_cli
from scarid_cli.cli.running import progress, terminal

SCARID = str(Path(sys.executable).with_name("scarid"))
MAIN = "from scarid_cli.__main__ import run; run()"
COLOUR = re.compile(r"\x1b\[[\d;]*m")


def on_terminal(*words: object, columns: int = 80, **environment: str) -> str:
    """What a command writes to a terminal of this width."""
    main, terminal = os.openpty()
    kept = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "SCARID_FORMAT")}
    variables = {**kept, "TERM": "xterm", "COLUMNS": str(columns), **environment}
    with subprocess.Popen([SCARID, *map(str, words)], stdout=terminal, env=variables) as process:
        os.close(terminal)
        parts = []
        while data := _read(main):
            parts.append(data)
        assert process.wait() == 0
    os.close(main)
    return b"".join(parts).decode().replace("\r\n", "\n")


def _read(descriptor: int) -> bytes:
    try:
        return os.read(descriptor, 1 << 16)
    except OSError:  # Linux reports the end of a terminal as an error
        return b""


@pytest.fixture
def log(samples: Path) -> Path:
    return samples / "scara2.csv"


def test_parameters_are_rounded_to_what_is_known_of_them(log: Path) -> None:
    shown = COLOUR.sub("", on_terminal("identify", "-q", "--robot", "scara2", log))
    headers, row = (
        line.split() for line in shown.splitlines() if line.startswith(("parameter ", "ZZ1R"))
    )
    assert headers == ["parameter", "unit", "estimate", "+-", "%", "low", "high"]
    _, _, _, estimate, error, share, low, high = row
    assert len(estimate.partition(".")[2]) == len(error.partition(".")[2])
    assert len(error.lstrip("0.")) == 2
    assert float(low) < 3.42 < float(high)
    half = 0.5 * 10.0 ** -len(error.partition(".")[2])  # both are rounded
    expected = 100.0 * float(error) / float(estimate)
    assert float(share) == pytest.approx(expected, abs=100.0 * half / float(estimate) + 0.005)


def test_the_raw_table_is_there_for_the_asking(log: Path) -> None:
    words = ("identify", "-q", "--robot", "scara2", log)
    for shown in (on_terminal(*words, "--format", "csv"), on_terminal(*words, SCARID_FORMAT="csv")):
        assert shown.startswith("parameter,unit,estimate,standard_error,")


def test_lines_are_wrapped_to_the_window_and_coloured(log: Path) -> None:
    shown = on_terminal("check", "--robot", "scara2", log, columns=70)
    assert "\x1b[32mok     \x1b[0m  rate" in shown
    assert max(len(line) for line in COLOUR.sub("", shown).splitlines()) <= 70
    described = on_terminal("info", log, columns=70)
    assert max(map(len, described.splitlines())) <= 70


@pytest.mark.parametrize("environment", [{"NO_COLOR": "1"}, {"TERM": "dumb"}])
def test_colours_are_left_out_where_they_are_not_wanted(
    environment: dict[str, str], log: Path
) -> None:
    shown = on_terminal("check", "--robot", "scara2", log, **environment)
    assert "\x1b[3" not in shown


@pytest.mark.parametrize(
    ("length", "part", "shown"),
    [
        (400, None, ["100 rows", " 25 %", "left"]),  # a Parquet file states its rows
        (None, 0.5, ["100 rows", " 50 %", "left"]),  # the part of a file that was read
        (None, None, ["100 rows"]),  # a pipe
    ],
)
def test_progress_has_a_percentage_where_the_length_is_known(
    length: int | None,
    part: float | None,
    shown: list[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")  # takes a pipe for a terminal
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setattr(progress, "SHOWN_AFTER", -1.0)
    batch = pa.RecordBatch.from_pydict({"t": [0.0] * 50})
    for rows, _ in enumerate(progress.counted(iter([batch] * 3), length, lambda: part), start=1):
        if rows == 3:
            time.sleep(0.3)  # it is drawn ten times a second
    text = COLOUR.sub("", capsys.readouterr().err)
    assert all(words in text for words in shown)
    assert ("%" in text) == (length is not None or part is not None)


@pytest.mark.parametrize(
    ("known", "shown"),
    [({"total": 4}, "0:00:01 left"), ({"within": 9.0}, "0:00:0[78] left"), ({}, "2 starts")],
)
def test_steps_tell_the_remaining_time_where_it_is_known(
    known: dict[str, Any],
    shown: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    clock = iter([0.0, 0.5, 1.0])
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(clock, 1.0))
    with progress.steps(quiet=False, of="starts", **known) as step:
        step()
        step()
    text = COLOUR.sub("", capsys.readouterr().err)
    assert re.search(shown, text)
    assert ("left" in text) == bool(known)


def test_remarks_are_wrapped_to_the_window_and_commands_stay_whole(log: Path) -> None:
    main, terminal = os.openpty()
    variables = {**os.environ, "TERM": "xterm", "COLUMNS": "70", "NO_COLOR": "1"}
    words = [SCARID, "identify", "--robot", "scara2", str(log)]
    with subprocess.Popen(
        words, stdout=subprocess.DEVNULL, stderr=terminal, env=variables
    ) as process:
        os.close(terminal)
        parts = []
        while data := _read(main):
            parts.append(data)
        assert process.wait() == 0
    os.close(main)
    text = b"".join(parts).decode().replace("\r\n", "\n")
    lines = re.sub(r"\r[^\n]*\x1b\[2K|\x1b\[\?25[hl]", "", text).splitlines()
    long = [line for line in lines if len(line) > 70]
    assert len(long) == 1
    assert long[0].startswith("  scarid differentiate ")
    assert any(line == "scarid identify: the same as:" for line in lines)


def test_a_word_is_never_broken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(terminal, "is_terminal", lambda _=1: True)
    monkeypatch.setenv("COLUMNS", "40")
    text = "scarid check: write -o FILE.parquet, or --missing=drop-all-rows-of-this-very-long-name"
    shown = terminal.told(text)
    assert shown.split() == text.split()
    assert "\n" in shown


def without_kernels(folder: Path) -> Path:
    """A copy of the package without its compiled kernels."""
    package = Path(scarid_cli.__file__).parent
    leave = shutil.ignore_patterns("*.so", "__pycache__")
    shutil.copytree(package, folder / "scarid_cli", ignore=leave)
    shutil.copytree(package.parent / "schemas", folder / "scarid_cli" / "schemas")
    return folder


def test_without_compiled_kernels_each_line_of_stages_says_once_that_it_is_slow(
    tmp_path: Path, log: Path
) -> None:
    where = without_kernels(tmp_path)
    head = tmp_path / "head.csv"
    head.write_text("".join(log.read_text().splitlines(keepends=True)[:50]))

    def errors(*words: object) -> str:
        return subprocess.run(
            [sys.executable, "-c", MAIN, *map(str, words)],
            cwd=where, capture_output=True, text=True, check=True,
        ).stderr  # fmt: skip

    said = errors("filter", head, "then", "differentiate", "-o", tmp_path / "motion.csv")
    assert said.count("this run is slow: the kernels are not compiled") == 1
    assert errors("filter", "-q", head) == ""
    for quick in (("info", head), ("convert", head)):
        assert "slow" not in errors(*quick)


def test_with_compiled_kernels_nothing_is_said(scarid: Callable[..., Result], log: Path) -> None:
    assert "slow" not in scarid("filter", log).err
