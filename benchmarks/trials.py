"""One change at a time: make it, run the tests that reach it, undo it (benchmarks/mutants.py)."""

from __future__ import annotations

import importlib
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest
from mutations import Mutation

FEW = 2  # tests of one function in the first round: its other cases are likely to agree
PATIENCE = 10.0  # times as long as recorded, and two minutes: then the change makes them hang
LIBRARIES = ("numpy", "pyarrow.csv", "pyarrow.parquet", "scipy.signal", "scipy.optimize")
NOTICED = ("noticed", "hangs", "no import")


@dataclass(frozen=True)
class Outcome:
    """What became of a change: `by` is the test that failed, `tests` how many were run."""

    name: str
    kind: str
    old: str
    new: str
    result: str
    by: str
    tests: int
    seconds: float


class Trials:
    """Runs tests in forks of this process, which has imported what they need of libraries."""

    def __init__(self, tree: Path, taken: dict[str, float], most: float) -> None:
        self._tree = tree
        self._taken = taken
        self._most = most  # s of tests for one change, as they took when they were recorded
        paths = (str(tree), str(tree / "benchmarks"))
        os.environ.update(PYTHONPATH=os.pathsep.join(paths), PYTHONDONTWRITEBYTECODE="1")
        sys.path[:0] = paths
        subprocess.run(
            [sys.executable, "-m", "compileall", "-q", "scarid_cli"], cwd=tree, check=True
        )
        for name in LIBRARIES:
            importlib.import_module(name)

    def outcome(self, name: str, mutation: Mutation, tests: Sequence[str]) -> Outcome:
        """Make the change, run these tests until one fails, and undo the change."""
        path = self._tree / mutation.file
        text = path.read_text("utf-8")
        started = time.monotonic()
        result, by, count = "unreached", "", 0
        for cached in path.parent.glob(f"__pycache__/{path.stem}.*.pyc"):
            cached.unlink()
        try:
            path.write_text(mutation.applied(text), "utf-8")
            for part in self._rounds(tests):
                count += len(part)
                result, by = self._run(part)
                if result != "survived":
                    break
        finally:
            path.write_text(text, "utf-8")
        seconds = time.monotonic() - started
        kind, old, new = mutation.kind, mutation.old, mutation.new
        return Outcome(name, kind, old, new, result, by, count, round(seconds, 1))

    def _rounds(self, tests: Sequence[str]) -> list[list[str]]:
        """First a few cases of each test, then the others, as far as there is time."""
        seen: Counter[str] = Counter()
        first, rest, spent = [], [], 0.0
        for name in tests:
            spent += self._taken[name]
            if spent > self._most and (first or rest):
                break
            seen[function := name.partition("[")[0]] += 1
            (first if seen[function] <= FEW else rest).append(name)
        return [part for part in (first[:60], [*first[60:], *rest]) if part]

    def _run(self, tests: Sequence[str]) -> tuple[str, str]:
        """How these tests end, and the one that failed."""
        limit = 120.0 + PATIENCE * sum(self._taken[name] for name in tests)
        log = self._tree.parent / "log"
        child = os.fork()
        if not child:
            self._child(tests, log)
        status = _waited(child, limit)
        if status is None:
            return "hangs", ""
        lines = log.read_text(errors="replace").splitlines()
        failed = [line for line in lines if line.startswith(("FAILED", "ERROR"))]
        by = failed[0].split(" - ")[0].partition(" ")[2] if failed else ""
        code = os.waitstatus_to_exitcode(status)
        if code == pytest.ExitCode.USAGE_ERROR and not any("ERROR collecting" in x for x in lines):
            raise RuntimeError(f"the tests are not there: {log.read_text()}")
        results = {pytest.ExitCode.OK: "survived", pytest.ExitCode.TESTS_FAILED: "noticed"}
        return results.get(code, "no import"), by

    def _child(self, tests: Sequence[str], log: Path) -> None:
        os.setsid()
        os.chdir(self._tree)
        descriptor = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(descriptor, 1)
        os.dup2(descriptor, 2)
        words = [
            "-q",
            "-x",
            "-n",
            "0",
            "-p",
            "no:cacheprovider",
            "--hypothesis-seed=0",
            "--tb=line",
        ]
        os._exit(int(pytest.main([*words, *tests])))


def _waited(child: int, limit: float) -> int | None:
    """The status with which a process ends; None if it is stopped after so many seconds."""
    end = time.monotonic() + limit
    while time.monotonic() < end:
        found, status = os.waitpid(child, os.WNOHANG)
        if found:
            return status
        time.sleep(0.05)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None
