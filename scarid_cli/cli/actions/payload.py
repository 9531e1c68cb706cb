"""Run `scarid payload`."""

from __future__ import annotations

from scarid_cli.cli.job import Job
from scarid_cli.cli.loaded import loaded
from scarid_cli.stages import payload as stage
from scarid_cli.stages.corrected import gains_of
from scarid_cli.stages.documents import of_payload
from scarid_cli.stages.estimates import estimates_with_covariance


def run(
    job: Job,
    *,
    files: tuple[str, ...],
    parameters: str,
    robot: str | None,
    frame: str | None,
    as_json: bool,
) -> None:
    """Write the table of the payload, and say what hangs there."""
    bare = job.read(parameters, "parameters")
    arm = job.robot(robot, bare)
    found = loaded(job, files, robot, arm, gains_of(bare))
    hung, link = stage.payload(
        estimates_with_covariance(bare, arm), estimates_with_covariance(found, arm), frame
    )
    lines = list(stage.told(hung, link))
    result = job.recorded(stage.table(hung, found, link))
    job.write_or_print(result, of_payload if as_json else None)
    for line in lines:
        job.say(line)
