"""Run `scarid differentiate`."""

from __future__ import annotations

from typing import Any

from scarid_cli.algorithms.choices.settings import names_of
from scarid_cli.cli.configured import configured
from scarid_cli.cli.job import Job
from scarid_cli.errors import UsageFault
from scarid_cli.io.schemas import joints_of, numbered
from scarid_cli.stages import differentiate as stage
from scarid_cli.stages.suitability import Watch


def run(job: Job, *, file: str, match: bool | None, per_joint: bool, **choice: Any) -> None:
    """Write the motion; the choice is that of a method and its settings, of `configured`."""
    signals = ("q",) if match is False else ("q", "tau")
    table = job.read(file, "measurement", reads=lambda names: numbered(names, *signals))
    methods = configured(joints_of(table.columns, "q"), **choice)
    if match is None:
        match = joints_of(table.columns, "tau") > 0
    if not match:
        job.write(stage.differentiate(job.recorded(table), methods, job.left_out))
        return
    if not per_joint:
        _require_alike(methods)
    if any(choice.values()):
        motion = stage.matched(job.recorded(table), methods, job.left_out, per_joint=per_joint)
        job.write(motion)
        return
    watch = Watch(len(methods))
    motion = stage.matched(watch.positions(job.recorded(table)), methods, job.left_out)
    job.write(watch.derivatives(motion))
    remarks = watch.remarks(methods[0].noise, motion.meta.extra["bandwidth"], table.period)
    if remarks:
        job.say(
            f"the default settings hardly suit this log: {'; '.join(remarks)}. Find better ones "
            "with `scarid tune --robot ROBOT LOG --save settings.toml`, and give them with "
            "--settings settings.toml"
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
