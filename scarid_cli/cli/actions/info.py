"""Run `scarid info`."""

from __future__ import annotations

import json

from scarid_cli.cli.declaring.options import SELECTION
from scarid_cli.cli.running.command_line import was_given
from scarid_cli.cli.running.job import Job
from scarid_cli.cli.running.terminal import wrapped
from scarid_cli.errors import UsageFault
from scarid_cli.io.bags import bag_extension
from scarid_cli.printable import printable
from scarid_cli.stages.info import described


def run(job: Job, *, file: str, robot: str | None, as_json: bool) -> None:
    """Print what the table or the recording holds."""
    source = job.opened(file)
    extension = bag_extension(file, source)
    if extension is None:
        table = job.as_named(job.read_source(source), robot)
        job.say_notes()
        found = described(job.within(table))
        if as_json:
            job.show(json.dumps(found.document))
            return
        lines = found.lines
    else:
        from scarid_cli.cli.running.recordings import topic_lines  # not needed otherwise

        if as_json or any(map(was_given, SELECTION)):
            what = "--json describes" if as_json else "--from-time, --to-time and --rows are for"
            raise UsageFault(f"{file}: {what} tables, not recordings; leave it out")
        lines = topic_lines(file, source, extension)
    for line in lines:
        job.show(wrapped("", printable(line), 0, hanging=10))
