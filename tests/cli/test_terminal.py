"""What a person sees on a terminal, and a pipe does not."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

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
    assert float(share) == pytest.approx(100.0 * float(error) / float(estimate), rel=0.05)


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
