"""The declaration of `scarid trajgen`."""

from __future__ import annotations

import click

from scarid_cli.cli import options
from scarid_cli.cli.declare import declare
from scarid_cli.cli.options import NUMBERS


@declare("trajgen")
@options.robot
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the via points.")
@click.option(
    "--duration", type=float, default=20.0, show_default=True, help="Length of the motion [s]."
)
@click.option(
    "--segment",
    type=float,
    nargs=2,
    default=(0.8, 2.0),
    show_default=True,
    metavar="SHORTEST LONGEST",
    help="Time from one via point to the next [s].",
)
@click.option(
    "--sequential",
    is_flag=True,
    help="Move one joint at a time while the others are locked (the paper's test movements).",
)
@click.option(
    "--via",
    type=options.INPUT,
    metavar="FILE",
    help="Take the via points from a table with columns t, q1, q2, ...",
)
@click.option("--rate", type=float, default=200.0, show_default=True, help="Rows per second [Hz].")
@click.option("--q-max", type=NUMBERS, help="Bound on |q| [rad or m].  [default: the robot's]")
@click.option("--dq-max", type=NUMBERS, help="Bound on |dq| [1/s].  [default: the robot's]")
@click.option("--ddq-max", type=NUMBERS, help="Bound on |ddq| [1/s2].  [default: the robot's]")
@options.table_output
@options.common
def command() -> None:
    """Generate an excitation trajectory.

    \b
      scarid trajgen --seed 1 -o reference.parquet
      scarid trajgen --robot emps --duration 30 --segment 1 4 | scarid simulate
      scarid trajgen --via points.csv --rate 500

    Fifth-order polynomials between via points, at rest at each of them, starting and ending at
    zero (paper eq. 28). The bounds on position, velocity and acceleration hold by construction;
    via points of yours that break them are refused. The condition number of the observation
    matrix W that the trajectory gives the robot is told on standard error; below about 100 is well
    excited.
    """
