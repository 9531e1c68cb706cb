"""What the tests share: the samples, the real logs if they are there, and ways to run scarid."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import hypothesis
import pytest

from scarid_cli.__main__ import main

# Time is measured by benchmarks, not by tests: the machines are shared. The profile that is in
# force, which on CI is one that repeats the same examples, stays otherwise as it is.
hypothesis.settings.register_profile("patient", hypothesis.settings(), deadline=None)
hypothesis.settings.load_profile("patient")

# `make test-all` runs every test to its full size: statistics over many seeds, slow pages.
ALL = os.environ.get("SCARID_TESTS") == "all"
long = pytest.mark.skipif(not ALL, reason="long: make test-all")

ROOT = Path(__file__).parent.parent
SHARED = ROOT.parent / "shared"
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+\.?\d*(?:e[-+]?\d+)?(?![\w.])")


def seeds(few: int, many: int) -> range:
    """The seeds of a statistical test: few of them, or many with `make test-all`.

    Its length serves for examples, rows and seconds as well.
    """
    return range(many if ALL else few)


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


Shell = Callable[..., Result]


BIN = Path(sys.executable).parent  # where the installed scarid is


@pytest.fixture(scope="session")
def warm() -> Iterator[Path]:
    """A folder whose `scarid` needs no imports of its own (tests/warm).

    Where coverage is measured (`make mutants`), the `scarid` of users: what a fork runs is lost.
    """
    if "COVERAGE_PROCESS_START" in os.environ:
        yield BIN
        return
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        client = folder / "scarid"
        text = (ROOT / "tests/warm/client.py").read_text("utf-8")
        client.write_text(f"#!{sys.executable} -IS\n{text}", "utf-8")
        client.chmod(0o755)
        with subprocess.Popen(
            [sys.executable, ROOT / "tests/warm/server.py", folder / "socket"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        ) as server:
            assert server.stdout
            assert server.stdout.readline() == b"ready\n"
            yield folder
            server.communicate()


def shell_in(folder: Path, program: Path) -> Shell:
    """Run shell pipes in a folder; their status is that of the first that failed.

    The `scarid` is the one in the folder `program`.
    """
    path = os.pathsep.join((str(program), str(BIN), os.environ["PATH"]))
    environment = {**os.environ, "PATH": path, "NO_COLOR": "1", "SAMPLES": str(ROOT / "samples")}
    environment.pop("SCARID_FORMAT", None)

    def run(pipe: str, **more: str) -> Result:
        done = subprocess.run(
            ["bash", "-o", "pipefail", "-c", pipe],
            cwd=folder,
            env={**environment, **more},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        return Result(done.returncode, done.stdout, done.stderr)

    return run


@pytest.fixture
def shell(tmp_path: Path, warm: Path) -> Shell:
    """A shell in a directory of its own; its `scarid` forks, with all imports done."""
    return shell_in(tmp_path, warm)


@pytest.fixture
def users_shell(tmp_path: Path) -> Shell:
    """The same with `scarid` as users start it, for tests of the process itself."""
    return shell_in(tmp_path, BIN)
