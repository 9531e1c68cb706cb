"""Run `scarid info`."""

from __future__ import annotations

import json

import click

from scarid_cli.cli.job import Job
from scarid_cli.cli.terminal import wrapped
from scarid_cli.stages.info import described


def run(job: Job, *, file: str, as_json: bool) -> None:
    """Print what the table holds."""
    found = described(job.read(file, None))
    if as_json:
        click.echo(json.dumps(found.document))
        return
    for line in found.lines:
        click.echo(wrapped("", line, 0, hanging=10))
