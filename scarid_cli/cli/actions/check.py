"""Run `scarid check`."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import asdict

from scarid_cli.algorithms.checks.finding import FAILED, STATUSES, WARNING, Finding, worst
from scarid_cli.cli.running.job import Job
from scarid_cli.cli.running.terminal import styled, wrapped
from scarid_cli.errors import BAD_DATA, OK, WARNED
from scarid_cli.printable import printable
from scarid_cli.stages import check as stage
from scarid_cli.stages.conversion import mending
from scarid_cli.stages.records.logs import log_of


def run(job: Job, *, file: str, robot: str | None, strict: bool, fix: bool, as_json: bool) -> int:
    """Print the findings; returns the exit status."""
    table, arm = job.read_for(file, "measurement", robot, torques=True, as_recorded=True)
    findings = list(stage.check(log_of(table, len(arm.joints)), arm))
    job.say_notes()
    pipe, left = mending.pipe(findings, file, job.converted_by)
    if fix:
        _print_fix(job, pipe, left)
    elif as_json:
        checks = [asdict(finding) for finding in findings]
        job.show(
            json.dumps(
                {
                    "robot": arm.name,
                    "status": worst(findings),
                    "fix": pipe or None,
                    "checks": checks,
                }
            )
        )
    else:
        _print(job, findings)
        if pipe:
            job.show(f"mend: {pipe}")
    status = worst(left if fix else findings)
    return {FAILED: BAD_DATA, WARNING: WARNED if strict else OK}.get(status, OK)


def _print_fix(job: Job, pipe: str, left: list[Finding]) -> None:
    """The pipe, and on standard error what it leaves."""
    if pipe:
        job.show(pipe)
    for finding in left:
        job.say(f"not mended: {finding.text}")
    if not pipe and not left:
        job.say("nothing to mend")


def _print(job: Job, findings: list[Finding]) -> None:
    """A line for each finding, its advice below it, and the count."""
    width = max(len(finding.name) for finding in findings)
    for finding in findings:
        start = f"{styled(f'{finding.status:<7}', finding.status)}  {finding.name:<{width}}  "
        job.show(wrapped(start, printable(finding.figure), 11 + width))
        if finding.advice:
            advice = printable(f"-> {finding.advice}")
            job.show(wrapped(" " * (11 + width), advice, 14 + width))
    counts = Counter(finding.status for finding in findings)
    job.show(", ".join(f"{counts[status]} {status}" for status in STATUSES))
