"""Run `scarid check`."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import asdict

import click

from scarid_cli.algorithms.checks.finding import FAILED, STATUSES, WARNING, Finding, worst
from scarid_cli.cli.job import Job
from scarid_cli.cli.terminal import styled, wrapped
from scarid_cli.errors import BAD_DATA, OK, WARNED
from scarid_cli.printable import printable
from scarid_cli.stages import check as stage
from scarid_cli.stages.logs import log_of


def run(job: Job, *, file: str, robot: str | None, strict: bool, as_json: bool) -> int:
    """Print the findings; returns the exit status."""
    table, arm = job.read_for(file, "measurement", robot, torques=True, as_recorded=True)
    findings = list(stage.check(log_of(table, len(arm.joints)), arm))
    job.say_notes()
    if as_json:
        checks = [asdict(finding) for finding in findings]
        click.echo(json.dumps({"robot": arm.name, "status": worst(findings), "checks": checks}))
    else:
        _print(findings)
    return {FAILED: BAD_DATA, WARNING: WARNED if strict else OK}.get(worst(findings), OK)


def _print(findings: list[Finding]) -> None:
    """A line for each finding, its advice below it, and the count."""
    width = max(len(finding.name) for finding in findings)
    for finding in findings:
        start = f"{styled(f'{finding.status:<7}', finding.status)}  {finding.name:<{width}}  "
        click.echo(wrapped(start, printable(finding.figure), 11 + width))
        if finding.advice:
            advice = printable(f"-> {finding.advice}")
            click.echo(wrapped(" " * (11 + width), advice, 14 + width))
    counts = Counter(finding.status for finding in findings)
    click.echo(", ".join(f"{counts[status]} {status}" for status in STATUSES))
