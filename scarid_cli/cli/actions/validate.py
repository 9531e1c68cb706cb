"""Run `scarid validate`."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import pyarrow as pa

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.job import Job
from scarid_cli.cli.logs import read_logs
from scarid_cli.cli.treatment import for_motion, for_robot, report, treatment_of
from scarid_cli.errors import UsageFault
from scarid_cli.io.stated import stated_robot
from scarid_cli.io.table import Table
from scarid_cli.stages import validate as stage
from scarid_cli.stages.changes import known
from scarid_cli.stages.estimates import errors_of
from scarid_cli.stages.parameters import identified


def run(
    job: Job,
    *,
    files: tuple[str, ...],
    parameters: str,
    robot: str | None,
    predictions: str | None,
    **given: Any,
) -> None:
    """Write the quality of the predicted torques."""
    treatment = treatment_of(given)
    if treatment.holds and predictions:
        raise UsageFault("--predictions needs every row and cannot be combined with --decimate")
    side = job.side_table(predictions)
    stored = job.read(parameters, "parameters")
    stated = robot or stated_robot(stored)
    table, arm = read_logs(job, files, stated, partial(_read, job), skip=given["skip"])
    arm, treatment = for_robot(arm, treatment, given)
    treatment = for_motion(table.meta, treatment, given)
    batches = list(stored.batches)
    model = identified(replace(stored, batches=iter(batches)), arm)
    before = known(stored, model.robot, errors_of(pa.Table.from_batches(batches)))
    result = stage.validate(
        job.recorded(table),
        model,
        treatment=treatment,
        predictions=side,
        before=before if before.testable else None,
    )
    job.write(result)
    report(job, table, treatment.counting, result.meta.extra.get("left_out", {}))
    if model.delay:
        delay = 1e3 * model.delay
        job.say(f"applied the delay that identify fitted: torques lead by {delay:.3g} ms")
    if before.testable:
        change = result.meta.extra["change"]
        job.say(f"{change['verdict']}: {change['reason']}", change["verdict"])
    if before.remark:
        job.say(before.remark)


def _read(job: Job, file: str, robot: str | Robot | None) -> tuple[Table, Robot]:
    """A motion with torques, and the robot."""
    return job.read_for(file, "motion", robot, torques=True)
