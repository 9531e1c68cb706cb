"""Run `scarid urdf`."""

from __future__ import annotations

from typing import Any

from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.files import text_of
from scarid_cli.cli.declaring.belonging import the_robot
from scarid_cli.cli.running.command_line import command_line
from scarid_cli.cli.running.job import Job
from scarid_cli.cli.running.treatment import for_motion, for_robot, treatment_of
from scarid_cli.errors import UsageFault
from scarid_cli.stages import urdf as stage
from scarid_cli.stages.results.estimates import estimates_with_covariance


def run(
    job: Job,
    *,
    description: str | None,
    parameters: str,
    robot: str | None,
    place: str,
    base: str | None,
    motion: str | None,
    **given: Any,
) -> None:
    """Write the URDF, and report how far the parameters had to move, and what that costs."""
    treatment = treatment_of(given)
    rows = given["smooth_sign"] or given["all_rows"] or given["bandwidth"]
    if not motion and (treatment != Treatment() or rows):
        raise UsageFault("options for the rows of a motion need --motion FILE")
    stated = the_robot(description, robot)
    out, side = job.text(place), job.side_table(base)
    table = job.read(parameters, "parameters")
    whole = job.robot(stated, table)
    if not whole.body:
        raise UsageFault(f"{whole.name}: has no URDF to write parameters into")
    text = text_of(whole.body.path)
    arm, treatment = for_robot(whole, treatment, given)
    identified = estimates_with_covariance(table, arm)
    log = job.read_for(motion, "motion", whole, torques=True)[0] if motion else None
    for note in identified.model.left_out:
        job.say(f"warning: the URDF has the parameters alone, and lacks: {note}")
    found = stage.physical(identified)
    for line in stage.consistency_report(identified, found):
        job.say(line)
    for line in stage.held_report(arm, found):
        job.say(line)
    if log:
        treatment = for_motion(log.meta, treatment, given)
        r2 = stage.r2_before_and_after(log, identified, found, treatment)
        for line in stage.r2_report(*r2):
            job.say(line)
    out.write(stage.document(text, arm, found, command_line()))
    if side:
        job.write(job.recorded(stage.base_table(table, identified, found)), side)
