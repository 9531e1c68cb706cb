"""scarid filter"""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import Any

import click

from scarid_cli.cli import options


@click.command(name="filter")
@options.table_input
@click.option(
    "-c",
    "--columns",
    metavar="NAMES",
    help="Columns, separated by commas; * and ? match.  [default: all q1, q2, ... and tau1, ...]",
)
@click.option("--cutoff", type=float, help="Frequency of -3 dB [Hz].")
@click.option(
    "--natural-frequency",
    type=float,
    metavar="HZ",
    help="Of the robot; the cut-off is 10 times it, the paper's rule.  [default: 2]",
)
@click.option(
    "--order", type=click.IntRange(1, 20), default=4, show_default=True, help="Filter order."
)
@click.option(
    "--zero-phase",
    is_flag=True,
    help="Forwards and backwards: no delay, but offline; holds the whole table.",
)
@options.table_output
@options.common
def command(
    file: str,
    columns: str | None,
    cutoff: float | None,
    natural_frequency: float | None,
    order: int,
    zero_phase: bool,
    **rest: Any,
) -> None:
    """Low-pass filter columns of a log.

    \b
      scarid filter --cutoff 20 log.csv | scarid differentiate
      scarid filter --natural-frequency 2 -c 'tau*' log.parquet -o filtered.parquet
      scarid filter --zero-phase --cutoff 100 -c q1 log.csv

    Butterworth (paper section 3.2). Causal and streaming unless --zero-phase; a causal filter
    delays what it filters, so give q and tau the same one. Zero phase extends the record oddly by
    three times the order at both ends, as MATLAB's filtfilt does.
    """
    from scarid_cli.algorithms.filters.butterworth import Butterworth, ZeroPhase
    from scarid_cli.cli.job import job
    from scarid_cli.errors import UsageFault
    from scarid_cli.stages import filter as stage

    if cutoff is not None and natural_frequency is not None:
        raise UsageFault("give --cutoff or --natural-frequency, not both")
    if cutoff is None:
        cutoff = 10.0 * (2.0 if natural_frequency is None else natural_frequency)
    lowpass = (ZeroPhase if zero_phase else Butterworth)(cutoff, order)
    with job(rest) as run:
        out = run.output(rest["output"], rest["format"])
        table = run.read(file, "measurement")
        chosen = select(columns, table.columns) if columns else measured(table.columns)
        table = run.recorded(table)
        run.write(stage.filtered(table, dict.fromkeys(chosen, lowpass), run.left_out), out)


def measured(names: list[str]) -> list[str]:
    """The columns that come from sensors: q1, q2, ... and tau1, tau2, ..."""
    return [n for n in names for p in ("q", "tau") if n.startswith(p) and n[len(p) :].isdigit()]


def select(patterns: str, names: list[str]) -> list[str]:
    """The columns that a list of names and patterns stands for, in the table's order."""
    from scarid_cli.errors import UsageFault

    wanted = [pattern.strip() for pattern in patterns.split(",")]
    for pattern in wanted:
        if not any(fnmatchcase(name, pattern) for name in names):
            raise UsageFault(f"--columns: no column {pattern!r}; the table has {', '.join(names)}")
    chosen = [name for name in names if any(fnmatchcase(name, p) for p in wanted)]
    if "t" in chosen:
        raise UsageFault("--columns: the time column t cannot be filtered")
    return chosen
