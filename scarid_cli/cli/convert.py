"""The declaration of `scarid convert`."""

from __future__ import annotations

import click

from scarid_cli.cli import options
from scarid_cli.cli.declare import declare


@declare("convert")
@options.table_input
@click.option(
    "--map",
    "mappings",
    multiple=True,
    metavar="NEW=OLD[,NEW=OLD...]",
    help="Rename columns to what the commands expect: q1, tau1, t, ...; repeatable.",
)
@click.option(
    "--unit",
    "units",
    multiple=True,
    metavar="COLUMNS=UNIT",
    help="The unit of columns in the log (deg, rpm, mN m, ms, ...), which are converted to rad, "
    "N m, s; * and ? match any name; repeatable.",
)
@click.option("--rate", type=options.RATE, help="Add a time column t at this rate [Hz].")
@click.option(
    "--robot",
    type=options.ROBOT,
    metavar="FILE",
    help="Convert the logs of this robot as its description says (columns, units, motors).",
)
@click.option(
    "--separator", metavar="CHAR", default="", help="The separator of CSV values, such as ;."
)
@click.option("--decimal-comma", is_flag=True, help="The CSV has decimal commas.")
@click.option(
    "--header", metavar="NAMES", default="", help="The column names of a CSV without a header."
)
@options.table_output
@options.common
def command() -> None:
    """Convert between table formats, or turn a recorded log into a table.

    \b
      scarid convert log.csv -o log.parquet
      scarid convert log.parquet | head
      scarid convert --map 'q1=joint_1_pos,tau1=effort_1' --unit 'q*=deg' robot.csv -o log.parquet
      scarid convert --separator ';' --decimal-comma --header t,q1,tau1 export.txt
      scarid convert --rate 500 measured.mat -o log.parquet
      scarid convert --robot mine.toml motors.csv | scarid differentiate

    Reads and writes CSV, Parquet, Arrow streams and Arrow files. It also reads NumPy's .npz and
    MATLAB's .mat files (before version 7.3), whose matrices become the columns q1, q2, ... Every
    number is kept exactly. CSV has no metadata: units and history are lost there.

    With --robot, columns, units and rate are those in [log] of the robot's TOML file, unless they
    are given here as well. Angles, torques or currents of motors become positions and torques of
    joints by the gear ratios, couplings and torque constants of the file (docs/robots.md).
    """
