"""`scarid identify` on a measurement: the recommended procedure in one process."""

from __future__ import annotations

import shlex
from dataclasses import replace
from typing import Any

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.command_line import command_line, was_given
from scarid_cli.cli.job import Job
from scarid_cli.cli.progress import steps
from scarid_cli.io.table import Table


def motion(job: Job, measurement: Table, robot: Robot, added: list[str]) -> Table:
    """The motion of a measurement; reports the choice, and the pipe that does the same.

    `added` are the options that identify uses with a measurement and that a pipe must state.
    """
    from scarid_cli.stages.glance import of_measurement
    from scarid_cli.stages.recommended import motion_of  # needed only here

    batches = list(measurement.batches)
    for finding in of_measurement(replace(measurement, batches=iter(batches)), robot):
        job.say(f"warning: {finding.text}")
    measurement = replace(measurement, batches=iter(batches))
    with steps(quiet=job.quiet) as progress:
        found, bandwidth, smoother = motion_of(measurement, robot, progress, job.left_out)
    job.say(f"a measurement, not a motion: {bandwidth.text}")
    job.say(f"the same as: {_pipe(smoother, added)}")
    return found


def _pipe(smoother: Any, added: list[str]) -> str:
    """The pipe of two commands that gives the same parameters."""
    from click import get_current_context

    file = str(get_current_context().params["file"])
    log = "" if file == "-" else f" {shlex.quote(file)}"
    settings = " ".join(f"--set {n}={getattr(smoother, n):.4g}" for n in ("noise", "intensity"))
    differentiate = f"scarid differentiate --method rts {settings} --format arrow{log}"
    words = [command_line(without="file"), *(word for word in added if _is_new(word))]
    return f"{differentiate} | {' '.join(words)}"


def _is_new(option: str) -> bool:
    """Whether an option is not yet on the command line."""
    return not was_given(option.split()[0].removeprefix("--"))
