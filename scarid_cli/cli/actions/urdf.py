"""Run `scarid urdf`."""

from __future__ import annotations

from pathlib import Path

from scarid_cli.algorithms.robots.reading import load
from scarid_cli.cli.job import Job, command_line
from scarid_cli.errors import UsageFault
from scarid_cli.stages import urdf as stage


def run(job: Job, *, robot: str, parameters: str, place: str, base: str | None) -> None:
    """Write the URDF, and report how far the parameters had to move."""
    arm = load(robot)
    if not arm.body:
        raise UsageFault(f"{robot}: has no URDF to put parameters into")
    out = job.text(place)
    side = job.output(base) if base else None
    known = job.read(parameters, "parameters")
    found = stage.physical(known, arm)
    out.write(stage.document(Path(arm.body.path).read_text("utf-8"), arm, found, command_line()))
    if side:
        job.write(job.recorded(stage.base_table(known, arm, found)), side)
    for line in stage.told(arm, found):
        job.say(line)
