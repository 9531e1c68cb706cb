"""Run `scarid info`."""

from __future__ import annotations

import click

from scarid_cli.cli.job import Job
from scarid_cli.io.bags import bag_extension
from scarid_cli.stages.info import described


def run(job: Job, *, file: str) -> None:
    """Print what the table or the recording holds."""
    source = job.opened(file)
    extension = bag_extension(file, source)
    if extension is None:
        lines = described(job.read_source(source))
    else:
        from scarid_cli.cli.recordings import topic_lines  # not needed otherwise

        lines = topic_lines(file, source, extension)
    for line in lines:
        click.echo(line)
