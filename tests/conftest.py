"""What the tests share: the samples, the real logs if they are there, and ways to run scarid."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import hypothesis
import pytest

from scarid_cli.__main__ import main

# Time is measured by benchmarks, not by tests: the machines are shared. The profile that is in
# force, which on CI is one that repeats the same examples, stays otherwise as it is.
hypothesis.settings.register_profile("patient", hypothesis.settings(), deadline=None)
hypothesis.settings.load_profile("patient")

ROOT = Path(__file__).parent.parent
SHARED = ROOT.parent / "shared"
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+\.?\d*(?:e[-+]?\d+)?(?![\w.])")


@dataclass(frozen=True)
class Result:
    """How a command ended and what it said."""

    status: int
    out: str
    err: str


def refused(result: Result, status: int, *reported: str) -> None:
    """A failure as users see it: its status, one line with these words, and no output."""
    assert result.status == status
    assert result.out == ""
    assert result.err.count("\n") == 1
    for words in reported:
        assert words in result.err


def assert_alike(found: str, expected: str) -> None:
    """Equal texts, but for the last digits of numbers."""
    assert NUMBER.sub("#", found) == NUMBER.sub("#", expected)
    numbers = [float(x) for x in NUMBER.findall(found)]
    assert numbers == pytest.approx([float(x) for x in NUMBER.findall(expected)], 1e-9, 1e-12)


@pytest.fixture
def samples() -> Path:
    return ROOT / "samples"


@pytest.fixture
def real_logs() -> Path:
    if not (SHARED / "data").is_dir():
        pytest.skip("the real robot logs (../shared/data) are not here")
    return SHARED / "data"


@pytest.fixture
def scarid(capfd: pytest.CaptureFixture[str]) -> Callable[..., Result]:
    """Run one command in this process."""

    def run(*words: object) -> Result:
        capfd.readouterr()
        status = main([str(word) for word in words])
        captured = capfd.readouterr()
        return Result(status, captured.out, captured.err)

    return run


@pytest.fixture
def shell(tmp_path: Path) -> Callable[..., Result]:
    """Run a shell pipe in a directory of its own; its status is that of the first that failed."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "NO_COLOR": "1", "SAMPLES": str(ROOT / "samples")}
    environment.pop("SCARID_FORMAT", None)

    def run(pipe: str, **more: str) -> Result:
        done = subprocess.run(
            ["bash", "-o", "pipefail", "-c", pipe],
            cwd=tmp_path,
            env={**environment, **more},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        return Result(done.returncode, done.stdout, done.stderr)

    return run
