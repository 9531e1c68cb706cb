"""A batch on a Slurm that runs on this machine alone: `make test-slurm`."""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from conftest import ROOT
from fleet import fleet
from slurm.cluster import cluster, missing
from workflows.outcomes import in_one_process, outcome

LOGS, GROUP = 8, 2  # of four robots
SNAKEMAKE = ("snakemake", "snakemake_executor_plugin_slurm")

if absent := [name for name in SNAKEMAKE if not find_spec(name)]:
    pytest.skip(f"no {absent[0]} here; make test-slurm installs it", allow_module_level=True)
if reason := missing():
    pytest.skip(reason, allow_module_level=True)


def test_a_batch_on_slurm_ends_in_the_bytes_of_one_process(tmp_path: Path) -> None:
    config = fleet(tmp_path / "fleet", LOGS, group=GROUP, pages="none")
    (tmp_path / "slurm").mkdir()
    with cluster(tmp_path / "slurm") as found:
        words = [sys.executable, str(ROOT / "workflow" / "batch.py"), str(config)]
        options = ["--profile", "slurm", "--slurm-init-seconds-before-status-checks", "2"]
        options += ["--seconds-between-status-checks", "2", "--latency-wait", "5"]
        done = subprocess.run(
            [*words, *options, "outcome/fleet.parquet"],
            env=found.environment, capture_output=True, text=True, check=False, timeout=900,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr[-3000:]
        jobs = found.finished()
    print(*jobs, sep="\n")  # the accounting log
    assert len(jobs) == 4 * (2 + 2)  # identify and validate a group; tune and reference a robot
    assert all("JobState=COMPLETED" in job for job in jobs)
    by_slurm = outcome(config.parent)
    in_one_process(config)
    assert outcome(config.parent) == by_slurm
