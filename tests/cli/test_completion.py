"""The Tab key in real shells: each line is typed at a terminal, and the words that run are read."""

from __future__ import annotations

import os
import pty
import re
import select
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

SHELLS = {
    "bash": ["bash", "--norc", "--noprofile", "-i"],
    "zsh": ["zsh", "-f", "-i"],
    "fish": ["fish", "--no-config", "--interactive"],
}
SET_UP = {
    "bash": 'eval "$(scarid completion bash)"',
    "zsh": 'autoload -U compinit; compinit -D; eval "$(scarid completion zsh)"',
    "fish": "scarid completion fish | source",
}
# What is typed, with the Tab key as ~, and the words that the command then has.
TYPED = {
    "differe~ x": "differentiate x",
    "identify --esti~ gls": "identify --estimator gls",
    "differentiate --method p2~": "differentiate --method p2smd",
    "differentiate --method levant --set bou~8": "differentiate --method levant --set bound=8",
    "differentiate --method astd --preset ta~": "differentiate --method astd --preset table1",
    "simulate --with payl~1": "simulate --with payload=1",
    "robot check em~": "robot check emps",
    "trajgen --robot emps --for of~": "trajgen --robot emps --for offset",
    "trajgen --for Fv1,L1MX~": "trajgen --for Fv1,L1MX2",
    "filter some.csv -c t,torq~": "filter some.csv -c t,torque",
    "filter so~ -q": "filter some.csv -q",
    "filter some.csv then ident~ -q": "filter some.csv then identify -q",
    "help compa~": "help compare",
    "methods super~": "methods super-twisting",
}  # fmt: skip
# The command itself answers the shell, and otherwise only shows its words.
STAND_IN = """#!/bin/sh
case "$_SCARID_COMPLETE$1" in
*_complete*|completion) exec {python} -m scarid_cli "$@" ;;
esac
echo "<$*>"
"""


class Terminal:
    """A shell at a terminal."""

    def __init__(self, command: list[str], folder: Path) -> None:
        keep = {k: v for k, v in os.environ.items() if k.startswith(("LANG", "LC_", "OPENBLAS"))}
        environment = keep | {
            "HOME": str(folder),
            "TERM": "xterm",
            "PATH": f"{folder}:/usr/bin:/bin",
        }
        self._terminal, inner = pty.openpty()
        self._process = subprocess.Popen(
            ["setsid", "--ctty", *command], stdin=inner, stdout=inner, stderr=inner,
            cwd=folder, env=environment,
        )  # fmt: skip
        os.close(inner)

    def type(self, keys: str) -> None:
        os.write(self._terminal, keys.encode())

    def read(self, pattern: str, seconds: float = 20.0) -> str:
        """What the shell prints until a pattern is found, which is returned."""
        text, end = "", time.monotonic() + seconds
        while time.monotonic() < end:
            if select.select([self._terminal], [], [], 0.1)[0]:
                text += os.read(self._terminal, 4096).decode(errors="replace")
                if found := re.search(pattern, text):
                    return found[0]
        pytest.fail(f"no {pattern!r} in {text!r}")

    def close(self) -> None:
        self._process.kill()
        self._process.wait()
        os.close(self._terminal)


@pytest.fixture(scope="module", params=SHELLS)
def terminal(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Terminal]:
    if shutil.which(request.param) is None:
        pytest.skip(f"{request.param} is not installed")
    folder = tmp_path_factory.mktemp(request.param)
    (folder / "some.csv").write_text("t,position,torque\n0,1,2\n", "utf-8")
    stand_in = folder / "scarid"
    stand_in.write_text(STAND_IN.format(python=sys.executable), "utf-8")
    stand_in.chmod(0o755)
    shell = Terminal(SHELLS[request.param], folder)
    try:
        shell.type(f"{SET_UP[request.param]}; scarid ready\r")
        shell.read("<ready>")
        yield shell
    finally:
        shell.close()


@pytest.mark.parametrize(("keys", "words"), TYPED.items())
def test_the_tab_key_completes_a_line(terminal: Terminal, keys: str, words: str) -> None:
    terminal.type("scarid " + keys.replace("~", "\t") + "\r")
    assert " ".join(terminal.read("<[^<>]*>").split()) == f"<{words}>"


@pytest.mark.parametrize("asked", ["bash_complete", "x"])
def test_a_line_that_cannot_be_completed_prints_nothing(asked: str, tmp_path: Path) -> None:
    """It would stand in the line that somebody is typing."""
    (tmp_path / "broken.toml").write_text("[", "utf-8")
    words = "scarid trajgen --robot broken.toml --for "
    environment = os.environ | {"_SCARID_COMPLETE": asked, "COMP_WORDS": words, "COMP_CWORD": "5"}
    done = subprocess.run(
        [sys.executable, "-m", "scarid_cli"],
        env=environment,
        cwd=tmp_path,
        capture_output=True,
        check=True,
    )
    assert done.stdout + done.stderr == b""
