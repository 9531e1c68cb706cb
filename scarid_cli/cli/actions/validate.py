"""Run `scarid validate`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import pyarrow as pa

from scarid_cli.algorithms.checks.finding import FAILED, TORQUES
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.declaring.belonging import FALSE_ALARMS, needs
from scarid_cli.cli.running.job import Job
from scarid_cli.cli.running.logs import read_logs
from scarid_cli.cli.running.measured import read, searching, tell_of
from scarid_cli.cli.running.treatment import (
    behind_low_pass,
    for_robot,
    lead,
    report,
    treatment_of,
)
from scarid_cli.errors import OK, REQUIRED, UsageFault
from scarid_cli.io.stated import stated_robot
from scarid_cli.io.table import Table
from scarid_cli.stages import validate as stage
from scarid_cli.stages.procedure import blind
from scarid_cli.stages.procedure.blind import Choices, Passed
from scarid_cli.stages.records.corrected import corrected, gains_of, told_gains
from scarid_cli.stages.remarks.reach import Reach
from scarid_cli.stages.residual import Residuals, band_of
from scarid_cli.stages.results.changes import Known, known
from scarid_cli.stages.results.documents import validation
from scarid_cli.stages.results.estimates import errors_of
from scarid_cli.stages.results.parameters import Identified, apriori, identified
from scarid_cli.stages.results.pooling import Entry, pooled_identifications
from scarid_cli.stages.rollout import Rollouts
from scarid_cli.stages.validate import Beside

APRIORI = "apriori"  # a word for the values of the description


def run(
    job: Job,
    *,
    files: tuple[str, ...],
    parameters: tuple[str, ...],
    robot: str | None,
    predictions: str | None,
    residual: str | None,
    false_alarms: float | None,
    observer: float | None,
    rollout: float | None,
    require: str | None,
    as_json: bool,
    **given: Any,
) -> int:
    """Write the quality of the predicted torques; returns the exit status."""
    treatment = treatment_of(given)
    _require_rows(treatment, predictions=predictions, residual=residual)
    needs("--residual FILE", residual, {"--observer": observer, "--false-alarms": false_alarms})
    side, contacts = job.side_table(predictions), job.side_table(residual)
    tables = [job.read(file, "parameters") for file in parameters if file != APRIORI]
    stated = robot or (stated_robot(tables[0]) if tables else None)
    logs, arm = read_logs(job, files, stated, partial(read, job), skip=given["skip"])
    tables += [_described(arm) for _ in range(parameters.count(APRIORI))]
    arm, treatment = for_robot(arm, treatment, given)
    gains = _gains(tables)
    if gains:
        logs = [corrected(log, gains) for log in logs]
    choices = Choices(
        align=False, treatment=treatment, bandwidth=given["bandwidth"], all_rows=given["all_rows"]
    )
    passed = Passed.of(tables)
    prepared = blind.prepared(logs, arm, choices, progress=searching(job), before=passed)
    tell_of(job, prepared, logs, [])
    table, treatment = prepared.motion, prepared.chosen.treatment
    model, before = pooled_identifications([_stored(table, arm) for table in tables])
    reach = Reach(len(arm.joints))
    beside: list[Beside] = [Rollouts(rollout)] if rollout else []
    if contacts:
        rate = FALSE_ALARMS if false_alarms is None else false_alarms
        band = band_of(tables, before, model.robot, rate)
        beside.append(Residuals(band, model.robot, contacts, rate, observer))
    result = stage.validate(
        job.recorded(reach.watched(table)),
        model,
        treatment=treatment,
        predictions=side,
        beside=beside,
        before=before if before.testable else None,
        failed=lambda predicted: _failed(reach, arm, table, predicted=predicted),
    )
    job.write_or_print(result, validation if as_json else None)
    report(job, table, treatment.counting, result.meta.extra.get("left_out", {}))
    if len(tables) > 1:
        job.say(f"pooled the parameters of {len(tables)} identifications, by their information")
    if gains:
        job.say(f"torques are divided by the gains of the identification: {told_gains(gains)}")
    if not before.testable:
        for text in _failed(reach, arm, table, predicted=False):
            job.say(f"warning: {text}")
    _tell(job, model, before, result.meta.extra)
    for text in _told(beside, result.meta.extra):
        job.say(text)
    return _status(job, require, result.meta.extra)


def _require_rows(treatment: Treatment, **outputs: str | None) -> None:
    """Refuse outputs of every row where rows are decimated."""
    for name, output in outputs.items():
        if output and treatment.holds:
            raise UsageFault(f"--{name} needs every row and cannot be combined with --decimate")


def _told(beside: Sequence[Beside], extra: dict[str, Any]) -> list[str]:
    return [text for other in beside for text in other.told(extra.get("change"))]


def _gains(tables: Sequence[Table]) -> list[float]:
    """The gains by which the torques of the identifications were divided; none if empty."""
    found = [gains_of(table) for table in tables]
    if any(gains != found[0] for gains in found):
        raise UsageFault(
            "--parameters: the tables were identified with other gains of the torques; identify "
            "all logs with one table of gains (identify --gains)"
        )
    return found[0] if found else []


def _described(arm: Robot) -> Table:
    """The a priori values of the robot, if its description has any."""
    if not arm.apriori.any():
        raise UsageFault(f"--parameters {APRIORI}: the description of {arm.name} has no values")
    return apriori(arm)


def _status(job: Job, require: str | None, extra: dict[str, Any]) -> int:
    """The exit status, which tells whether the verdict is what was required."""
    found = extra.get("change", {}).get("verdict")
    if not require or found == require:
        return OK
    why = f"the verdict is {found}" if found else "there is no verdict"
    job.demand(f"{why}, not {require} as --require asks")
    return REQUIRED


def _failed(reach: Reach, robot: Robot, table: Table, *, predicted: bool) -> list[str]:
    """What is wrong with the extremes of the log, such as positions in another unit.

    Torques that are `predicted` are in their unit, however far from limits that may be none.
    """
    failed = [one for one in reach.findings(robot, table.period) if one.status == FAILED]
    return [one.text for one in failed if not (predicted and one.name == TORQUES)]


def _tell(job: Job, model: Identified, before: Known, extra: dict[str, Any]) -> None:
    """Say which delay was applied, and whether the robot has changed."""
    if model.delay:
        how = behind_low_pass(model.delay) if model.low_pass else ""
        job.say(f"applied the delay that identify fitted: {lead(model.delay)}{how}")
    if model.additions:
        job.say("added the torques that identify fitted beside those of the model")
    if before.testable:
        change = extra["change"]
        job.say(f"{change['verdict']}: {change['reason']}", change["verdict"])
    if before.remark:
        job.say(before.remark)


def _stored(table: Table, robot: Robot) -> Entry:
    """The name and the content of a parameter table."""
    batches = list(table.batches)
    model = identified(replace(table, batches=iter(batches)), robot)
    return table.name, model, known(table, model.robot, errors_of(pa.Table.from_batches(batches)))
