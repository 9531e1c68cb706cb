"""A job that was killed goes on after the last log that it finished."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from fleet import Planned, description, made
from steps.journal import Journal
from steps.plan import Log
from workflows.outcomes import WORKFLOW

LOGS = 6


@pytest.fixture
def log(tmp_path: Path) -> Log:
    (tmp_path / "a.csv").write_text("t,q1\n")
    return Log("a", str(tmp_path / "a.csv"), None, 1)


def counted(journal: Journal, log: Log, motion: Path) -> int:
    """How often a step is run that writes a motion, for this log and journal."""
    calls = []

    def step(log: Log) -> dict[str, object]:
        calls.append(log.name)
        motion.write_text(f"motion of {log.name}")
        return {"status": 0}

    assert journal.resumed(log, step, [], [motion]) == {"status": 0}
    assert motion.read_text() == "motion of a"
    return len(calls)


def test_a_step_is_not_run_again_and_its_declared_file_comes_back(log: Log, tmp_path: Path) -> None:
    folder, motion = tmp_path / "journal", tmp_path / "motion"
    assert counted(Journal(folder, ["options"]), log, motion) == 1
    motion.unlink()
    assert counted(Journal(folder, ["options"]), log, motion) == 0
    with (folder / "journal.jsonl").open("a") as file:
        file.write('[["b", 1')  # killed while it wrote
    again = Journal(folder, ["options"])
    assert counted(again, log, motion) == 0
    again.close()
    assert not folder.exists()


def test_what_no_longer_holds_is_done_again(log: Log, tmp_path: Path) -> None:
    folder, motion, settings = tmp_path / "journal", tmp_path / "motion", tmp_path / "settings"
    settings.write_text("10 Hz")
    inputs = ["options", settings]
    assert counted(Journal(folder, inputs), log, motion) == 1
    Path(log.file).write_text("t,q1\n0,1\n")
    assert counted(Journal(folder, inputs), log, motion) == 1
    settings.write_text("11 Hz")
    assert counted(Journal(folder, inputs), log, motion) == 1
    assert counted(Journal(folder, ["other options", settings]), log, motion) == 1
    shutil.rmtree(folder / "0")
    motion.unlink()
    assert counted(Journal(folder, ["other options", settings]), log, motion) == 1


def job(folder: Path, step: str) -> subprocess.Popen[bytes]:
    words = [sys.executable, "-m", "steps", step, "fleet.toml", "arm"]
    words += ["0001"] if step in ("identify", "validate") else []
    environment = {**os.environ, "PYTHONPATH": str(WORKFLOW)}
    return subprocess.Popen(words, cwd=folder, env=environment, start_new_session=True)


def test_a_killed_job_goes_on_and_ends_in_the_same_bytes(tmp_path: Path) -> None:
    for k in range(LOGS):
        made(tmp_path, Planned("robot1", k, k))
    (tmp_path / "robot1.toml").write_text(description("robot1"))
    text = 'group = 9\npages = "none"\n[robots.arm]\nrobot = "robot1.toml"\nlogs = "logs/*/*.csv"\n'
    (tmp_path / "fleet.toml").write_text(text)
    work = tmp_path / "outcome" / "jobs" / "arm"
    for step in ("tune", "identify", "reference", "validate"):
        assert job(tmp_path, step).wait() == 0
    expected = content(tmp_path)
    robot = tmp_path / "outcome" / "robots" / "arm"
    for left in ("trials.parquet", ".settings.toml.x.part", ".compare.parquet.x.part"):
        (robot / left).write_text("half a table of a killed command")
    for step in ("tune", "reference"):
        assert job(tmp_path, step).wait() == 0
    assert content(tmp_path) == expected
    assert not (work / "0001.identify").exists()
    for step, left in (("identify", "motions"), ("validate", "logs")):
        (work / f"0001.{step}.json").unlink()
        finished = killed(job(tmp_path, step), work / f"0001.{step}" / "journal.jsonl")
        shutil.rmtree(work / f"0001.{left}", ignore_errors=True)  # as Snakemake does
        before = times(tmp_path, finished, step)
        assert job(tmp_path, step).wait() == 0
        assert times(tmp_path, finished, step) == before
        assert content(tmp_path) == expected


def killed(process: subprocess.Popen[bytes], journal: Path) -> int:
    """Kill a job after some logs; how many it had finished."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        lines = journal.read_text().count("\n") if journal.exists() else 0
        if lines > 2:
            break
        time.sleep(0.005)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    return journal.read_text().count("\n") - 1


def times(folder: Path, count: int, step: str) -> list[int]:
    """When the tables of the first logs were written [ns]."""
    name = {"identify": "parameters.parquet", "validate": "metrics.parquet"}[step]
    tables = sorted(folder.glob(f"outcome/logs/arm/*/{name}"))
    return [table.stat().st_mtime_ns for table in tables[:count]]


def content(folder: Path) -> dict[str, bytes]:
    paths = (folder / "outcome").rglob("*")
    return {str(p): p.read_bytes() for p in paths if p.is_file() and "locks" not in p.parts}
