"""Run `scarid filter`."""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import Any

from scarid_cli.algorithms.filters.butterworth import Butterworth, ZeroPhase
from scarid_cli.algorithms.processes.process import Process
from scarid_cli.cli.running.job import Job
from scarid_cli.errors import UsageFault
from scarid_cli.io.reader import ROW_MARKS
from scarid_cli.io.schemas import numbered
from scarid_cli.stages import filter as stage

CUTOFF_PER_NATURAL_FREQUENCY = 10.0  # the paper's rule
NATURAL_FREQUENCY = 2.0  # Hz, of the paper's robot


def run(job: Job, *, file: str, columns: str | None, **design: Any) -> None:
    """Write the table with some of its columns filtered; the design is that of `lowpass_of`."""
    lowpass = lowpass_of(**design)

    def chosen(names: list[str]) -> list[str]:
        return select(columns, names) if columns else numbered(names, "q", "tau")

    table = job.read(file, "measurement", reads=chosen)
    job.doubt_rate(table.period)
    filters: dict[str, Process] = dict.fromkeys(chosen(table.columns), lowpass)
    job.write(stage.filtered(job.recorded(table), filters, job.left_out))


def lowpass_of(
    *, cutoff: float | None, natural_frequency: float | None, order: int, zero_phase: bool
) -> Process:
    """The low-pass with this cut-off [Hz], or with that of a natural frequency [Hz]."""
    if cutoff is not None and natural_frequency is not None:
        raise UsageFault("give --cutoff or --natural-frequency, not both")
    if cutoff is None:
        natural = NATURAL_FREQUENCY if natural_frequency is None else natural_frequency
        cutoff = CUTOFF_PER_NATURAL_FREQUENCY * natural
    return (ZeroPhase if zero_phase else Butterworth)(cutoff, order)


def select(patterns: str, names: list[str]) -> list[str]:
    """The columns that a list of names and patterns matches, in the table's order."""
    wanted = [pattern.strip() for pattern in patterns.split(",")]
    for pattern in wanted:
        if not any(fnmatchcase(name, pattern) for name in names):
            raise UsageFault(f"--columns: no column {pattern!r}; the table has {', '.join(names)}")
    chosen = [name for name in names if any(fnmatchcase(name, p) for p in wanted)]
    for name in ROW_MARKS:
        if name in chosen:
            raise UsageFault(f"--columns: the column {name} is not a signal and cannot be filtered")
    return chosen
