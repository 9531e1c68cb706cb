"""The declaration of `scarid gains`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options, selecting
from scarid_cli.cli.declaring.declare import declare


@declare("gains")
@click.argument("files", metavar="[LOADED]...", nargs=-1, type=options.INPUT)
@options.input_file(
    "--parameters",
    required=True,
    help="The parameters of the bare robot, as `scarid identify -o bare.parquet` writes them.",
)
@click.option(
    "--mass",
    required=True,
    metavar="KG[+-ERROR]",
    help="The mass of the load [kg], and half its 95 % interval.",
)
@click.option(
    "--centre",
    metavar="X,Y,Z[+-ERROR]",
    help="Its centre [m] in the frame of --frame, and half the 95 % interval of each.",
)
@click.option(
    "--frame",
    metavar="LINK",
    help="The link of the URDF in whose frame --centre is stated.  [default: the tool]",
)
@options.robot
@selecting.window
@options.side_output(
    "--toml",
    help="Write the torque constants that are then right, as lines of the TOML file of a robot "
    "whose logs have currents.",
)
@options.as_json
@options.table_output
@options.common
def command() -> None:
    """Find the gain of each joint's torque, and so its torque constant, from a known load.

    \b
      scarid gains --parameters bare.parquet --mass 2 loaded.csv
      scarid gains --parameters bare.parquet --mass 2+-0.01 loaded.parquet -o gains.csv
      scarid gains --parameters bare.parquet --mass 2 --centre 0,0,0.1+-0.002 loaded.csv

    The gain of a joint is its logged torque, divided by the true one. LOADED are logs of the robot
    with a load whose mass is known, as recorded, or the table of parameters that `scarid identify`
    wrote for them. The bare robot is identified beforehand, best from the same motion. Joints share
    parameters, so that each log tells the gains relative to each other; the weight of the load
    tells the factor that they have in common. Friction and offsets may differ from log to log.
    A gain that the motion does not tell within 10 % is empty, and is named. `scarid identify
    --gains` takes the table, and divides the torques by these gains. The robot needs a URDF (pip
    install 'scarid[urdf]').
    """
