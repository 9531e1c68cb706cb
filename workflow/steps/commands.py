"""scarid's commands in this process, and groups of logs in a child of it, which may crash."""

from __future__ import annotations

import contextlib
import io
import json
import os
import shlex
import signal
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from scarid_cli.__main__ import main

T = TypeVar("T")
Result = dict[str, Any]


@dataclass(frozen=True)
class Ran:
    """How a command line ended: its status, what it printed, and what it said."""

    status: int
    out: str
    said: tuple[str, ...]

    @property
    def error(self) -> str:
        """The line of its error, which is the last one."""
        return self.said[-1] if self.said else f"exit status {self.status}"

    @property
    def step(self) -> str:
        """The command that failed, as its error says."""
        words = self.error.partition(":")[0].split()
        return words[1] if len(words) == 2 and words[0] == "scarid" else "batch"


def run(line: str | Sequence[str], messages: list[str]) -> Ran:
    """Run a command line; the messages get it and what it says."""
    words = shlex.split(line) if isinstance(line, str) else list(line)
    out, said = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(said):
        status = main(words)
    ran = Ran(status, out.getvalue(), tuple(said.getvalue().splitlines()))
    messages += [f"$ scarid {shlex.join(words)}", *ran.said]
    return ran


def failure(ran: Ran) -> Result:
    """What the table says of a log at which a command failed."""
    return {"status": ran.status, "step": ran.step, "error": ran.error}


def of_each(step: Callable[[T], Result], logs: Sequence[T]) -> list[Result]:
    """The results of a step for each log.

    A child process does the work. Where it dies, of a crash or for want of memory, the log that it
    was at gets the signal as its error, and another child goes on with the next log.
    """
    results: list[Result] = []
    while len(results) < len(logs):
        found, status = _of_child(step, logs[len(results) :])
        results += found
        if len(results) < len(logs):
            results.append({"status": status, "step": "batch", "error": _death(status)})
    return results


def _of_child(step: Callable[[T], Result], logs: Sequence[T]) -> tuple[list[Result], int]:
    """The results up to the end or to the death of a child process, and its exit status."""
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        os.close(reading)
        _as_child(step, logs, writing)
    os.close(writing)
    with os.fdopen(reading, "r", encoding="utf-8") as lines:
        results = [json.loads(line) for line in lines if line.endswith("\n")]
    _, state = os.waitpid(child, 0)
    code = os.waitstatus_to_exitcode(state)
    return results, code if code >= 0 else 128 - code


def _as_child(step: Callable[[T], Result], logs: Sequence[T], writing: int) -> None:
    try:
        with os.fdopen(writing, "w", encoding="utf-8") as lines:
            for log in logs:
                print(json.dumps(step(log)), file=lines, flush=True)
        os._exit(0)
    except BaseException:
        traceback.print_exc()
        os._exit(1)


def _death(status: int) -> str:
    if status > 128:
        return f"the process was ended by {signal.Signals(status - 128).name} at this log"
    return f"the process ended with status {status} at this log; see the log of the job"
