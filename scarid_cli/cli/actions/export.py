"""Run `scarid export`."""

from __future__ import annotations

from scarid_cli.cli.command_line import command_line
from scarid_cli.cli.job import Job
from scarid_cli.stages.export import c_header
from scarid_cli.stages.parameters import identified


def run(job: Job, *, parameters: str, robot: str | None, kind: str, name: str, place: str) -> None:
    """Write the code, and say what it lacks of what was identified."""
    out = job.text(place)
    table = job.read(parameters, "parameters")
    found = identified(table, job.robot(robot, table))
    if found.additions:
        job.say("warning: what identify fitted beside the parameters is not in the code")
    assert kind == "c"
    out.write(c_header(found, name, command_line()))
