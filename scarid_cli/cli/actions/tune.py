"""Run `scarid tune`."""

from __future__ import annotations

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.job import Job, command_line, robot_of
from scarid_cli.cli.progress import steps
from scarid_cli.cli.settings import document
from scarid_cli.io.reader import require
from scarid_cli.io.schemas import joints_of, numbered, of_joints
from scarid_cli.io.table import Table
from scarid_cli.stages import tune as stage


def run(
    job: Job, *, file: str, method: str, robot: str | None, seed: int, save: str | None
) -> None:
    """Write the table of what was tried, and save the best settings."""
    side = job.side_text(save)
    signals = ("q", "tau") if robot else ("q",)
    log = job.read(file, "measurement", reads=lambda names: numbered(names, *signals))
    table = job.recorded(log)
    arm = robot_of(robot) if robot else None
    joints = _joints(table, arm)
    names = stage.online() if method == "all" else [method]
    record = stage.Record.of(table, joints, torques=arm is not None)
    with steps(quiet=job.quiet) as progress:
        rows = stage.tune(record, names, arm, seed, progress)
    best, settings = stage.chosen(rows, joints)
    job.write(stage.trials(table, rows))
    if side:
        side.write(document(best, settings, command_line()))
    for row in rows:
        if row.best and row.judge != stage.LIKELIHOOD and row.name == best:
            where = f"joint {row.joint}, " if row.joint else ""
            job.say(f"{best}, {where}{row.judge} {row.trial.loss:.4g}: {row.settings}")


def _joints(table: Table, arm: Robot | None) -> int:
    """The number of joints to tune, whose columns the table must have."""
    if arm is None:
        return joints_of(table.columns, "q")
    joints = len(arm.joints)
    require(table, of_joints(joints, "q{i}", "tau{i}"), f"this one for robot {arm.name}")
    return joints
