"""scarid resample"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from scarid_cli.cli import options

if TYPE_CHECKING:
    from scarid_cli.algorithms.processes.resampling import Clock


@click.command(name="resample")
@options.table_input
@click.option("--rate", type=float, required=True, help="Of the new clock [Hz].")
@click.option(
    "--max-gap",
    type=float,
    metavar="S",
    help="Longest interval [s] that is bridged; a longer one splits the record.  [default: 5 "
    "periods of the log, or one of the new rate if that is longer]",
)
@options.table_output
@options.common
def command(file: str, rate: float, max_gap: float | None, **rest: Any) -> None:
    """Put a log with a jittered clock on a regular one.

    \b
      scarid resample --rate 500 log.csv | scarid differentiate
      scarid resample --rate 100 log.parquet -o slow.parquet

    Numbers lie on straight lines between the samples. Where the rate becomes lower they pass a
    low-pass without delay (a sinc in a Kaiser window, 60 dB from half the new rate on), and a row
    waits for eight new periods. Other columns have the value of the row before. Rows that repeat
    the time before them are left out. What the clock did is told on standard error: mean rate,
    jitter, longest interval, repeated rows, gaps. Streaming, in memory that does not grow.

    Nothing is laid across a gap: after it the column segment is one higher, filter and
    differentiate begin anew, and identify leaves out the rows that have not settled.
    """
    from scarid_cli.cli.job import job
    from scarid_cli.errors import UsageFault
    from scarid_cli.stages import resample as stage

    for name, value in (("--rate", rate), ("--max-gap", max_gap)):
        if value is not None and not 0.0 < value < float("inf"):
            raise UsageFault(f"{name} must be positive, not {value:g}")
    with job(rest) as run:
        out = run.output(rest["output"], rest["format"])
        table = run.recorded(run.read(file, "measurement", regular=False))

        def told(clock: Clock) -> None:
            run.say(
                f"{1.0 / clock.mean:.6g} Hz on average, jitter {1e3 * clock.jitter:.3g} ms, "
                f"longest interval {1e3 * clock.longest:.3g} ms, {clock.repeated} repeated rows, "
                + _gaps(clock)
            )

        run.write(stage.resample(table, rate, max_gap, told), out)


def _gaps(clock: Clock) -> str:
    if not clock.gaps:
        return "no gap"
    return f"{clock.gaps} gap{'s' if clock.gaps > 1 else ''} of {clock.missing:.3g} s in all"
