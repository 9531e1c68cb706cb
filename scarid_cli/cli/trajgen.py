"""The declaration of `scarid trajgen`."""

from __future__ import annotations

import click

from scarid_cli.algorithms.choices.registry import EXCITATIONS
from scarid_cli.cli import options
from scarid_cli.cli.declare import declare
from scarid_cli.cli.described import describing
from scarid_cli.cli.options import NUMBERS


@declare("trajgen", describing(EXCITATIONS, "Excitations and their settings"))
@options.robot
@click.option(
    "--excitation",
    type=click.Choice(EXCITATIONS.names),
    default="quintic",
    show_default=True,
    help="The kind of motion; see below.",
)
@options.settings_of("excitation")
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    help="Seed of the random motion.",
)
@click.option(
    "--duration", type=float, default=20.0, show_default=True, help="Length of the motion [s]."
)
@click.option(
    "--segment",
    type=float,
    nargs=2,
    metavar="SHORTEST LONGEST",
    help="Shortest and longest time between via points [s]; short for --set shortest=SHORTEST "
    "--set longest=LONGEST.  [default: 0.8 2.0]",
)
@click.option(
    "--sequential",
    is_flag=True,
    help="Move one joint at a time, as in the paper; short for --excitation sequential.",
)
@click.option(
    "--via",
    type=options.INPUT,
    metavar="FILE",
    help="Take the via points from a table with columns t, q1, q2, ... instead of random ones.",
)
@click.option(
    "--home",
    type=NUMBERS,
    help="Position at which the motion starts and ends [rad or m].  [default: zero where the "
    "limits allow it, else the middle between them]",
)
@click.option("--rate", type=float, default=200.0, show_default=True, help="Rows per second [Hz].")
@click.option(
    "--q-max",
    type=NUMBERS,
    help="Upper position limit [rad or m]; without --q-min, its negative is the lower one.  "
    "[default: the robot's]",
)
@click.option(
    "--q-min", type=NUMBERS, help="Lower position limit [rad or m].  [default: the robot's]"
)
@click.option("--dq-max", type=NUMBERS, help="Limit on |dq| [1/s].  [default: the robot's]")
@click.option("--ddq-max", type=NUMBERS, help="Limit on |ddq| [1/s2].  [default: the robot's]")
@options.table_output
@options.common
def command() -> None:
    """Generate a trajectory that excites a robot, within its limits.

    \b
      scarid trajgen --seed 1 -o reference.parquet
      scarid trajgen --robot emps --duration 30 --segment 1 4 | scarid simulate
      scarid trajgen --via points.csv --rate 500
      scarid trajgen --robot arm.urdf --ddq-max 5 --home 0,-0.5 -o reference.csv

    The motion starts and ends at rest at the home position and stays within the limits on position,
    velocity and acceleration, which are those of the robot's description unless an option narrows
    them. A motion that would leave its limits is refused before anything is written. The
    condition number of the robot's observation matrix W along the motion is reported on standard
    error; if it is below about 100, the motion excites the robot well.
    """
