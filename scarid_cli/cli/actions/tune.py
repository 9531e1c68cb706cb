"""Run `scarid tune`."""

from __future__ import annotations

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.running.command_line import command_line
from scarid_cli.cli.running.job import Job
from scarid_cli.cli.running.progress import steps
from scarid_cli.cli.running.settings import document
from scarid_cli.io.reader import require
from scarid_cli.io.schemas import joints_of, numbered, of_joints
from scarid_cli.io.table import Table
from scarid_cli.stages import tune as stage
from scarid_cli.stages.procedure import bandwidth
from scarid_cli.stages.records import record
from scarid_cli.stages.remarks.glance import in_seconds, of_rate

FOR_ROBOT, FOR_POSITIONS = ("rts", "kalman"), ("kalman",)


def run(
    job: Job,
    *,
    file: str,
    methods: tuple[str, ...],
    robot: str | None,
    seed: int,
    save: str | None,
) -> None:
    """Write the table of what was tried, and save the chosen settings."""
    side = job.side_text(save)
    signals = ("q", "tau") if robot else ("q",)
    log = job.read(file, "measurement", reads=lambda names: numbered(names, *signals))
    table = job.recorded(log)
    arm = job.robot(robot, log) if robot else None
    joints = _joints(table, arm)
    names = _names(methods or (FOR_ROBOT if arm else FOR_POSITIONS))
    held = record.Record.of(table, joints, torques=arm is not None)
    with steps(quiet=job.quiet) as progress, in_seconds(table):
        if arm:
            found = bandwidth.bandwidth(held, arm, progress)
            rows = list(bandwidth.tune_for(held, found, names, seed, progress))
        else:
            rows = stage.tune(held, names, seed, progress)
    job.write(stage.trials(table, rows))
    if side:
        side.write(document(names[0], stage.chosen(rows, joints), command_line()))
    if arm:
        job.say(found.text)
    else:
        _warn(job, held)
    for row in rows:
        if row.best and row.judge != stage.SCATTER and row.settings:
            job.say(f"{row.name}: {row.settings}")


def _names(methods: tuple[str, ...]) -> list[str]:
    """The methods that were asked for, each once."""
    several = (stage.online() if name == "all" else [name] for name in methods)
    return list(dict.fromkeys(name for names in several for name in names))


def _warn(job: Job, held: record.Record) -> None:
    """Report an unlikely rate, and that the joints would have chosen different bandwidths."""
    if finding := of_rate(held.h):
        job.say(f"warning: {finding.text}")
    if held.joints == 1:
        return
    apart, own = stage.octaves(held)
    if apart > stage.OCTAVE:
        listed = ", ".join(f"{hertz:.3g}" for hertz in own)
        job.say(
            f"warning: by themselves, the joints would have bandwidths of {listed} Hz; some of "
            "them may vibrate or be noisy. Give the robot with --robot to choose the bandwidth at "
            "which its parameters scatter least"
        )


def _joints(table: Table, arm: Robot | None) -> int:
    """The number of joints to tune, whose columns the table must have."""
    if arm is None:
        return joints_of(table.columns, "q")
    joints = len(arm.joints)
    require(table, of_joints(joints, "q{i}", "tau{i}"), f"this column for robot {arm.name}")
    return joints
