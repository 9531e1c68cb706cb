"""`scarid identify` and `validate` on a measurement: the recommended procedure in one process."""

from __future__ import annotations

import contextlib
import shlex
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from click import get_current_context

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.command_line import command_line, given_words, was_given
from scarid_cli.cli.job import Job
from scarid_cli.cli.options import SELECTION
from scarid_cli.cli.progress import steps
from scarid_cli.cli.resampled import Resampled
from scarid_cli.errors import BadData
from scarid_cli.io.schemas import numbered
from scarid_cli.io.table import Table


def read(
    job: Job, resampled: Resampled, file: str, robot: str | Robot | None, *, reference: bool = False
) -> tuple[Table, Robot]:
    """A motion or a measurement with torques, and the robot."""
    table, arm = job.read_for(
        file,
        "motion",
        robot,
        torques=True,
        reference=reference,
        without_derivatives="measurement",
    )
    return (table if is_motion(table) else resampled.table(file, table)), arm


def is_motion(table: Table) -> bool:
    """Whether the table has accelerations."""
    return bool(numbered(table.columns, "ddq"))


def motion(
    job: Job,
    measurement: Table,
    robot: Robot,
    added: list[str],
    rates: dict[str, str],
    *,
    hertz: float | None = None,
) -> Table:
    """The motion of a measurement; reports its bandwidth, and the pipe that does the same.

    `added` are the options that the command uses with a measurement and that a pipe must state, and
    `rates` those at which files were resampled. The bandwidth is chosen unless it is given as
    `hertz`.
    """
    from scarid_cli.algorithms.tuning.lowpassed import TWO_SIDED
    from scarid_cli.stages.glance import of_measurement
    from scarid_cli.stages.recommended import motion_of, motion_passing  # needed only here

    batches = list(measurement.batches)
    for finding in of_measurement(replace(measurement, batches=iter(batches)), robot):
        job.say(f"warning: {finding.text}")
    measurement = replace(measurement, batches=iter(batches))
    with steps(quiet=job.quiet) as progress, explained(measurement):
        if hertz:
            found, smoother = motion_passing(measurement, robot, hertz, job.left_out)
            text = f"cut-off {hertz / TWO_SIDED:.3g} Hz for all joints, as at the identification"
        else:
            found, bandwidth, smoother = motion_of(measurement, robot, progress, job.left_out)
            text = bandwidth.text
    job.say(f"velocities and accelerations are estimated from the positions: {text}")
    job.say(f"the same as: {_pipe(smoother, added, rates)}")
    return found


@contextlib.contextmanager
def explained(measurement: Table) -> Iterator[None]:
    """A log that cannot be used because its time is not in seconds is refused for this reason."""
    from scarid_cli.stages.glance import of_rate

    try:
        yield
    except BadData:
        if finding := of_rate(measurement.period):
            raise BadData(f"{measurement.name}: {finding.text}") from None
        raise


def _pipe(smoother: Any, added: list[str], rates: dict[str, str]) -> str:
    """The pipe of commands that gives the same parameters; of several logs, one for each."""
    settings = " ".join(f"--set {n}={getattr(smoother, n):.4g}" for n in ("noise", "intensity"))
    chosen = given_words(SELECTION)

    def differentiated(file: str) -> str:
        """The commands before this one, of which the first one reads the rows that are chosen."""
        name = [] if file == "-" else [shlex.quote(file)]
        words = ["scarid differentiate --method rts", settings]
        if file not in rates:
            return " ".join([*words, *chosen, "--format arrow", *name])
        first = ["scarid resample --rate", rates[file], *chosen, "--format arrow", *name]
        return " ".join([*first, "|", *words, "--format arrow"])

    options = [word for word in added if _is_new(word)]
    command = " ".join([command_line(without=("files", *SELECTION)), *options])
    files = [str(file) for file in get_current_context().params["files"]] or ["-"]
    if len(files) > 1:
        return " ".join([command, *(f"<({differentiated(file)})" for file in files)])
    return f"{differentiated(files[0])} | {command}"


def _is_new(option: str) -> bool:
    """Whether an option is not yet on the command line."""
    return not was_given(option.split()[0].removeprefix("--"))
