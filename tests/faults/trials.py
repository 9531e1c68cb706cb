"""One command with a fault, in a process of its own that is forked from this one, and its outcome."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

SECONDS = 60  # after which a command counts as one that does not end
MEMORY = 1000.0  # MB
STDOUT = ".out"  # where standard output goes
REFUSED = (2, 3, 65, 74)

RIGHT = "right result"
REFUSAL = "refused in one line"
UNNOTICED = "not noticed by the format"
KILLED = "killed"
# What must not be.
EXIT_1 = "exit 1"
CRASHED = "ended by a signal"
LINES = "refused in several lines"
OTHER = "other content"
ENDLESS = f"over {SECONDS} s"
LARGE = "over 1 GB"
LEFT = "parts left behind"
FORBIDDEN = (EXIT_1, CRASHED, LINES, OTHER, ENDLESS, LARGE, LEFT)


@dataclass(frozen=True)
class Trial:
    """A command line in a folder; `right` judges the folder after exit 0."""

    name: str
    words: tuple[str, ...]
    folder: Path
    right: Callable[[Path], bool] = lambda _: True
    unnoticed: str = OTHER  # what other content is called, of a format that cannot notice it
    before: Callable[[], None] = lambda: None  # in the process of the command


@dataclass(frozen=True)
class Ended:
    """How a command ended: status, or minus the signal; its lines of error; peak memory [MB]."""

    status: int
    error: str
    memory: float


def ended(trial: Trial) -> Ended:
    """Run the command in a fork of this process, which has imported everything already."""
    read, write = os.pipe()  # a file would fall under the limits of a trial
    number = os.fork()
    if not number:
        _child(trial, write)
    os.close(write)
    with open(read, errors="replace") as error:  # noqa: PTH123 (a descriptor)
        text = error.read()
    _, status, usage = os.wait4(number, 0)
    return Ended(os.waitstatus_to_exitcode(status), text, usage.ru_maxrss / 1024.0)


def _child(trial: Trial, error: int) -> None:
    from scarid_cli.__main__ import main

    status = 1
    try:
        os.chdir(trial.folder)
        os.dup2(error, 2)
        for fd, path, flags in ((0, os.devnull, os.O_RDONLY), (1, STDOUT, os.O_CREAT | os.O_WRONLY | os.O_TRUNC)):  # fmt: skip
            os.dup2(os.open(path, flags, 0o600), fd)
        # Those of this process may be kept by pytest.
        sys.stdout, sys.stderr = (os.fdopen(fd, "w", closefd=False) for fd in (1, 2))
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(SECONDS)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        trial.before()
        warnings.simplefilter("ignore")  # as the installed command does
        status = main(list(trial.words))
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(status)


def outcome(trial: Trial) -> str:
    """What became of the trial, in one of the words above."""
    done = ended(trial)
    if done.status < 0:
        return ENDLESS if done.status == -signal.SIGALRM else CRASHED
    if any(path.name.endswith(".part") for path in trial.folder.iterdir()):
        return LEFT
    if done.memory > MEMORY:
        return LARGE
    if done.status in REFUSED:
        return REFUSAL if done.error.count("\n") == 1 else LINES
    if done.status:
        return EXIT_1
    return RIGHT if trial.right(trial.folder) else trial.unnoticed


@dataclass
class Count:
    """How many trials of a class had each outcome; `examples` of those that must not be."""

    name: str
    outcomes: dict[str, int]
    examples: list[str]

    @property
    def tried(self) -> int:
        return sum(self.outcomes.values())

    def add(self, result: str, example: str) -> None:
        self.outcomes[result] = self.outcomes.get(result, 0) + 1
        if result in FORBIDDEN:
            self.examples.append(f"{result}: {example}")


def counted(name: str, trials: Iterator[Trial], seconds: float) -> Count:
    """The outcomes of the trials of a class, as many as there are in so many seconds."""
    count, start = Count(name, {}, []), time.monotonic()
    for trial in trials:
        count.add(outcome(trial), f"{trial.name}: scarid {' '.join(trial.words)}")
        for path in trial.folder.glob("out*"):
            path.unlink()
        if time.monotonic() - start > seconds:
            break
    return count


def folder_of(content: dict[str, bytes]) -> Path:
    """A new folder with these files."""
    folder = Path(tempfile.mkdtemp(prefix="faults-"))
    for name, data in content.items():
        (folder / name).write_bytes(data)
    return folder


def removed(folder: Path) -> None:
    """Remove a folder of `folder_of`."""
    shutil.rmtree(folder, ignore_errors=True)
