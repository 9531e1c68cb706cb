"""Run `scarid compare`."""

from __future__ import annotations

from scarid_cli.cli.running.job import Job
from scarid_cli.errors import OK, REQUIRED, UsageFault
from scarid_cli.stages.compare import DIFFER, SAME, compare
from scarid_cli.stages.results.documents import comparison, worst


def run(job: Job, *, files: tuple[str, ...], require: str | None, as_json: bool) -> int:
    """Write the differences, and report the verdict; returns the exit status."""
    if len(files) < 2:
        raise UsageFault("give at least two parameter tables to compare")
    tables = [job.read(file, "parameters") for file in files]
    table, lines = compare(tables)
    job.write_or_print(job.recorded(table), comparison if as_json else None)
    for line in lines:
        job.say(line, next((word for word in (SAME, DIFFER) if line.startswith(word)), ""))
    verdict = worst(table.meta.extra["comparisons"])
    if not require or verdict == require:
        return OK
    job.demand(f"the verdict is {verdict}, not {require} as --require asks")
    return REQUIRED
