"""The declaration of `scarid filter`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options, selecting
from scarid_cli.cli.declaring.declare import declare


@declare("filter")
@options.table_input
@click.option(
    "-c",
    "--columns",
    metavar="NAMES",
    shell_complete=options.offered("columns"),
    help="The columns to filter, separated by commas; * and ? match any name.  [default: all "
    "q1, q2, ... and tau1, tau2, ...]",
)
@click.option("--cutoff", type=options.NUMBER, help="The frequency where the gain is -3 dB [Hz].")
@click.option(
    "--natural-frequency",
    type=options.NUMBER,
    metavar="HZ",
    help="The natural frequency of the robot; the cut-off is ten times as high, by the paper's "
    "rule.  [default: 2]",
)
@click.option(
    "--order", type=click.IntRange(1, 20), default=4, show_default=True, help="Filter order."
)
@click.option(
    "--zero-phase",
    is_flag=True,
    help="Filter forwards and backwards: no delay, but offline. Holds the whole log in memory.",
)
@selecting.selection
@options.table_output
@options.common
def command() -> None:
    """Low-pass filter columns of a log.

    \b
      scarid filter --cutoff 20 log.csv | scarid differentiate
      scarid filter --natural-frequency 2 -c 'tau*' log.parquet -o filtered.parquet
      scarid filter --zero-phase --cutoff 40 -c q1 log.csv

    The filter is a Butterworth filter (paper section 3.2), causal and streaming unless --zero-phase
    is given. A causal filter delays what it filters, so filter positions and torques alike. A
    zero-phase filter first extends the record at both ends by odd reflection over three times the
    order, as MATLAB's filtfilt does.
    """
