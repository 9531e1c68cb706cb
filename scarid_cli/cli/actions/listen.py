"""Run `scarid listen`."""

from __future__ import annotations

from scarid_cli.cli.running.job import Job
from scarid_cli.errors import UsageFault
from scarid_cli.io.growing import Growing
from scarid_cli.io.listening import Port


def run(
    job: Job,
    *,
    port: int | None,
    follow: str | None,
    udp: bool,
    host: str,
    columns: str,
    idle: float | None,
    split: bool,
) -> None:
    """Write the rows that come to the port or the file, and say what was lost."""
    if (port is None) == (follow is None):
        raise UsageFault("give --port N or --follow FILE, and not both")
    source: Port | Growing
    if follow is not None:
        source = Growing(follow, columns=columns, idle=idle, split=split)
    else:
        assert port is not None
        source = Port(host, port, udp=udp, columns=columns, idle=idle, split=split)
    job.sources.append(source)
    if not job.quiet:
        job.place.say(f"waits at {source.name}")
    job.write(job.recorded(job.read_source(source)))
    job.say(source.told())
