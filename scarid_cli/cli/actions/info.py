"""Run `scarid info`."""

from __future__ import annotations

import click

from scarid_cli.cli.job import Job
from scarid_cli.stages.info import described


def run(job: Job, *, file: str) -> None:
    """Print what the table holds."""
    for line in described(job.read(file, None)):
        click.echo(line)
