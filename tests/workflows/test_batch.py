"""A batch by Snakemake, killed and restarted: `make test-batch`."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import pytest
from fleet import fleet
from workflows.outcomes import WORKFLOW, in_one_process, outcome

if not find_spec("snakemake"):
    pytest.skip("no snakemake here; make test-batch installs it", allow_module_level=True)

LOGS, GROUP = 16, 2  # of four robots


def started(config: Path, *options: str) -> subprocess.Popen[bytes]:
    """A batch, whose processes are a group of their own."""
    words = [sys.executable, str(WORKFLOW / "batch.py"), str(config), *options]
    return subprocess.Popen(
        [*words, "outcome/fleet.parquet"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
    )


@pytest.mark.parametrize("kill", [os.killpg, os.kill])
def test_a_batch_that_is_killed_goes_on_and_ends_in_the_same_bytes(
    kill: Callable[[int, int], None], tmp_path: Path
) -> None:
    """Whether its jobs die with Snakemake, or go on for a while."""
    config = fleet(tmp_path / "fleet", LOGS, group=GROUP, pages="none")
    assert in_one_process(config).returncode == 0
    expected = outcome(config.parent)
    subprocess.run(["rm", "-r", str(config.parent / "outcome")], check=True)
    work = config.parent / "outcome" / "jobs"
    for steps in ("identify", "validate"):
        batch = started(config)
        deadline = time.monotonic() + 300
        while len([*work.glob(f"*/*.{steps}.json")]) < 3 and time.monotonic() < deadline:
            time.sleep(0.05)
        kill(batch.pid, signal.SIGKILL)
        batch.communicate()
    assert not (config.parent / "outcome" / "fleet.parquet").exists()
    batch = started(config)
    said, _ = batch.communicate(timeout=600)
    assert batch.returncode == 0, said.decode()[-3000:]
    assert outcome(config.parent) == expected


def test_two_batches_do_not_work_in_one_folder(tmp_path: Path) -> None:
    config = fleet(tmp_path / "fleet", 4, group=1, pages="none")
    first = started(config)
    deadline = time.monotonic() + 60
    while not (config.parent / "outcome" / ".lock").exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    time.sleep(0.5)
    second = started(config)
    said, _ = second.communicate(timeout=60)
    assert b"another batch is at work in outcome" in said
    assert second.returncode == 1
    first.send_signal(signal.SIGINT)
    first.communicate(timeout=60)


def test_a_batch_says_at_once_what_it_does_and_at_last_where_its_page_is(tmp_path: Path) -> None:
    config = fleet(tmp_path / "fleet", 4, group=1, pages="none")
    words = [sys.executable, str(WORKFLOW / "batch.py"), str(config)]
    page = config.parent / "outcome" / "fleet.html"
    done = subprocess.run(words, stderr=subprocess.PIPE, text=True, check=True)
    said = done.stderr.splitlines()
    assert said[0].startswith("batch: 4 logs of 4 robots in 4 groups: check, identify, validate;")
    told = [line for line in said if line.startswith("batch: ")]
    assert told[-1] == f"batch: all is done; the page is {page.resolve()}"
    assert page.exists()
    again = subprocess.run(words, stderr=subprocess.PIPE, text=True, check=True)
    assert f"{page.resolve()}, which is there from before" in again.stderr.splitlines()[0]
