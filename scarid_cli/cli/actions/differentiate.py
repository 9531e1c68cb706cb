"""Run `scarid differentiate`."""

from __future__ import annotations

from typing import Any

from scarid_cli.algorithms.choices.settings import names_of
from scarid_cli.cli.configured import configured
from scarid_cli.cli.job import Job
from scarid_cli.errors import UsageFault, bad_data
from scarid_cli.io.schemas import joints_of, numbered
from scarid_cli.io.table import Table
from scarid_cli.stages import differentiate as stage
from scarid_cli.stages.suitability import Watch


def run(
    job: Job, *, file: str, match: bool | None, per_joint: bool, velocity: str, **choice: Any
) -> None:
    """Write the motion; the choice is that of a method and its settings, of `configured`."""
    own = velocity == "measured"
    signals = ["q"] if match is False else ["q", "tau"]
    signals += ["dq"] if own else []
    log = job.read(file, "measurement", reads=lambda names: numbered(names, *signals))
    methods = configured(joints_of(log.columns, "q"), **choice)
    if own:
        _require_velocities(log, methods)
    table = log if own else stage.measured_apart(log)
    if table.columns != log.columns:
        job.notes.append(
            "the velocities of the log are kept as dq1_measured, ...; --velocity measured uses them"
        )
    if match is None:
        match = joints_of(table.columns, "tau") > 0
    if match and not per_joint:
        _require_alike(methods)
    table = job.recorded(table)
    if not match:
        job.write(stage.differentiate(table, methods, job.left_out, velocities=own))
    elif own or any(choice.values()):
        job.write(stage.matched(table, methods, job.left_out, per_joint=per_joint, velocities=own))
    else:
        _watched(job, table, methods)


def _watched(job: Job, table: Table, methods: list[Any]) -> None:
    """Write the motion by the default settings, and report if they do not suit the log."""
    watch = Watch(len(methods))
    motion = stage.matched(watch.positions(table), methods, job.left_out)
    job.write(watch.derivatives(motion))
    remarks = watch.remarks(methods[0].noise, motion.meta.extra["bandwidth"], table.period)
    if remarks:
        job.say(
            f"the default settings hardly suit this log: {'; '.join(remarks)}. Find better ones "
            "with `scarid tune --robot ROBOT LOG --save settings.toml`, and give them with "
            "--settings settings.toml"
        )


def _require_velocities(log: Table, methods: list[Any]) -> None:
    """Refuse a log without velocities of all joints, or a method that only takes positions."""
    for i, method in enumerate(methods, start=1):
        column, unit = f"dq{i}", log.unit(f"q{i}")
        if column not in log.columns:
            raise bad_data(
                log.name,
                f"the columns {', '.join(log.columns)}",
                expected="the measured velocity of each joint",
                remedy="name the columns with `scarid convert --map`, or leave --velocity out",
                column=column,
            )
        if unit and log.unit(column) not in (None, f"{unit}/s"):
            raise bad_data(
                log.name,
                f"unit {log.unit(column)}",
                expected=f"{unit}/s",
                remedy="convert it with `scarid convert --unit`",
                column=column,
            )
        if not method.suits_velocities:
            raise UsageFault(
                "--velocity measured needs a linear method, such as kalman or rts: what this one "
                "does depends on the positions, for which its settings are"
            )


def _require_alike(methods: list[Any]) -> None:
    """Refuse settings that differ between joints, whose signals belong into one equation."""
    names = [n for n in names_of(methods[0]) if len({getattr(m, n) for m in methods}) > 1]
    if names:
        raise UsageFault(
            f"the joints have different settings ({', '.join(names)}), but a torque contains the "
            "accelerations of all joints, which --match must pass through the same low-pass; give "
            "one value for all joints, or --per-joint if they move independently"
        )
