"""`scarid identify` and `validate` on a measurement: the recommended procedure in one process."""

from __future__ import annotations

import contextlib
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any

from click import get_current_context

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.command_line import command_line, given_words, was_given
from scarid_cli.cli.job import Job
from scarid_cli.cli.options import SELECTION
from scarid_cli.cli.progress import steps
from scarid_cli.cli.resampled import Resampled
from scarid_cli.errors import BadData, TooShort
from scarid_cli.io.schemas import numbered
from scarid_cli.io.table import Table

NOISIER = (
    1.5  # times the noise of the velocities at identification, which is known to a few percent
)


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
    before: Passed | None = None,
) -> Table:
    """The motion of a measurement; reports its bandwidth, and the pipe that does the same.

    `added` are the options that the command uses with a measurement and that a pipe must state, and
    `rates` those at which files were resampled. The bandwidth is that of the identification
    `before`; it is chosen if that is not known, or if it lets through more noise than then.
    """
    from scarid_cli.stages.glance import of_measurement
    from scarid_cli.stages.recommended import motion_of, motion_passing  # needed only here

    batches = list(measurement.batches)

    def again() -> Table:
        return replace(measurement, batches=iter(batches))

    for finding in of_measurement(again(), robot):
        job.say(f"warning: {finding.text}")
    with steps(quiet=job.quiet) as progress, explained(measurement):
        left_out: list[TooShort] = []
        text = ""
        if before:
            found, smoother = motion_passing(again(), robot, before.hertz, left_out)
            text = f"cut-off {before.cutoff:.3g} Hz for all joints, as at the identification"
        if not before or before.quieter(found):
            left: list[TooShort] = []
            other, bandwidth, own = motion_of(again(), robot, progress, left)
            if not before or bandwidth.cutoff < before.cutoff:
                found, smoother, left_out, text = other, own, left, bandwidth.text
                text += ", and positions are noisier than at the identification" if before else ""
        job.left_out += left_out
    job.say(f"velocities and accelerations are estimated from the positions: {text}")
    job.say("the same as:", command=_pipe(smoother, added, rates))
    return found


@dataclass(frozen=True)
class Passed:
    """What the positions passed at an identification: the bandwidth [Hz], and what noise was left.

    `noise` is that of the velocities [rad/s or m/s], inf if it is not known.
    """

    hertz: float
    noise: float = inf

    @classmethod
    def of(cls, tables: Sequence[Table]) -> Passed | None:
        """The lowest bandwidth of these parameters, and the largest noise; None if none has one."""
        facts = [table.meta.extra for table in tables if table.meta.extra.get("bandwidth")]
        if not facts:
            return None
        noise = [max(fact.get("velocity_noise") or [inf]) for fact in facts]
        return cls(min(float(fact["bandwidth"]) for fact in facts), max(noise))

    @property
    def cutoff(self) -> float:
        """The cut-off of the low-pass that is run both ways [Hz]."""
        from scarid_cli.algorithms.tuning.lowpassed import TWO_SIDED

        return self.hertz / TWO_SIDED

    def quieter(self, motion: Table) -> bool:
        """Whether this motion, behind the same low-pass, is clearly noisier."""
        noise = float(max(motion.meta.extra.get("velocity_noise") or [0.0]))
        return noise > NOISIER * self.noise


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
