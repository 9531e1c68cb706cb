"""Run `scarid listen`."""

from __future__ import annotations

from scarid_cli.cli.job import Job
from scarid_cli.io.listening import Port


def run(job: Job, *, port: int, udp: bool, host: str, columns: str, idle: float | None) -> None:
    """Write the rows that come to the port, and say what was lost."""
    source = Port(host, port, udp=udp, columns=columns, idle=idle)
    job.sources.append(source)
    if not job.quiet:
        job.place.say(f"waits at {source.name}")
    job.write(job.recorded(job.read_source(source)))
    job.say(source.rows.told())
