"""What a person sees on a terminal, and a pipe does not."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pyarrow as pa
import pytest

from scarid_cli.cli import progress

SCARID = str(Path(sys.executable).with_name("scarid"))
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
