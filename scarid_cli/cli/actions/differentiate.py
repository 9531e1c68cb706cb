"""Run `scarid differentiate`."""

from __future__ import annotations

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.cli.job import Job
from scarid_cli.cli.methods import configured
from scarid_cli.cli.settings import read
from scarid_cli.io.schemas import joints_of, numbered
from scarid_cli.stages import differentiate as stage


def run(
    job: Job,
    *,
    file: str,
    method: str | None,
    given: tuple[str, ...],
    settings: str | None,
    preset: str | None,
    match: bool | None,
) -> None:
    """Write the motion."""
    signals = ("q",) if match is False else ("q", "tau")
    table = job.read(file, "measurement", reads=lambda names: numbered(names, *signals))
    saved = read(settings) if settings else None
    methods = configured(
        DIFFERENTIATORS,
        method or (saved.best if saved else "kalman"),
        joints_of(table.columns, "q"),
        given=given,
        preset=preset,
        saved=saved,
    )
    if match is None:
        match = joints_of(table.columns, "tau") > 0
    estimated = stage.matched if match else stage.differentiate
    job.write(estimated(job.recorded(table), methods, job.left_out))
