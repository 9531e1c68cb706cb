"""The declaration of `scarid resample`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options, selecting
from scarid_cli.cli.declaring.declare import declare


@declare("resample")
@options.table_input
@click.option("--rate", type=options.RATE, required=True, help="The new rate [Hz].")
@click.option(
    "--max-gap",
    type=options.NUMBER,
    metavar="S",
    help="The longest interval to interpolate [s]; a longer one is a gap.  [default: 5 periods of "
    "the log, or one period of the new rate if that is longer]",
)
@options.log_robot
@selecting.selection
@options.table_output
@options.common
def command() -> None:
    """Resample a log with a jittered clock at a constant rate.

    \b
      scarid resample --rate 500 log.csv | scarid differentiate
      scarid resample --rate 100 log.parquet -o slow.parquet

    Columns of numbers are interpolated linearly. If the new rate is lower than that of the log,
    they also pass a low-pass without delay: a sinc in a Kaiser window, which attenuates by 60 dB
    above half the new rate and looks eight new periods ahead. Other columns keep the value of the
    previous row. Rows that repeat the time of the previous row are dropped, and so are held
    samples: rows with which a fast logger repeats all measured values of a slower sensor. The mean
    rate, the jitter, the longest interval, dropped rows and gaps are reported on standard error.
    Rows stream through in bounded memory.

    Gaps are never interpolated. After each gap the column `segment` increases by one: filter and
    differentiate restart there, and identify leaves out the settling rows.
    """
