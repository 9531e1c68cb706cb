"""The declaration of `scarid payload`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options, selecting
from scarid_cli.cli.declaring.declare import declare


@declare("payload")
@click.argument("files", metavar="[LOADED]...", nargs=-1, type=options.INPUT)
@options.input_file(
    "--parameters",
    required=True,
    help="The parameters of the bare robot, as `scarid identify -o bare.parquet` writes them.",
)
@options.robot
@click.option(
    "--frame",
    metavar="LINK",
    help="The link of the URDF in whose frame the payload is stated.  [default: the tool]",
)
@options.side_output(
    "--trace",
    help="Say when a payload is picked up or put down, as rows arrive, and write the present one "
    "after each quarter of a second to FILE. The table has a row for each payload.",
)
@click.option(
    "--false-alarms",
    type=options.NUMBER,
    metavar="RATE",
    help="Of --trace: how many changes may be told by chance alone [1/h].  [default: 1]",
)
@selecting.window
@options.table_output
@options.as_json
@options.common
def command() -> None:
    """Find what hangs on the flange: mass, centre and inertia, each with its 95 % interval.

    \b
      scarid payload --parameters bare.parquet loaded.csv
      scarid payload --parameters bare.parquet --frame tool loaded.parquet -o payload.csv
      scarid payload --parameters bare.parquet --trace trace.csv loaded.parquet

    LOADED are logs of the robot with the payload, as recorded, or the table of parameters that
    `scarid identify` wrote for them. The bare robot is identified beforehand, best from the same
    motion. The payload is the difference of the two identifications, as a part of the last link:
    friction and offsets may differ, and errors that both have in common drop out. The intervals
    contain the uncertainty of both. A value that the motion does not tell has no error, and is
    named. Where no body can have these values, the nearest one that can is given beside them. The
    settings for controllers of UR, Franka and KUKA are printed as these take them. The robot needs
    a URDF (pip install 'scarid[urdf]').
    """
