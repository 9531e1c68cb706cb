"""The declaration of `scarid listen`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options
from scarid_cli.cli.declaring.declare import declare


@declare("listen")
@click.option("--port", type=click.IntRange(1, 65535), help="The port to listen at.")
@options.input_file(
    "--follow",
    help="A file of CSV that another program still writes: its rows are passed on as they come.",
)
@click.option("--udp", is_flag=True, help="Packets of UDP, in place of connections by TCP.")
@click.option(
    "--host",
    default="127.0.0.1",
    show_default=True,
    help="The address of this machine to listen at; the default takes rows of this machine only, "
    "0.0.0.0 those of anyone.",
)
@click.option(
    "--columns",
    default="",
    metavar="NAMES",
    help="The names of the columns: t,q1,...  [default: the first line or packet has them]",
)
@click.option(
    "--idle",
    type=options.DURATION,
    metavar="SECONDS",
    help="End after so long without a row.  [default: never]",
)
@click.option(
    "--split",
    is_flag=True,
    help="Number the parts of the record between gaps in a column `segment`, so that the commands "
    "that follow go on behind them.",
)
@options.table_output
@options.common
def command() -> None:
    """Take rows of CSV that a robot sends to a port, or adds to a file, and pass them on at once.

    \b
      scarid listen --port 5000 --idle 1 --split then differentiate then watch --robot scara2
      scarid listen --follow log.csv --idle 1 then differentiate then identify --robot scara2
      scarid listen --port 5001 --udp --columns t,q1,tau1 --idle 1 -o log.parquet

    By TCP, a source connects and sends lines; by UDP, each packet is a line. The first one is the
    header. A source that was killed may connect again: a repeated header is no row, and a row that
    was cut short is left out. Ctrl-C, `kill` or --idle end the table, which is then whole.

    With --follow, the file is read from its start, then whole lines as they are added. A file that
    was cut, or that another one has taken the place of, is read anew.

    At the end, what was lost is said: steps of the column t of more than 1.5 of their median are
    gaps, and a row whose time is before that of an earlier row is out of order. Such rows are
    passed on as they came; with --split a gap begins a new part of the record, as where a source
    was killed and started again, and a time that begins again is counted on.
    """
