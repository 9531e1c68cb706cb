"""`scarid identify` and `validate` on a measurement: what is read, and what is reported."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from click import get_current_context

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.declaring.options import SELECTION
from scarid_cli.cli.running.command_line import command_line, given_words, was_given
from scarid_cli.cli.running.job import Job
from scarid_cli.cli.running.progress import steps
from scarid_cli.io.table import Table
from scarid_cli.stages.procedure.blind import Prepared, rate_of

if TYPE_CHECKING:  # scipy is needed for measurements only
    from scarid_cli.stages.procedure.recommended import Progress


def read(
    job: Job, file: str, robot: str | Robot | None, *, reference: bool = False
) -> tuple[Table, Robot]:
    """A motion or a measurement with torques, and the robot."""
    return job.read_for(
        file,
        "motion",
        robot,
        torques=True,
        reference=reference,
        without_derivatives="measurement",
    )


def searching(job: Job) -> Progress:
    """The line that shows the search for the bandwidth."""
    return partial(steps, quiet=job.quiet)


def tell_of(job: Job, found: Prepared, logs: Sequence[Table], added: list[str]) -> None:
    """Report how the motion of these logs was found, and the pipe that does the same.

    `added` are the options that the command uses with a measurement and that a pipe must state.
    """
    rates: dict[str, str] = {}
    for file, log, slower in zip(_files(), logs, found.slower, strict=True):
        for group in slower:
            rates[file] = rate_of(log)
            job.notes.append(
                f"{log.name}: {group.name} are new every {1e3 * group.interval:.3g} ms "
                f"only, rows every {1e3 * log.period:.3g} ms: interpolated as `scarid "
                "resample` does"
            )
    if not (smoothed := found.smoothed):
        return
    for finding in (one for one in smoothed.findings if one not in smoothed.failed):
        job.say(f"warning: {finding.text}")
    job.left_out += smoothed.left_out
    job.say(f"velocities and accelerations are estimated from the positions: {smoothed.text}")
    job.say("the same as:", command=_pipe(smoothed.smoother, added, rates))


def _files() -> list[str]:
    """The logs that were given, or standard input."""
    return [str(file) for file in get_current_context().params["files"]] or ["-"]


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
    files = _files()
    if len(files) > 1:
        return " ".join([command, *(f"<({differentiated(file)})" for file in files)])
    return f"{differentiated(files[0])} | {command}"


def _is_new(option: str) -> bool:
    """Whether an option is not yet on the command line."""
    return not was_given(option.split()[0].removeprefix("--"))
