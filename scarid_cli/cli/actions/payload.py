"""Run `scarid payload`."""

from __future__ import annotations

from scarid_cli.algorithms.changes.carried import Carrying
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.declaring.belonging import FALSE_ALARMS, needs
from scarid_cli.cli.running.job import Job
from scarid_cli.cli.running.loaded import loaded
from scarid_cli.cli.running.measured import read, searching
from scarid_cli.errors import UsageFault
from scarid_cli.io.table import Table
from scarid_cli.io.writer import Output
from scarid_cli.stages import carried as following
from scarid_cli.stages import payload as stage
from scarid_cli.stages.procedure import blind
from scarid_cli.stages.procedure.blind import Choices, Passed
from scarid_cli.stages.records.corrected import corrected, gains_of
from scarid_cli.stages.results.documents import of_payload
from scarid_cli.stages.results.estimates import estimates_with_covariance


def run(
    job: Job,
    *,
    files: tuple[str, ...],
    parameters: str,
    robot: str | None,
    frame: str | None,
    trace: str | None,
    false_alarms: float | None,
    as_json: bool,
) -> None:
    """Write the table of the payload, and say what hangs there."""
    needs("--trace FILE", trace, {"--false-alarms": false_alarms})
    sink = job.side_table(trace)
    bare = job.read(parameters, "parameters")
    arm = job.robot(robot, bare)
    if sink:
        if as_json:
            raise UsageFault("--json is of one payload; --trace follows several")
        _follow(
            job,
            sink,
            files,
            robot,
            bare,
            arm,
            frame,
            FALSE_ALARMS if false_alarms is None else false_alarms,
        )
        return
    found = loaded(job, files, robot, arm, gains_of(bare))
    hung, link = stage.payload(
        estimates_with_covariance(bare, arm), estimates_with_covariance(found, arm), frame
    )
    lines = list(stage.told(hung, link))
    result = job.recorded(stage.table(hung, found, link))
    job.write_or_print(result, of_payload if as_json else None)
    for line in lines:
        job.say(line)
    if not gains_of(bare):
        job.say(stage.OF_TORQUES)


def _follow(
    job: Job,
    sink: Output,
    files: tuple[str, ...],
    robot: str | None,
    bare: Table,
    arm: Robot,
    frame: str | None,
    rate: float,
) -> None:
    """Tell each payload as it is picked up or put down, and write the table of all of them."""
    if len(files) > 1:
        raise UsageFault("--trace follows one log")
    known = following.Bare.of(estimates_with_covariance(bare, arm), bare, frame)
    log, arm = read(job, files[0] if files else "-", robot or arm.name)
    if gains := gains_of(bare):
        log = corrected(log, gains)
    found = blind.prepared(
        [log], arm, Choices(align=False), progress=searching(job), before=Passed.of([bare])
    )
    carried = following.Carried(known, Carrying(known.none, rate), sink)
    for piece, before, after in carried.over(found.motion, found.chosen.treatment):
        job.say(following.told(piece, before, after))
    job.write(job.recorded(following.pieces(carried, found.motion)))
    for piece in carried.found.pieces:
        job.say(following.summary(piece, carried.of(piece), known.link))
