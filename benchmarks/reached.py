"""Which tests reach which line of scarid_cli: recorded once, for benchmarks/mutants.py.

As a plugin of pytest (`-p reached`, under `coverage run`) this names the test that runs, and notes
which tests pass and how long they take. Commands that a test runs in other processes count too:
they find the name of the test in the environment, where pytest puts it.
"""

from __future__ import annotations

import json
import os
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

SUITES = ("tests/unit", "tests/stages", "tests/cli")
CONFIGURATION = """[run]
data_file = {folder}/coverage
parallel = true
context = ${{PYTEST_CURRENT_TEST-}}
source = {tree}/scarid_cli
omit = */kernels/*
disable_warnings = module-not-measured,no-data-collected
"""


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Count all that happens from here on as reached by this test."""
    import coverage

    if measuring := coverage.Coverage.current():
        measuring.switch_context(item.nodeid)
    return (yield)


class Results:
    """Notes the tests that pass, with the time that they take [s]."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._taken: dict[str, float] = {}
        self._others: set[str] = set()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self._taken[report.nodeid] = self._taken.get(report.nodeid, 0.0) + report.duration
        if report.outcome != "passed":
            self._others.add(report.nodeid)

    def pytest_sessionfinish(self) -> None:
        passed = {name: t for name, t in self._taken.items() if name not in self._others}
        self._path.write_text(json.dumps(passed, indent=0))


def pytest_configure(config: Any) -> None:
    config.pluginmanager.register(Results(Path(os.environ["SCARID_REACHED"])))


@dataclass(frozen=True)
class Reached:
    """The tests that pass, with their times [s], and the tests that reach each line of a file."""

    taken: dict[str, float]
    lines: dict[str, dict[int, set[str]]]

    def by(self, file: str, line: int) -> set[str]:
        """The tests that reach this line."""
        return self.lines.get(file, {}).get(line, set())

    def module(self, file: str) -> set[str]:
        """The tests that reach any line of the module."""
        return set().union(*self.lines.get(file, {}).values())

    def breadth(self) -> dict[str, int]:
        """How many lines each test reaches: those that reach few are likely to notice a change."""
        counts: dict[str, int] = dict.fromkeys(self.taken, 0)
        for lines in self.lines.values():
            for tests in lines.values():
                for name in tests:
                    counts[name] += 1
        return counts


def record(folder: Path, tree: Path) -> None:
    """Run the tests of a tree once, and keep in this folder which lines each of them reaches."""
    configuration = folder / "coverage.ini"
    configuration.write_text(CONFIGURATION.format(folder=folder, tree=tree))
    for old in folder.glob("coverage.*.*"):
        old.unlink()
    environment = {
        **os.environ,
        "COVERAGE_PROCESS_START": str(configuration),
        "PYTHONPATH": os.pathsep.join(map(str, (tree, tree / "benchmarks"))),
        "SCARID_REACHED": str(folder / "passed.json"),
    }
    coverage = [sys.executable, "-m", "coverage"]
    tests = ["-q", "-n", "0", "-p", "reached", "-p", "no:cacheprovider", "--hypothesis-seed=0"]
    run = [*coverage, "run", f"--rcfile={configuration}", "-m", "pytest", *tests, *SUITES]
    subprocess.run(run, cwd=tree, env=environment, check=False)  # what fails is left out
    combine = [*coverage, "combine", "-q", f"--rcfile={configuration}"]
    subprocess.run(combine, cwd=tree, check=True)


def read(folder: Path, tree: Path) -> Reached:
    """What was recorded in this folder, of a tree that is at `tree`."""
    from coverage.numbits import numbits_to_nums

    taken = json.loads((folder / "passed.json").read_text())
    lines: dict[str, dict[int, set[str]]] = {}
    with sqlite3.connect(folder / "coverage") as database:
        rows = database.execute(
            "select path, context, numbits from line_bits"
            " join file on file.id = file_id join context on context.id = context_id"
        )
        for path, context, numbits in rows:
            name = context.rpartition("|")[2].removesuffix(" (setup)").removesuffix(" (call)")
            if name in taken:
                file = lines.setdefault(str(Path(path).relative_to(tree)), {})
                for line in numbits_to_nums(numbits):
                    file.setdefault(line, set()).add(name)
    return Reached(taken, lines)
