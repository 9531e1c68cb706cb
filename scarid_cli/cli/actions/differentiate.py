"""Run `scarid differentiate`."""

from __future__ import annotations

from typing import Any

from scarid_cli.cli.job import Job
from scarid_cli.cli.methods import configured
from scarid_cli.io.schemas import joints_of, numbered
from scarid_cli.stages import differentiate as stage


def run(job: Job, *, file: str, match: bool | None, **choice: Any) -> None:
    """Write the motion; the choice is that of a method and its settings, of `configured`."""
    signals = ("q",) if match is False else ("q", "tau")
    table = job.read(file, "measurement", reads=lambda names: numbered(names, *signals))
    methods = configured(joints_of(table.columns, "q"), **choice)
    if match is None:
        match = joints_of(table.columns, "tau") > 0
    estimated = stage.matched if match else stage.differentiate
    job.write(estimated(job.recorded(table), methods, job.left_out))
