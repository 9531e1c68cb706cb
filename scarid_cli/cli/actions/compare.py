"""Run `scarid compare`."""

from __future__ import annotations

from scarid_cli.cli.job import Job
from scarid_cli.errors import UsageFault
from scarid_cli.stages.compare import compare


def run(job: Job, *, files: tuple[str, ...]) -> None:
    """Write the differences, and report the verdict."""
    if len(files) < 2:
        raise UsageFault("give at least two parameter tables to compare")
    tables = [job.read(file, "parameters") for file in files]
    table, lines = compare(tables)
    job.write(job.recorded(table))
    for line in lines:
        job.say(line)
