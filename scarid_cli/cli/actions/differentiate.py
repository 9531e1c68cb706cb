"""Run `scarid differentiate`."""

from __future__ import annotations

from typing import Any

from scarid_cli.algorithms.choices.settings import names_of
from scarid_cli.cli.running.configured import configured
from scarid_cli.cli.running.job import Job
from scarid_cli.errors import UsageFault, bad_data
from scarid_cli.io.schemas import joints_of, numbered
from scarid_cli.io.table import Table
from scarid_cli.stages import differentiate as stage
from scarid_cli.stages.conversion import velocities
from scarid_cli.stages.remarks.suitability import Watch


def run(
    job: Job, *, file: str, match: bool | None, per_joint: bool, velocity: str | None, **choice: Any
) -> None:
    """Write the motion; the choice is that of a method and its settings, of `configured`."""
    own = velocity == "measured"
    signals = ("q",) if match is False else ("q", "tau")

    def reads(names: list[str]) -> list[str]:
        return numbered(names, *signals) + (velocities.measured(names) if own else [])

    table = job.read(file, "measurement", reads=reads)
    job.doubt_rate(table.period)
    methods = configured(joints_of(table.columns, "q"), **choice)
    table = _with_velocities(table, methods) if own else _with_estimates(job, table)
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


def _with_estimates(job: Job, log: Table) -> Table:
    """The log, whose own velocities, if it has any, are kept beside those to be estimated."""
    table = velocities.apart(log)
    if table.columns != log.columns:
        job.notes.append(
            "the velocities of the log are kept as dq1_measured, ...; --velocity measured uses them"
        )
    return table


def _with_velocities(log: Table, methods: list[Any]) -> Table:
    """The log with its own velocities as dq.

    Refuses a log without those of all joints, or a method that only takes positions.
    """
    log = velocities.used(log)
    for i, method in enumerate(methods, start=1):
        _require_velocity(log, f"dq{i}", log.unit(f"q{i}"))
        if not method.suits_velocities:
            raise UsageFault(
                "--velocity measured needs a linear method, such as kalman or rts: what this one "
                "does depends on the positions, for which its settings are"
            )
    return log


def _require_velocity(log: Table, column: str, unit: str | None) -> None:
    """Refuse a log without this velocity, or with one in another unit than that of the position."""
    if column not in log.columns:
        found, expected = f"the columns {', '.join(log.columns)}", "the velocity of each joint"
        remedy = "name the columns with `scarid convert --map`, or leave --velocity out"
        raise bad_data(log.name, found, expected=expected, remedy=remedy, column=column)
    own = log.unit(column)
    if unit and own and own != f"{unit}/s":
        remedy = "convert it with `scarid convert --unit`"
        raise bad_data(log.name, f"unit {own}", expected=f"{unit}/s", remedy=remedy, column=column)


def _require_alike(methods: list[Any]) -> None:
    """Refuse settings that differ between joints, whose signals belong into one equation."""
    names = [n for n in names_of(methods[0]) if len({getattr(m, n) for m in methods}) > 1]
    if names:
        raise UsageFault(
            f"the joints have different settings ({', '.join(names)}), but a torque contains the "
            "accelerations of all joints, which --match must pass through the same low-pass; give "
            "one value for all joints, or --per-joint if they move independently"
        )
